"""Safety regions hold every braking body, are hardly larger than that, and survive files."""

import io
import json
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import narrows
from narrows.errors import InputError, ShapeError
from narrows.reactive.braking_kernels import braking_poses
from narrows.reactive.cell_kernels import hull_in_place
from narrows.reactive.safety_regions import (
    STRAIGHT,
    RegionOptions,
    SafetyRegions,
    protected,
    top_norm,
)
from narrows.reactive.safety_regions_file import sealed
from narrows.reactive.safety_regions_kernels import NEVER, paint_direction
from narrows.reactive.safety_regions_painting import motions_of
from narrows.vehicle import Limits

SHARE = st.floats(-1.0, 1.0)


@pytest.mark.parametrize(
    ("v", "omega", "degrees"),
    [(0.5, 0.0, 45.0), (-0.5, 0.0, -135.0), (0.0, 1.0, 135.0), (0.0, -1.0, -45.0)],
)
def test_directions_are_those_of_the_paper(xeno_regions, v, omega, degrees):
    phi, _ = xeno_regions.polar(v, omega)
    assert math.degrees(phi) == pytest.approx(degrees)
    assert xeno_regions.direction(xeno_regions.index(STRAIGHT)) == pytest.approx(STRAIGHT)


@given(v=st.floats(-2.0, 2.0), omega=st.floats(-3.0, 3.0))
@settings(deadline=None, max_examples=100)
def test_the_speed_norm_is_twice_the_faster_rim_and_polar_motion_is_motion(xeno_regions, v, omega):
    phi, norm = xeno_regions.polar(v, omega)
    faster = max(abs(v), 0.5 * abs(omega) * xeno_regions.track)
    assert norm == pytest.approx(2.0 * faster, abs=1e-12)
    assert xeno_regions.motion(phi, norm) == pytest.approx((v, omega), abs=1e-9)


@pytest.mark.parametrize(
    ("castor_time", "end"),
    [(0.0, (0.692, 0.095, 9.2)), (0.6, (0.676, 0.160, 20.2)), (math.inf, (0.664, 0.190, 32.1))],
)
def test_braking_ends_where_the_corrections_say(castor_time, end):
    # v = 1 m/s, omega = 0.8 rad/s, latency 0.2 s, 1 m/s^2: it takes 1 s to stop.
    castors = 1.0 if math.isinf(castor_time) else castor_time / (castor_time + 1.0)
    poses = np.empty((20, 3))
    braking_poses(1.0, 0.8, 1.0, 0.2, castors, poses)
    assert poses[-1, :2] == pytest.approx(end[:2], abs=1e-3)
    assert math.degrees(poses[-1, 2]) == pytest.approx(end[2], abs=0.06)


def braking_by_steps(left, right, track, latency, deceleration, castor_time, share):
    """Return poses of a braking, by small steps of its differential equation, shape (N, 3)."""
    v0, omega0 = 0.5 * (left + right), (right - left) / track
    stop = max(0.5 * (abs(left) + abs(right)), 1e-9) / deceleration
    times = np.linspace(0.0, latency + stop, 1500)
    since = np.clip(times - latency, 0.0, stop)
    slower = 1.0 - since / stop
    straighter = np.ones_like(times)
    if castor_time == 0.0:
        straighter = (since == 0.0).astype(float)
    elif math.isfinite(castor_time):
        straighter = np.maximum(0.0, 1.0 - since / castor_time)
    v, omega = v0 * slower, omega0 * slower * straighter

    def summed(rate):
        steps = 0.5 * (rate[1:] + rate[:-1]) * np.diff(times)
        return np.concatenate([[0.0], np.cumsum(steps)])

    heading = summed(omega)
    poses = [summed(v * np.cos(heading)), summed(v * np.sin(heading)), heading]
    return np.stack(poses, axis=-1)[: max(2, round(share * len(times)))]


