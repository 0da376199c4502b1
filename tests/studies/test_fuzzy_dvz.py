"""The study of the fuzzy navigator: its scenes, its printed equations, its tables."""

import math

import numpy as np
import pytest

from narrows.errors import StudyError
from narrows.reactive.deformable_zone import DeformableZone, RayGrid
from narrows.reactive.zone_shape import ZoneShape
from narrows.scene import check_scene, load_scene
from narrows.studies.fuzzy_dvz_plausible import disc_way, holding_disc, is_plausible
from narrows.studies.fuzzy_dvz_printed import printed_sums
from narrows.studies.fuzzy_dvz_runs import (
    BLIND,
    GUARDED,
    clutter_case,
    drive,
    dropout_case,
    odd_case,
    paper_case,
    people_case,
    row_of,
)
from narrows.studies.fuzzy_dvz_scenes import (
    CHAIR,
    KINDS,
    PAPER_SCENES,
    cluttered,
    peopled,
    scene_of,
    trap,
    velocities_of,
)
from narrows.studies.registry import names, run
from narrows.world import Solid, World

RNG = np.random.default_rng(0)


@pytest.mark.parametrize("name", PAPER_SCENES)
def test_the_navigator_reaches_every_goal_of_the_paper_without_contact(name):
    found = paper_case({"scene": name, "variant": GUARDED}, RNG)
    assert found["outcome"] == "arrived"
    assert found["collisions"] == found["walked_into"] == 0
    assert found["clearance_m"] > 0.05


def test_without_the_zone_the_papers_first_run_collides():
    found = paper_case({"scene": "three fixed", "variant": BLIND}, RNG)
    assert found["outcome"] == "collision"


def test_the_printed_equations_collide_where_the_right_ones_do_not():
    printed = paper_case({"scene": "three hanging", "variant": "as printed"}, RNG)
    right = paper_case({"scene": "three hanging", "variant": "right equations"}, RNG)
    assert printed["outcome"] == "collision"
    assert right["outcome"] == "arrived"


def test_only_the_hanging_object_that_is_high_enough_is_passed_under():
    driven = drive(PAPER_SCENES["three hanging"]())
    low, high, lower = driven.scene.world.solids
    poses = driven.record.poses
    reach = {solid.name: [] for solid in (low, high, lower)}
    for pose in poses[::5]:
        middle = pose[:2] + 0.25 * np.array([math.cos(pose[2]), math.sin(pose[2])])
        for solid in (low, high, lower):
            centre = np.array(solid.shape.centroid.coords[0])
            reach[solid.name].append(float(np.hypot(*(middle - centre))))
    assert min(reach[high.name]) < 0.5  # under it
    assert min(reach[low.name]) > 0.5
    assert min(reach[lower.name]) > 0.5


def test_the_printed_zone_has_its_long_end_behind():
    grid, shape = RayGrid(rows=12, latitude=math.radians(66.0)), ZoneShape.paper()
    azimuth, infinite = grid.azimuths, np.full((12, 120), np.inf)
    for place, intruded in ((math.pi, True), (0.0, False)):
        ranges = infinite.copy()
        ranges[6, np.abs(np.remainder(azimuth - place + np.pi, 2 * np.pi) - np.pi) < 0.3] = 1.0
        sums = printed_sums(ranges, grid, shape, 0.3)
        assert (sums.intrusion > 0.0) == intruded
        assert (DeformableZone(shape, grid).deform(ranges, 0.3).rays > 0) != intruded


def test_the_printed_sums_are_there_without_any_obstacle():
    grid, shape = RayGrid(rows=12, latitude=math.radians(66.0)), ZoneShape.paper()
    sums = printed_sums(np.full((12, 120), np.inf), grid, shape, 0.5)
    assert sums.intrusion == 0.0
    assert abs(sums.by_driving) > 0.1  # the correct one is 0: no ray is intruded


def test_worlds_are_scenes_that_can_be_started_and_ended_in():
    for k in range(5):
        check_scene(cluttered(np.random.default_rng(k)))
    for make in PAPER_SCENES.values():
        check_scene(make())
    check_scene(trap(2.0))


