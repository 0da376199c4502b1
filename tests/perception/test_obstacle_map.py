"""The map remembers what it saw, forgets what it sees gone, and never takes unknown for free."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import InputError, ShapeError
from narrows.perception.map_options import MapOptions, bands_of
from narrows.perception.obstacle_map import ObstacleMap
from narrows.perception.ranges import LaserScan, ScannerMounting, UltrasoundReadings
from narrows.perception.surroundings import Cell
from narrows.vehicle import Layer, Vehicle

FRONT = ScannerMounting(0.12)
CHAIR = Vehicle.rectangle(1.2, 0.7, 0.25)


def half_turn(ranges, **more):
    ranges = np.asarray(ranges, dtype=float)
    mounting = more.pop("mounting", FRONT)
    return LaserScan(ranges, -np.pi / 2, np.pi / (len(ranges) - 1), mounting, **more)


def wall_ranges(distance, count=361):
    """What beams of a half turn measure to an infinitely wide wall straight ahead."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, count)
    ahead = np.cos(angles)
    return np.where(ahead > 1e-9, distance / np.maximum(ahead, 1e-9), np.inf)


def state(chart, x, y, **more):
    """What the map says about a place of the world."""
    x_from, _, y_from, _ = chart.extent
    cell = chart.options.cell
    return chart.states(**more)[int((x - x_from) // cell), int((y - y_from) // cell)]


def test_a_new_map_knows_nothing_and_says_so():
    chart = ObstacleMap()
    seen = chart.percept()
    assert (chart.states() == Cell.UNKNOWN).all()
    assert len(seen.points) == 0
    assert seen.time == -np.inf
    assert not chart.is_free([[0.0, 0.0], [1.0, 0.0]]).any()


def test_a_wall_is_occupied_what_lies_before_it_free_and_behind_it_unknown():
    chart = ObstacleMap()
    chart.add_scan(half_turn(wall_ranges(2.01)))
    assert state(chart, 2.01, 0.3) == Cell.OBSTACLE
    assert state(chart, 1.5, 0.3) == Cell.FREE
    assert state(chart, 2.2, 0.3) == Cell.UNKNOWN
    assert state(chart, -0.5, 0.3) == Cell.UNKNOWN
    assert list(chart.is_free([[1.5, 0.3], [2.2, 0.3], [9.0, 0.0]])) == [True, False, False]


def test_infinity_is_seen_free_to_the_border_nan_not_at_all():
    chart = ObstacleMap()
    ranges = np.full(361, np.inf)
    ranges[:180] = np.nan  # the right half does not answer
    chart.add_scan(half_turn(ranges))
    assert state(chart, 1.0, 0.5) == Cell.FREE
    assert state(chart, 3.7, 3.0) == Cell.FREE
    assert state(chart, 1.0, -0.5) == Cell.UNKNOWN


@pytest.mark.parametrize("value", [np.nan, 0.0, -1.0])
def test_a_scan_without_an_answer_is_silence(value):
    chart = ObstacleMap()
    chart.add_scan(half_turn(wall_ranges(2.0), time=1.0))
    before = chart.states()
    for k in range(10):
        chart.add_scan(half_turn(np.full(361, value), time=2.0 + k))
    assert np.array_equal(chart.states(), before)
    assert chart.percept().time == 1.0


def test_the_sensor_silent_longest_gives_the_time():
    chart = ObstacleMap(MapOptions(sensors=("front", "rear")))
    chart.add_scan(half_turn(wall_ranges(2.0), time=3.0, sensor="front"))
    assert chart.percept().time == -np.inf  # the rear one has never spoken
    chart.add_scan(half_turn(wall_ranges(2.0), time=2.5, sensor="rear"))
    assert chart.percept().time == 2.5
    chart.add_scan(half_turn(wall_ranges(2.0), time=2.0, sensor="rear"))  # late: no step back
    assert chart.heard == {"front": 3.0, "rear": 2.5}


def test_a_sensor_nobody_named_is_refused_before_anything_changes():
    chart = ObstacleMap(MapOptions(sensors=("front",)))
    with pytest.raises(InputError, match="no such sensor"):
        chart.add_scan(half_turn(wall_ranges(2.0)))
    assert (chart.states() == Cell.UNKNOWN).all()


@pytest.mark.parametrize(("scans", "doubted", "gone"), [(1, 1, 5), (2, 5, 9), (40, 13, 17)])
def test_what_has_left_is_forgotten_when_its_place_is_seen_free(scans, doubted, gone):
    chart = ObstacleMap()
    person = wall_ranges(3.0)
    person[170:191] = 1.51
    for _ in range(scans):
        chart.add_scan(half_turn(person))
    history = []
    for _ in range(gone):
        assert state(chart, 1.51, 0.01) != Cell.FREE
        chart.add_scan(half_turn(wall_ranges(3.0)))
        history.append(state(chart, 1.51, 0.01))
    assert history.index(Cell.UNKNOWN) == doubted - 1
    assert history[-1] == Cell.FREE


def test_one_hit_makes_a_place_occupied_however_long_it_was_free():
    chart = ObstacleMap()
    for _ in range(50):
        chart.add_scan(half_turn(wall_ranges(3.0)))
    chart.add_points([[1.51, 0.01, 0.12]], time=0.0, sensor="other")
    assert state(chart, 1.51, 0.01) == Cell.OBSTACLE


def test_what_is_hidden_behind_something_is_remembered():
    chart = ObstacleMap()
    chart.add_scan(half_turn(wall_ranges(2.5)))
    for _ in range(100):
        chart.add_scan(half_turn(wall_ranges(1.0)))
    assert state(chart, 2.51, 0.0) == Cell.OBSTACLE
    assert state(chart, 2.0, 0.0) == Cell.FREE


def test_what_lies_behind_the_chair_is_remembered_where_it_stands():
    chart = ObstacleMap()
    chart.add_points([[1.01, 0.21, 0.12]], time=0.0, sensor="laser")
    for k in range(1, 201):
        chart.move_to([0.0125 * k, 0.0, 0.0])
    assert state(chart, 1.01, 0.21) == Cell.OBSTACLE
    assert chart.percept().points[0, :2] == pytest.approx([-1.49, 0.21], abs=0.02)
    chart.move_to([10.0, 0.0, 0.0])
    assert len(chart.percept().points) == 0
    chart.move_to([2.5, 0.0, 0.0])  # what has left the map does not come back
    assert len(chart.percept().points) == 0


def test_turning_blurs_nothing():
    chart = ObstacleMap()
    chart.add_scan(half_turn(wall_ranges(2.0)))
    before = chart.states()
    for turn in np.linspace(0.0, 20.0, 200):
        chart.move_to([0.0, 0.0, turn])
    assert np.array_equal(chart.states(), before)
    ahead = chart.percept().points[:, :2]
    turned = [[np.cos(20.0), -np.sin(20.0)], [np.sin(20.0), np.cos(20.0)]]
    assert (ahead @ np.transpose(turned))[:, 0] == pytest.approx(np.full(len(ahead), 2.0), abs=0.02)


@settings(deadline=None, max_examples=20, derandomize=True)
@given(st.lists(st.tuples(*[st.floats(-1.5, 1.5)] * 2), min_size=1, max_size=6))
def test_a_small_map_knows_what_a_large_one_knows_of_where_it_always_was(steps):
    small = ObstacleMap(MapOptions(side=3.0, cell=0.05, bands=(0.0, 0.5)))
    large = ObstacleMap(MapOptions(side=30.0, cell=0.05, bands=(0.0, 0.5)))
    kept = np.ones((60, 60), dtype=bool)
    pose = np.zeros(3)
    for step in steps:
        pose = pose + np.array([*step, 0.3])
        before = small.extent
        for chart in (small, large):
            chart.move_to(pose)
            chart.add_scan(half_turn(wall_ranges(1.0, 91)))
        x, y = (round((small.extent[k] - before[k]) / 0.05) for k in (0, 2))
        moved = np.zeros_like(kept)
        if abs(x) < 60 and abs(y) < 60:
            here, there = (slice(max(0, d), 60 + min(0, d)) for d in (x, y)), (x, y)
            i, j = here
            target = (
                slice(i.start - there[0], i.stop - there[0]),
                slice(j.start - there[1], j.stop - there[1]),
            )
            moved[target] = kept[i, j]
        kept = moved
    i, j = (round((small.extent[k] - large.extent[k]) / 0.05) for k in (0, 2))
    window = large.states()[i : i + 60, j : j + 60]
    assert np.array_equal(small.states()[kept], window[kept])


def test_the_chair_stays_in_the_middle_within_half_a_cell():
    chart = ObstacleMap()
    for x in np.linspace(0.0, 0.1, 37):
        chart.move_to([x, -3.0 * x, 0.0])
        low_x, high_x, low_y, high_y = chart.extent
        assert abs(0.5 * (low_x + high_x) - x) <= 0.0125 + 1e-9
        assert abs(0.5 * (low_y + high_y) + 3.0 * x) <= 0.0125 + 1e-9


def test_after_a_jump_further_than_the_map_nothing_is_known():
    chart = ObstacleMap()
    chart.add_scan(half_turn(wall_ranges(2.0)))
    chart.move_to([1e4, -1e4, 0.0])
    assert (chart.states() == Cell.UNKNOWN).all()
    assert state(chart, 1e4, -1e4) == Cell.UNKNOWN


@pytest.mark.parametrize("pose", [[np.nan, 0, 0], [0, np.inf, 0], [0, 0], np.zeros((2, 3))])
def test_what_is_no_pose_is_refused_and_changes_nothing(pose):
    chart = ObstacleMap()
    chart.add_scan(half_turn(wall_ranges(2.0)))
    before = chart.states()
    with pytest.raises(ShapeError, match="a pose is finite"):
        chart.move_to(pose)
    assert np.array_equal(chart.states(), before)


def test_a_pose_too_far_away_for_cells_is_refused_and_a_far_one_is_not():
    chart = ObstacleMap(pose=[1e7, -1e7, 0.0])
    chart.add_scan(half_turn(wall_ranges(2.0)))
    assert state(chart, 1e7 + 1.0, -1e7) == Cell.FREE
    with pytest.raises(InputError, match="too far away for cells"):
        chart.move_to([1e18, 0.0, 0.0])
    assert chart.pose[0] == 1e7


@pytest.mark.parametrize("reach", [0.0, -1.0, np.nan])
def test_a_percept_without_a_reach_is_refused_not_empty(reach):
    with pytest.raises(InputError, match="no reach"):
        ObstacleMap().percept(reach=reach)


def test_a_beam_at_ankle_height_says_nothing_of_the_height_of_the_head():
    chart = ObstacleMap()
    chart.add_scan(half_turn(wall_ranges(2.0)))
    assert state(chart, 1.0, 0.0, heights=(0.1, 0.2)) == Cell.FREE
    assert state(chart, 1.0, 0.0, heights=(1.1, 1.2)) == Cell.UNKNOWN
    assert chart.certainty(0.12).max() == chart.options.hit
    assert not chart.certainty(1.15).any()
    with pytest.raises(InputError, match="no band there"):
        chart.certainty(5.0)


def test_a_table_top_and_the_floor_beneath_it_are_told_apart():
    chart = ObstacleMap()
    chart.add_points([[1.01, 0.01, 0.72]], time=0.0, sensor="camera")
    chart.add_scan(half_turn(wall_ranges(2.0)))
    assert state(chart, 1.01, 0.01) == Cell.OBSTACLE
    assert state(chart, 1.01, 0.01, heights=(0.0, 0.7)) == Cell.FREE
    assert chart.percept(heights=(0.7, 0.8)).points[:, 2] == pytest.approx([0.75])


def test_a_slanting_ray_clears_each_place_at_its_height_only():
    chart = ObstacleMap()
    chart.add_points([[2.01, 0.01, 0.0]], time=0.0, sensor="camera", eye=[0.01, 0.01, 1.0])
    for x in (0.51, 1.01, 1.51):
        z = 1.0 - (x - 0.01) / 2.0
        assert state(chart, x, 0.01, heights=(z - 0.02, z + 0.02)) == Cell.FREE
        assert state(chart, x, 0.01, heights=(z + 0.2, z + 0.3)) == Cell.UNKNOWN
        assert state(chart, x, 0.01, heights=(0.0, z - 0.2)) == Cell.UNKNOWN
    assert len(chart.percept().points) == 0  # a point of the floor is no obstacle


def test_a_hit_is_not_cleared_by_rays_of_the_same_update():
    chart = ObstacleMap()
    pole = wall_ranges(3.0, 1441)
    pole[721] = 1.52  # one beam of many that pass through the same cell
    for _ in range(20):
        chart.add_scan(half_turn(pole))
    assert state(chart, 1.52, 0.004) == Cell.OBSTACLE


def test_where_the_chair_stands_is_free_and_what_it_sees_of_itself_is_left_out():
    chart = ObstacleMap(vehicle=CHAIR)
    assert state(chart, 0.0, 0.0, heights=(0.1, 0.2)) == Cell.FREE
    assert state(chart, 0.9, 0.3, heights=(0.1, 0.2)) == Cell.FREE
    assert state(chart, 1.05, 0.0) == Cell.UNKNOWN
    chart.add_points([[0.9, 0.2, 0.12], [1.0, 0.2, 0.12]], time=0.0, sensor="laser")
    assert chart.percept().points[:, 0] == pytest.approx([1.0], abs=0.02)


def test_a_wall_that_an_error_of_the_pose_puts_into_the_body_stays_where_it_is():
    chart = ObstacleMap(vehicle=CHAIR)
    chart.add_points([[1.01, 0.01, 0.12], [1.51, 0.01, 0.12]], time=0.0, sensor="laser")
    chart.move_to([0.08, 0.0, 0.0])  # the wall is 2 cm inside now: an error of odometry
    assert state(chart, 1.01, 0.01) == Cell.OBSTACLE
    chart.move_to([0.8, 0.0, 0.0])  # and where the chair's middle stands there is no wall
    assert state(chart, 1.01, 0.01) == Cell.FREE
    assert state(chart, 1.51, 0.01) == Cell.FREE


def test_a_percept_gives_obstacles_and_the_end_of_the_known_in_the_body_frame():
    chart = ObstacleMap(pose=[5.0, -2.0, np.pi / 2])
    chart.add_scan(half_turn(wall_ranges(2.0), time=4.0))
    seen = chart.percept()
    assert seen.time == 4.0
    assert seen.spread == pytest.approx(0.025 / np.sqrt(2.0))
    near = seen.points[np.abs(seen.points[:, 1]) < 1.0]
    assert near[:, 0] == pytest.approx(np.full(len(near), 2.0), abs=0.02)
    # Behind the scanner's axis nothing is known; the border is where the chair is.
    assert np.abs(seen.unknown[:, 0]).min() < 0.05
    assert not chart.is_free(seen.unknown).any()
    reach = chart.percept(reach=1.0)
    assert len(reach.points) == 0
    assert np.hypot(*reach.unknown.T).max() <= 1.0


def test_echoes_fill_their_arc_and_clear_nothing():
    chart = ObstacleMap()
    echoes = UltrasoundReadings([1.0, 3.0], [[0, 0, 0], [0, 0, np.pi]], time=1.0)
    chart.add_echoes(echoes)
    assert state(chart, 0.99, 0.15) == Cell.OBSTACLE
    assert (chart.states() != Cell.FREE).all()
    assert chart.heard == {"ultrasound": 1.0}


def test_points_that_are_not_finite_are_left_out_and_only_such_points_are_silence():
    chart = ObstacleMap()
    chart.add_points([[np.nan, 0, 0.5], [np.inf, 0, 0.5]], time=1.0, sensor="camera")
    chart.add_points(np.zeros((0, 3)), time=1.0, sensor="camera")
    assert chart.time == -np.inf
    chart.add_points([[np.nan, 0, 0.5], [1e300, 0, 0.5], [1, 0, 0.5]], time=1.0, sensor="camera")
    assert len(chart.percept().points) == 1
    with pytest.raises(ShapeError, match=r"points must be \(N, 3\)"):
        chart.add_points(np.zeros((4, 2)), time=1.0, sensor="camera")
    with pytest.raises(InputError, match="not a time"):
        chart.add_points([[1, 0, 0.5]], time=np.nan, sensor="camera")


def test_many_updates_do_not_mix_up_which_touched_what():
    chart = ObstacleMap()
    for _ in range(400):  # more than there are marks
        chart.add_scan(half_turn(wall_ranges(2.01)))
    assert state(chart, 2.01, 0.3) == Cell.OBSTACLE
    assert chart.certainty(0.12).min() == -chart.options.hit


@pytest.mark.parametrize(
    "change",
    [
        {"cell": 0.0},
        {"side": 1e6},
        {"side": np.nan},
        {"bands": (0.0,)},
        {"bands": (0.0, 1.0, 0.5)},
        {"bands": tuple(range(40))},
        {"miss": 0},
        {"hit": 30},
        {"short": -1.0},
    ],
)
def test_options_that_make_no_map_are_refused(change):
    with pytest.raises(InputError):
        MapOptions(**change)


def test_bands_begin_and_end_with_the_layers_of_a_chair():
    tray = Layer(CHAIR.layers[0].polygon, (0.62, 0.75))
    seat = Layer(CHAIR.layers[0].polygon, (0.0, 0.5))
    edges = bands_of(Vehicle(layers=(seat, tray)))
    assert {0.025, 0.5, 0.62, 0.75} <= set(edges)
    assert max(np.diff(edges)) <= 0.1 + 1e-9
    MapOptions(bands=edges)