@given(
    v=SHARE,
    omega=SHARE,
    errors=st.tuples(SHARE, SHARE),
    castor_time=st.one_of(st.just(0.0), st.just(math.inf), st.floats(0.01, 3.0)),
    share=st.floats(0.0, 1.0),
)
@settings(deadline=None, max_examples=250, derandomize=True)
def test_a_braking_body_never_leaves_its_region(
    xeno, xeno_regions, v, omega, errors, castor_time, share
):
    regions, options = xeno_regions, xeno_regions.options
    v, omega = 0.8 * v, 1.2 * omega
    phi, norm = regions.polar(v, omega)
    left, right = v - 0.5 * omega * xeno.track, v + 0.5 * omega * xeno.track
    wrong = options.speed_error * max(abs(left), abs(right))
    poses = braking_by_steps(
        left + errors[0] * wrong,
        right + errors[1] * wrong,
        xeno.track,
        options.latency,
        options.deceleration,
        castor_time,
        share,
    )
    body = shapely.Polygon(protected(xeno.outline, options) * (1.0 - 1e-9))
    edge = shapely.get_coordinates(shapely.segmentize(body.exterior, 0.02))
    level = regions.level(norm)
    for x, y, heading in poses[np.linspace(0, len(poses) - 1, 7).astype(int)]:
        c, s = math.cos(heading), math.sin(heading)
        points = edge @ np.array([[c, s], [-s, c]]) + [x, y]
        cells = np.floor((points - regions.lower) / options.cell).astype(int)
        reached = regions.levels[regions.index(phi), cells[:, 0], cells[:, 1]]
        assert reached.max() <= level


SCOOTER = narrows.Vehicle.rectangle(1.45, 0.62, 0.30, limits=Limits(speed=1.4, yaw_rate=0.9))
XENO = narrows.load_vehicle("xeno")


@pytest.mark.parametrize(
    ("chair", "motion", "area", "furthest"),
    [
        (XENO, (0.8, 0.0), 0.06, 0.04),
        (XENO, (0.5, 1.0), 0.06, 0.04),
        (XENO, (0.0, 1.2), 0.06, 0.04),
        (XENO, (-0.4, 0.0), 0.06, 0.04),
        (SCOOTER, (0.5, 0.9), 0.07, 0.06),
    ],
)
def test_a_region_is_hardly_larger_than_the_swept_bodies_and_their_cells(
    chair, motion, area, furthest
):
    # With the default grid: the area over, and the furthest cell from a swept body.
    fine = RegionOptions()
    k, norm, levels, norms = one_direction(chair, fine, *motion)
    motions, _ = motions_of(k, chair.track, fine)
    body = protected(chair.outline, fine)
    bodies = []
    for share in np.linspace(0.0, 1.0, 5):
        v, omega = norm * ((1.0 - share) * motions[0] + share * motions[2])
        turn = 0.5 * omega * chair.track
        stop = 0.5 * (abs(v - turn) + abs(v + turn)) / fine.deceleration
        for ratio in (0.0, 0.1, 0.3, 0.6, 1.0, 2.0, math.inf):
            castor_time = ratio * stop if ratio else 0.0
            poses = braking_by_steps(
                v - turn, v + turn, chair.track, fine.latency, fine.deceleration, castor_time, 1.0
            )
            for x, y, heading in poses[::50]:
                c, s = math.cos(heading), math.sin(heading)
                corners = body @ np.array([[c, s], [-s, c]]) + np.array([x, y])
                bodies.append(shapely.Polygon(corners))
    swept = shapely.union_all(bodies)
    row, column = np.nonzero(levels <= np.searchsorted(norms, norm - 1e-12))
    corner = LOWER + fine.cell * np.stack([row, column], axis=-1)
    cells = shapely.box(*corner.T, *(corner + fine.cell).T)
    met = shapely.intersects(cells, swept)
    assert len(cells) <= (1.0 + area) * met.sum()
    assert shapely.distance(cells[~met], swept).max(initial=0.0) < furthest


LOWER = np.array([-2.0, -2.0])


