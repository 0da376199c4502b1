"""The fuzzy goal controller: its surface, its symmetry, and that it always arrives."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
import simpful
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import InputError
from narrows.reactive.fuzzy import FuzzyGoalController, polar_error
from narrows.reactive.fuzzy_inference import memberships, outputs
from narrows.reactive.fuzzy_orbits import orbits
from narrows.reactive.fuzzy_table import DERIVED, RuleTable, read_rule_table

TABLE = read_rule_table()
PAPER_RULES = {  # [FuzzyDVZ]: rule 1 and rule 35, V_L then V_R
    (0.0, -math.pi): (0.75, 0.25),
    (3.0, math.pi): (0.75, 1.0),
}


def with_angles(*peaks_deg):
    angles = np.radians([*(-p for p in peaks_deg[::-1]), 0.0, *peaks_deg])
    return replace(TABLE, angles=angles)


def test_the_two_rules_the_paper_states_are_kept():
    for (distance, angle), wheels in PAPER_RULES.items():
        assert tuple(outputs(TABLE, distance, angle)) == wheels


def test_the_table_says_that_it_is_derived():
    assert "derived" in TABLE.origin
    assert "NOT the paper's" in TABLE.origin


@given(st.floats(0.0, 6.0), st.floats(-math.pi, math.pi))
@settings(deadline=None, max_examples=100)
def test_mirrored_targets_swap_the_wheels(distance, angle):
    left, right = outputs(TABLE, distance, angle)
    mirrored = outputs(TABLE, distance, -angle)
    np.testing.assert_allclose(mirrored, [right, left], atol=1e-12)  # rounding of 12 products


@given(st.floats(0.0, 6.0), st.floats(-math.pi, math.pi))
@settings(deadline=None, max_examples=100)
def test_wheels_never_reverse_and_turn_toward_the_target(distance, angle):
    left, right = outputs(TABLE, distance, angle)
    assert min(left, right) >= 0.0
    assert (right - left) * angle >= -1e-12


@given(st.floats(-1.0, 7.0))
@settings(deadline=None, max_examples=50)
def test_memberships_sum_to_one(value):
    degrees = memberships(value, TABLE.distances)
    assert degrees.sum() == pytest.approx(1.0, abs=1e-12)
    assert degrees.min() >= 0.0


def oracle(table):
    """The same rules in an independent fuzzy library."""
    system = simpful.FuzzySystem(show_banner=False)
    for name, peaks, low, high in (
        ("d", table.distances, 0.0, 10.0),
        ("phi", table.angles, -math.pi, math.pi),
    ):
        edges = [low, *peaks, high]
        sets = []
        for k, peak in enumerate(peaks):
            if k == 0:
                points = [(low, 1.0), (peak, 1.0), (edges[k + 2], 0.0)]
            elif k == len(peaks) - 1:
                points = [(edges[k], 0.0), (peak, 1.0), (high, 1.0)]
            else:
                points = [(edges[k], 0.0), (peak, 1.0), (edges[k + 2], 0.0)]
            unique = list(dict.fromkeys(points))
            sets.append(simpful.FuzzySet(points=unique, term=f"s{k}"))
        variable = simpful.LinguisticVariable(sets, universe_of_discourse=[low, high])
        system.add_linguistic_variable(name, variable)
    rules = []
    for side in ("left", "right"):
        for a, row in enumerate(getattr(table, side)):
            for d, value in enumerate(row):
                system.set_crisp_output_value(f"{side}{a}{d}", float(value))
                rules.append(f"IF (d IS s{d}) AND_p (phi IS s{a}) THEN ({side} IS {side}{a}{d})")
    system.add_rules(rules)
    return system


def test_the_surface_is_that_of_an_independent_library():
    system = oracle(TABLE)
    rng = np.random.default_rng(1)
    for distance, angle in zip(rng.uniform(0, 5, 25), rng.uniform(-3.1, 3.1, 25), strict=True):
        system.set_variable("d", distance)
        system.set_variable("phi", angle)
        found = system.inference(["left", "right"])
        expected = [found["left"], found["right"]]
        np.testing.assert_allclose(outputs(TABLE, distance, angle), expected, atol=1e-9)


@pytest.mark.parametrize(
    ("track", "distance", "trace"), [(0.5, 0.349, 0.438), (0.6, 0.419, 0.365), (0.7, 0.490, 0.312)]
)
def test_orbits_repel_as_computed_for_a_top_speed_of_80_cm_a_second(track, distance, trace):
    found = orbits(TABLE, track)
    assert [orbit.side for orbit in found] == [1, -1]
    for orbit in found:
        # The corrections print orbits of an integrated run: 1 mm and 0.002 1/s of slack.
        assert orbit.distance == pytest.approx(distance, abs=2e-3)
        assert 0.8 * orbit.trace == pytest.approx(trace, abs=3e-3)


def test_a_natural_monotone_table_is_refused_where_it_circles():
    left, right = TABLE.left.copy(), TABLE.right.copy()
    left[[0, -1]], right[[0, -1]] = left[[1, -2]], right[[1, -2]]
    table = replace(TABLE, left=left, right=right, name="monotone")
    with pytest.raises(InputError, match=r"'monotone' can circle its target for ever, 0\.30 m off"):
        FuzzyGoalController(table)


@pytest.mark.parametrize("peaks", [(45, 90, 180), (60, 120, 180), (30, 120, 180)])
def test_peaks_with_an_orbit_that_does_not_repel_are_refused(peaks):
    with pytest.raises(InputError, match="can circle its target for ever"):
        FuzzyGoalController(with_angles(*peaks))


def test_peaks_that_repel_are_taken():
    assert FuzzyGoalController(with_angles(20, 70, 150)).orbits


def test_a_table_that_stands_before_the_target_is_refused():
    left, right = TABLE.left.copy(), TABLE.right.copy()
    left[2, 2] = right[2, 2] = 0.0
    with pytest.raises(InputError, match=r"stands still 1\.00 m from its target at -20 degrees"):
        FuzzyGoalController(replace(TABLE, left=left, right=right))


def test_a_table_that_turns_away_is_refused_by_driving_it():
    wrong = replace(TABLE, left=TABLE.right, right=TABLE.left, name="wrong way")
    with pytest.raises(InputError, match=r"'wrong way' (does not reach|can circle)"):
        FuzzyGoalController(wrong)


def drive(table, track, rng, count, *, spacing=None, lag=0.0, dt=0.05, near=0.05):
    """Return the times to the target, infinite where not reached, and the least wheel speed."""
    if spacing is not None:
        values = np.array([0.0, *spacing])
        plain = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
        left, right = (np.interp(t, plain, values) for t in (table.left, table.right))
        table = replace(table, left=left, right=right)
    d = np.exp(rng.uniform(math.log(0.06), math.log(9.0), count))
    x, y, heading = -d, np.zeros(count), rng.uniform(-math.pi, math.pi, count)
    wheels, times, least = np.zeros((count, 2)), np.full(count, np.inf), np.inf
    for k in range(round(60.0 / dt)):
        d = np.hypot(x, y)
        times = np.where((d <= near) & np.isinf(times), k * dt, times)
        if np.isfinite(times).all():
            break
        phi = np.remainder(np.arctan2(-y, -x) - heading + np.pi, 2 * np.pi) - np.pi
        target = 0.8 * outputs(table, d, phi)
        least = min(least, float(target.min()))
        wheels = target if lag == 0.0 else wheels + (target - wheels) * (1 - math.exp(-dt / lag))
        v, omega = wheels.mean(axis=1), (wheels[:, 1] - wheels[:, 0]) / track
        moving = np.isinf(times)
        x = x + np.where(moving, v * np.cos(heading + omega * dt / 2) * dt, 0.0)
        y = y + np.where(moving, v * np.sin(heading + omega * dt / 2) * dt, 0.0)
        heading = heading + omega * dt
    return times, least


CONFIGURATIONS = [
    {"track": track, "lag": lag, "dt": dt, "near": near, "spacing": spacing}
    for track, lag, dt, near, spacing in (
        (0.5, 0.0, 0.05, 0.10, None),
        (0.6, 0.0, 0.05, 0.10, None),
        (0.7, 0.0, 0.10, 0.05, None),
        (0.6, 0.3, 0.05, 0.05, None),
        (0.5, 0.3, 0.10, 0.10, None),
        (0.7, 0.3, 0.05, 0.02, None),
        (0.6, 0.0, 0.05, 0.05, (0.2, 0.45, 0.7, 1.0)),
        (0.6, 0.0, 0.05, 0.05, (0.3, 0.55, 0.8, 1.0)),
        (0.6, 0.0, 0.05, 0.05, (0.15, 0.4, 0.7, 1.0)),
    )
]


@pytest.mark.parametrize("settings", CONFIGURATIONS, ids=str)
def test_every_start_arrives(settings):
    times, least = drive(TABLE, count=600, rng=np.random.default_rng(6), **settings)
    assert np.isfinite(times).all()
    assert least >= 0.0


def test_the_time_to_arrive_is_the_one_reported():
    times, _ = drive(TABLE, 0.6, np.random.default_rng(0), 500, near=0.10)
    assert np.isfinite(times).all()
    # The corrections give 9.5, 20.6 and 27 s for 6,000 starts from 0.03 to 9 m.
    assert 5.0 < np.quantile(times, 0.5) < 11.0
    assert times.max() < 28.0


def test_the_papers_drive_takes_the_reported_time():
    pose = np.array([-2.5, 2.5, -math.pi / 4])
    controller = FuzzyGoalController(track=0.6)
    time = length = 0.0
    while polar_error(pose, [2.5, -2.5])[0] > 0.1:
        v, omega = controller.command(pose, [2.5, -2.5])
        middle = pose[2] + 0.5 * omega * 0.01
        pose = pose + 0.01 * np.array([v * math.cos(middle), v * math.sin(middle), omega])
        time, length = time + 0.01, length + 0.01 * v
    assert time == pytest.approx(14.3, abs=0.1)
    assert length == pytest.approx(6.97, abs=0.01)


def test_the_distance_has_a_plus_under_the_root_and_the_angle_is_wrapped():
    assert polar_error([0.0, -2.2, math.pi / 2], [0.0, 2.2]) == pytest.approx((4.4, 0.0))
    distance, angle = polar_error([0.0, 0.0, math.radians(170)], [-1.0, -1e-3])
    assert distance == pytest.approx(1.0, abs=1e-6)
    assert math.degrees(angle) == pytest.approx(10.06, abs=0.01)
    assert polar_error([1.0, 1.0, 0.3], [1.0, 1.0]) == (0.0, 0.0)


def rewrite(folder, change):
    from importlib import resources

    text = (resources.files("narrows") / "reactive/rules/derived-d.json").read_text("utf-8")
    entries = json.loads(text)
    change(entries)
    file = folder / "table.json"
    file.write_text(json.dumps(entries))
    return file


def test_a_table_in_a_file_is_read(tmp_path):
    def rename(entries):
        entries["name"] = "mine"

    table = read_rule_table(rewrite(tmp_path, rename))
    assert table.name == "mine"
    np.testing.assert_array_equal(table.left, TABLE.left)
    assert FuzzyGoalController(table, track=0.5).table is table


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda e: e.pop("left"), "lacks an entry"),
        (lambda e: e["left"]["NL"].__setitem__(1, "XX"), r"left\.NL.*no such output.*XX"),
        (lambda e: e["right"]["Z"].pop(), r"right\.Z.*one output for each distance set"),
        (lambda e: e["right"].pop("Z"), "one row for each angle set"),
        (lambda e: e["outputs"].__setitem__("Z", -0.1), "never reverse"),
        (lambda e: e["distance_peaks_m"].__setitem__("VS", 0.1), "peak at the target"),
        (lambda e: e["angle_peaks_deg"].__setitem__("PS", 70), "peaks must increase"),
        (lambda e: e["angle_peaks_deg"].__setitem__("PL", 190), "within a half turn"),
        (lambda e: e["angle_peaks_deg"].__setitem__("PL", "far"), "expected a number"),
    ],
)
def test_a_wrong_file_is_refused_with_file_and_field(tmp_path, change, message):
    with pytest.raises(InputError, match=message) as caught:
        read_rule_table(rewrite(tmp_path, change))
    assert "table.json" in str(caught.value)


def test_a_file_that_is_no_json_is_refused_with_its_line(tmp_path):
    file = tmp_path / "table.json"
    file.write_text('{\n"name": \n}')
    with pytest.raises(InputError, match=r"table\.json.*this is not JSON"):
        read_rule_table(file)
    with pytest.raises(InputError, match="cannot be read"):
        read_rule_table(tmp_path / "none.json")


def test_the_controller_refuses_numbers_out_of_range():
    with pytest.raises(InputError, match="track"):
        FuzzyGoalController(DERIVED, track=0.0)
    with pytest.raises(InputError, match="finite"):
        RuleTable("x", "", [0.0, np.nan], [0.0, 1.0], np.zeros((2, 2)), np.zeros((2, 2)))
