"""Help through a door: it brings the chair through, and breaks none of the assistant's promises."""

import itertools
import math

import numpy as np
import pytest

from narrows.errors import ShapeError
from narrows.reactive.door_ahead import DoorAhead
from narrows.reactive.door_blend import DoorBlend, DoorBlendOptions
from narrows.se2 import compose, invert, transform

WIDTH = 0.80
WALL_X = 2.0


def sensed(pose):
    """Return the door as a perfect sensor tells it, or None once the chair is in it."""
    x, y, heading = compose(invert(pose), [WALL_X, 0.0, 0.0])
    return DoorAhead(float(x), float(y), float(heading), WIDTH) if x > 0.3 else None


def through(door):
    """Return an S-shaped path onto the door's axis and through it, in the body frame.

    A smooth step sideways that ends a body's length before the wall; clear of an 0.80 m door for
    starts that head for it from far enough.
    """
    start = invert(door.pose)  # the chair, in the door's frame
    ahead = np.linspace(start[0], 1.5, 80)
    share = np.clip((ahead - start[0]) / (-0.95 - start[0]), 0.0, 1.0)
    slope0 = math.tan(start[2])
    span = -0.95 - start[0]
    # Hermite cubic from the chair's place and heading to the axis.
    across = start[1] * (1 - 3 * share**2 + 2 * share**3)
    across += slope0 * span * (share - 2 * share**2 + share**3)
    heading = np.arctan2(np.gradient(across, ahead), 1.0)
    return compose(door.pose, np.stack([ahead, across, heading], axis=-1))


@pytest.fixture
def walls(simulated):
    posts = (
        simulated.box(WALL_X, WALL_X + 0.1, -2.5, -WIDTH / 2.0),
        simulated.box(WALL_X, WALL_X + 0.1, WIDTH / 2.0, 2.5),
    )
    return simulated.outlines(*posts)


def drive(simulated, walls, driver, source, *, start, seconds=10.0, options=None):
    blend = None if source is None else DoorBlend(source, options)
    return simulated.drive(
        driver,
        walls,
        assistant=simulated.assistant(door_blend=blend),
        seconds=seconds,
        start=start,
        door=sensed,
    )


def hasty(time, pose):
    """Look 0.8 m ahead on the door's axis and go at full speed."""
    bearing = math.atan2(-pose[1], 0.8) - pose[2]
    return 0.8, max(-1.2, min(1.2, 2.0 * math.sin(bearing)))


def test_a_hasty_driver_who_would_stick_at_the_post_gets_through(simulated, walls):
    start = (-0.2, 0.4, 0.0)
    alone = drive(simulated, walls, hasty, None, start=start)
    helped = drive(simulated, walls, hasty, through, start=start)
    assert alone.poses[-1][0] < WALL_X - 0.5
    assert helped.poses[-1][0] > WALL_X
    assert min(alone.gap, helped.gap) > 0.01
    weights = [row["door_weight"] for row in helped.signals]
    assert max(weights) == pytest.approx(DoorBlendOptions().share)
    step = max(abs(b - a) for a, b in itertools.pairwise(weights))
    assert step <= 0.9 * 0.02 / 0.6 + 1e-9


def test_a_path_into_the_wall_is_not_followed_into_it(simulated, walls):
    def lying(door):
        return compose(door.pose, [[-2.0, 0.9, 0.0], [0.0, 0.9, 0.0], [2.0, 0.9, 0.0]])

    result = drive(simulated, walls, hasty, lying, start=(0.0, 0.6, 0.0))
    asked, taken, _ = result.arrays()
    assert result.gap > 0.01
    assert (taken[:, 0] <= asked[:, 0] + 1e-9).all()
    assert (taken[:, 0] >= 0.0).all()


def test_the_user_s_speed_is_never_exceeded_and_letting_go_stops(simulated, walls):
    def driver(time, pose):
        return (0.3, hasty(time, pose)[1]) if time < 4.0 else (0.0, 0.0)

    result = drive(simulated, walls, driver, through, start=(-0.5, 0.2, 0.0), seconds=6.0)
    _, taken, _ = result.arrays()
    assert max(row["door_weight"] for row in result.signals) > 0.5
    assert taken[:, 0].max() <= 0.3 + 1e-9
    assert taken[-1].tolist() == [0.0, 0.0]


@pytest.mark.parametrize("way_out", ["steering away", "backing off"])
def test_who_wants_elsewhere_drives_alone(simulated, walls, way_out):
    def driver(time, pose):
        if time < 2.0:
            return hasty(time, pose)
        return (0.4, 1.2) if way_out == "steering away" else (-0.3, 0.0)

    result = drive(simulated, walls, driver, through, start=(-0.8, 0.0, 0.0), seconds=4.5)
    weights = [row["door_weight"] for row in result.signals]
    assert weights[95] > 0.5
    assert weights[-1] == 0.0


def test_a_driver_who_heads_elsewhere_is_never_taken_over(simulated, walls):
    asked = []

    def source(door):
        asked.append(door)

    result = drive(
        simulated, walls, lambda time, pose: (0.4, 0.9), source, start=(-0.5, 1.0, 0.6), seconds=2.0
    )
    assert not asked
    assert max(row["door_weight"] for row in result.signals) == 0.0


def test_without_a_path_the_user_drives_and_is_not_asked_for_each_step(simulated, walls):
    calls = []

    def source(door):
        calls.append(door)

    result = drive(simulated, walls, hasty, source, start=(-0.8, 0.0, 0.0), seconds=2.5)
    assert 1 <= len(calls) <= 3
    assert max(row["door_weight"] for row in result.signals) == 0.0


def test_the_remembered_door_moves_with_the_chair():
    blend = DoorBlend(through)
    blend.steer(0.0, 0.02, (0.5, 0.0), np.zeros(3), DoorAhead(2.0, 0.0, 0.0, WIDTH))
    moved = np.array([0.5, 0.0, 0.3])
    blend.steer(0.02, 0.02, (0.5, 0.0), moved, None)
    corner = transform(invert(moved), np.array([[2.0, 0.0]]))[0]
    assert blend.door is not None
    assert [blend.door.x, blend.door.y] == pytest.approx(corner)
    assert blend.door.heading == pytest.approx(-0.3)


def test_doors_and_paths_of_no_sense_are_refused():
    with pytest.raises(ShapeError, match="positive width"):
        DoorAhead(1.0, 0.0, 0.0, 0.0)
    door = DoorAhead(2.0, 0.0, 0.0, WIDTH)
    for path, message in (([[1.0, 0.0]], "shape"), ([[0, 0, 0], [1, math.nan, 0]], "finite")):
        with pytest.raises(ShapeError, match=message):
            DoorBlend(lambda door, path=path: np.array(path)).steer(
                0.0, 0.02, (0.5, 0.0), np.zeros(3), door
            )