def one_direction(vehicle, options, v, omega):
    """Return index, speed norm, levels on a grid from `LOWER`, and the levels' norms."""
    share = np.linspace(0.0, 1.0, options.levels + 1)
    norms = options.headroom * top_norm(vehicle) * 0.5 * (share + share**2)
    turn = 0.5 * omega * vehicle.track
    k = round(math.atan2(v + turn, v - turn) * options.directions / (2.0 * math.pi))
    motions, timing = motions_of(k, vehicle.track, options)
    levels = np.full((200, 200), NEVER, dtype=np.uint8)
    body = protected(vehicle.outline, options)
    samples = (options.castor_samples, options.pose_samples)
    paint_direction(levels, motions, norms, timing, body, LOWER, options.cell, *samples)
    return k, abs(v - turn) + abs(v + turn), levels, norms


def test_regions_of_a_symmetrical_chair_are_mirror_images(xeno_regions):
    regions = xeno_regions
    columns = np.arange(regions.levels.shape[2])
    mirrored = np.round(-2.0 * regions.lower[1] / regions.options.cell - 1.0 - columns).astype(int)
    inside = (mirrored >= 0) & (mirrored < len(columns))
    for phi in (STRAIGHT, STRAIGHT + 0.2, STRAIGHT + 1.0, -2.0):
        there = regions.levels[regions.index(phi)][:, inside]
        here = regions.levels[regions.index(2.0 * STRAIGHT - phi)][:, mirrored[inside]]
        # Rounding may put a body's edge on either side of a cell's.
        assert (np.abs(there.astype(int) - here) > 0).mean() < 0.02


def test_what_is_ahead_is_met_by_the_front_and_what_is_behind_by_the_rear(xeno, xeno_regions):
    regions = xeno_regions

    def part(phi, x, y):
        row, column = np.floor((np.array([x, y]) - regions.lower) / regions.options.cell)
        return int(regions.parts[regions.index(phi), int(row), int(column)])

    front, rear = xeno.front_overhang, -xeno.rear_overhang
    assert part(STRAIGHT, front + 0.2, 0.2) == 0
    assert part(STRAIGHT, front + 0.2, -0.2) == 1
    assert part(STRAIGHT - math.pi, rear - 0.1, 0.2) == 6
    assert part(STRAIGHT - math.pi, rear - 0.1, -0.2) == 7
    spin = 3.0 * STRAIGHT  # to the left: the front swings left, the rear right
    assert part(spin, 0.6, 0.36) == 2
    assert part(spin, -0.15, -0.36) == 5


def test_a_hull_is_that_of_shapely():
    rng = np.random.default_rng(3)
    for count in (3, 4, 17, 96):
        points = rng.normal(size=(count, 2))
        ring = np.empty((2 * count + 2, 2))
        size = hull_in_place(points.copy(), count, ring)
        expected = shapely.MultiPoint(points).convex_hull
        assert shapely.Polygon(ring[:size]).equals(expected.normalize()) or shapely.Polygon(
            ring[:size]
        ).symmetric_difference(expected).area == pytest.approx(0.0, abs=1e-12)


def test_progress_is_reported_up_to_the_end(xeno):
    shares = []
    options = RegionOptions(directions=24, levels=4, cell=0.1, castor_samples=2, pose_samples=5)
    SafetyRegions.compute(xeno, options, shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_speeds_go_beyond_the_fastest_rim(xeno, xeno_regions):
    assert xeno_regions.norms[0] == 0.0
    assert xeno_regions.norms[-1] == pytest.approx(1.6 * top_norm(xeno))
    assert top_norm(xeno) == pytest.approx(2.0 * max(0.8, 0.5 * 1.2 * xeno.track))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"directions": 100}, "multiple of 8"),
        ({"cell": 0.0}, "cell"),
        ({"speed_error": math.nan}, "speed_error"),
        ({"headroom": 0.5}, "headroom"),
    ],
)
def test_options_out_of_range_are_refused(changes, message):
    with pytest.raises(ShapeError, match=message):
        RegionOptions(**changes)