def test_people_of_every_kind_walk_at_human_speed():
    for kind in KINDS:
        for solid in peopled(np.random.default_rng(1), kind).world.moving:
            assert 0.4 < solid.speed <= 1.31
    with pytest.raises(StudyError, match="nobody walks so"):
        peopled(RNG, "hopping")


def test_known_velocities_are_those_of_who_is_there():
    scene = peopled(np.random.default_rng(1), "crossing")
    solid, time = scene.world.moving[0], 12.0
    place = solid.position(time)
    points = np.array([[*place, 0.5], [50.0, 50.0, 0.5]])
    found = velocities_of(scene.world)(time, points)
    step = (solid.position(time + 1e-3) - place) / 1e-3
    np.testing.assert_allclose(found, [step, [0.0, 0.0]], atol=1e-9)


def test_a_disc_finds_its_way_where_there_is_one():
    wall = Solid.polygon([[0, -9], [0.1, -9], [0.1, 1.0], [0, 1.0]])
    free = scene_of(CHAIR, World(), (-3, 0, 0), (3, 0))
    around = scene_of(CHAIR, World((wall,)), (-3, 0, 0), (3, 0))
    closed = scene_of(
        CHAIR, World((Solid.polygon([[0, -9], [0.1, -9], [0.1, 9], [0, 9]]),)), (-3, 0, 0), (3, 0)
    )
    radius = holding_disc(free)
    assert radius == pytest.approx(math.hypot(0.6, 0.35))
    assert disc_way(free, radius) == pytest.approx(1.0, abs=0.04)
    expected = 2 * math.hypot(3.0, 1.0 + radius) / 6.0
    assert disc_way(around, radius) == pytest.approx(expected, rel=0.09)  # eight directions
    assert math.isinf(disc_way(closed, radius))
    assert is_plausible(around)
    assert not is_plausible(closed)


@pytest.mark.slow
def test_a_random_world_is_driven_without_contact():
    found = clutter_case({"world": 1, "variant": GUARDED, "base": 0}, RNG)
    assert found["plausible"]
    assert found["outcome"] == "arrived"


@pytest.mark.slow
def test_people_meet_only_a_standing_chair():
    found = people_case({"world": 2, "kind": "crossing", "base": 0, "knows": False}, RNG)
    assert found["collisions"] == 0


def test_silence_stops_the_chair_in_time():
    found = dropout_case({"world": 1, "base": 0}, np.random.default_rng(4))
    assert found["collisions"] == 0
    assert found["stopped_after_m"] <= found["allowed_m"]


def test_what_nothing_tells_of_is_hit():
    found = odd_case({"case": "glass table, not at all"}, RNG)
    assert found["outcome"] == "collision"
    with pytest.raises(StudyError, match="no such case"):
        odd_case({"case": "quicksand"}, RNG)


def test_there_is_no_other_variant():
    with pytest.raises(StudyError, match="no such variant"):
        drive(trap(1.0), "magic")


def test_a_row_says_who_drove():
    found = row_of(drive(PAPER_SCENES["three fixed"]()))
    assert 0.05 < found["zone_share"] < 0.6
    assert found["switches"] >= 2


@pytest.mark.slow
def test_the_whole_study_writes_its_report_and_figures(tmp_path):
    assert "fuzzy-dvz" in names()
    counts = {"worlds": 2, "peopled": 3, "compared": 1, "told": 1, "silent": 1, "drawn": 2}
    report = run(
        "fuzzy-dvz",
        tmp_path,
        **counts,
        senses=["two lasers"],
        scenes=["three fixed", "person"],
        odd=["U-trap 1.0"],
    )
    assert "Contacts while the chair moves: 0" in report.text
    assert "The navigator arrives in 2 of 2 runs" in report.text
    assert "## Failed cases" not in report.text
    pictures = {file.name for file in tmp_path.glob("*.png")}
    assert {"worlds.png", "three-fixed.png", "person.png"} <= pictures
    assert load_scene(tmp_path / "person.yaml").world.moving[0].name == "person"
    assert (tmp_path / "clutter.csv").read_text().count("\n") == 1 + 2 + 3