def test_saved_regions_are_loaded_unchanged(xeno, xeno_regions, tmp_path):
    xeno_regions.save(tmp_path / "regions.npz")
    again = SafetyRegions.load(tmp_path / "regions.npz", xeno)
    assert again.options == xeno_regions.options
    for name in ("outline", "norms", "lower", "levels", "parts"):
        assert np.array_equal(getattr(again, name), getattr(xeno_regions, name))
    assert not again.levels.flags.writeable


def test_regions_of_another_chair_are_refused_with_the_difference(xeno, xeno_regions, tmp_path):
    file = tmp_path / "regions.npz"
    xeno_regions.save(file)
    others = {
        "body": narrows.Vehicle.rectangle(1.2, 0.66, 0.25, track=xeno.track),
        "track": narrows.Vehicle.rectangle(1.1, 0.66, 0.25, track=0.5),
        "rim speed": xeno.with_limits(speed=2.0),
    }
    for word, other in others.items():
        with pytest.raises(InputError, match=rf"another chair.*{word}.*compute"):
            SafetyRegions.load(file, other)


def test_damaged_and_foreign_files_are_refused_by_name(xeno, xeno_regions, tmp_path):
    good = tmp_path / "good.npz"
    xeno_regions.save(good)
    content = good.read_bytes()
    other = io.BytesIO()
    np.savez(other, something=np.zeros(3))
    spoilt = bytearray(content)
    spoilt[len(spoilt) // 2] ^= 0xFF
    cases = {
        "empty": b"",
        "text": b"not regions at all",
        "short": content[: len(content) // 2],
        "other": other.getvalue(),
        "spoilt": bytes(spoilt),
    }
    for name, damaged in cases.items():
        file = tmp_path / f"{name}.npz"
        file.write_bytes(damaged)
        with pytest.raises(InputError, match=f"{name}.npz"):
            SafetyRegions.load(file, xeno)
    with pytest.raises(InputError, match="cannot be read"):
        SafetyRegions.load(tmp_path / "missing.npz", xeno)
    with pytest.raises(InputError, match="cannot be read"):
        SafetyRegions.load(tmp_path, xeno)


def resealed(regions, file, **changes):
    """Write a file whose digest is right and whose content is not what regions have."""
    regions.save(file)
    with np.load(file) as archive:
        tables = dict(archive)
    about = json.loads(str(tables["about"])) | changes.pop("about", {})
    stream = io.BytesIO()
    np.savez(stream, **(tables | {"about": np.array(json.dumps(about))} | changes))
    file.write_bytes(sealed(stream.getvalue()))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"about": {"format": "narrows safety regions 1"}}, "not the format.*anew.*regions 1"),
        ({"about": {"options": {"cell": 0.1}}}, "options are not those of this version"),
        ({"about": {"track": "wide"}}, "do not fit each other.*wide"),
        ({"levels": np.zeros((3, 4), dtype=np.uint8)}, "do not fit each other.*rows, columns"),
        ({"outline": np.full((4, 2), math.nan)}, "another chair.*nan"),
    ],
)
def test_files_of_other_versions_and_of_no_sense_are_refused(
    xeno, xeno_regions, tmp_path, changes, message
):
    file = tmp_path / "regions.npz"
    resealed(xeno_regions, file, **changes)
    with pytest.raises(InputError, match=message):
        SafetyRegions.load(file, xeno)


def test_what_the_regions_allow_for_cannot_be_changed_unnoticed(xeno, xeno_regions, tmp_path):
    file = tmp_path / "regions.npz"
    resealed(xeno_regions, file)
    SafetyRegions.load(file, xeno)
    content = file.read_bytes()
    texts = [text.encode("utf-32-le") for text in ('"latency": 0.1', '"latency": 0.0')]
    file.write_bytes(content.replace(*texts))
    assert file.read_bytes() != content
    with pytest.raises(InputError, match="damaged"):
        SafetyRegions.load(file, xeno)
