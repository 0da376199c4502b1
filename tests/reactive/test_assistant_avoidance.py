"""To which side the assistant steers, where it does not, and how it gives the way back."""

import math

import numpy as np
import pytest

from narrows.interfaces import Percept
from narrows.reactive.assistant_options import AssistantOptions, AssistantState

PERIOD = 0.02


def test_who_heads_straight_for_a_wall_gets_there_and_is_not_steered(simulated):
    wall = simulated.outlines(simulated.box(2.0, 2.1, -2.0, 2.0))
    drive = simulated.drive(
        lambda time, pose: (0.8, 0.0), wall, assistant=simulated.assistant(), seconds=6.0
    )
    _, taken, _ = drive.arrays()
    assert np.abs(taken[:, 1]).max() < 1e-9
    assert taken[-1].tolist() == [0.0, 0.0]
    # 25 mm are kept; a cell of 30 mm and its twin at low speed may stand in the way.
    assert 0.02 < drive.gap < 0.08
    assert drive.signals[-1]["state"] == AssistantState.BRAKING


def passing(simulated, indicated, **options):
    """Drive past a post ahead on the right with a bend to the left indicated."""
    post = simulated.outlines(simulated.box(2.1, 2.2, -0.35, 0.1))
    return simulated.drive(
        indicated,
        post,
        assistant=simulated.assistant(AssistantOptions(**options)),
        seconds=9.0,
    )


def test_an_obstacle_is_passed_on_the_side_indicated_and_the_orientation_restored(simulated):
    bend = 0.1
    drive = passing(simulated, lambda time, pose: (0.5, bend))
    states = [row["state"] for row in drive.signals]
    avoided = states.index(AssistantState.OBSTACLE_AVOIDANCE)
    _, taken, _ = drive.arrays()
    assert taken[avoided : avoided + 80, 1].max() > 3.0 * bend
    assert drive.poses[-1][0] > 2.5
    assert AssistantState.RESTORING_ORIENTATION in states[avoided:]
    # The user's own way turns by omega / v for each metre driven.
    way = float(np.abs(taken[avoided:, 0]).sum() * PERIOD)
    turned = drive.poses[-1][2] - drive.poses[avoided][2]
    assert turned == pytest.approx(bend / 0.5 * way, abs=math.radians(4.0))
    assert states[-1] == AssistantState.FULL_USER_CONTROL


def test_nothing_is_restored_for_a_user_who_moves_the_stick(simulated):
    def driver(time, pose):
        return (0.5, 0.1) if pose[0] < 1.5 else (0.3, 0.1)

    drive = passing(simulated, driver)
    states = [row["state"] for row in drive.signals]
    moves = next(k for k, pose in enumerate(drive.poses) if pose[0] >= 1.5)
    assert AssistantState.OBSTACLE_AVOIDANCE in states[:moves]
    assert AssistantState.OBSTACLE_AVOIDANCE not in states[moves:]
    assert AssistantState.RESTORING_ORIENTATION not in states[moves:]


def test_without_steering_only_the_speed_is_limited(simulated):
    drive = passing(simulated, lambda time, pose: (0.5, 0.1), steers=False)
    _, taken, _ = drive.arrays()
    moving = taken[:, 0] > 0.05
    assert np.abs(taken[moving, 1]).max() < 0.1 + 1e-9
    assert drive.gap > 0.01


def test_a_chair_between_the_posts_of_a_door_drives_on(simulated):
    posts = (simulated.box(1.5, 1.6, -2.0, -0.4), simulated.box(1.5, 1.6, 0.4, 2.0))
    drive = simulated.drive(
        lambda time, pose: (0.8, -1.5 * pose[1] - 0.8 * pose[2]),
        simulated.outlines(*posts),
        assistant=simulated.assistant(),
        seconds=8.0,
        start=(0.0, 0.03, 0.0),
    )
    assert drive.poses[-1][0] > 2.0
    assert drive.gap > 0.02


def test_a_chair_beside_a_wall_may_creep_along_it_but_not_into_it(simulated, xeno):
    # 8 mm: less than the margin of 10 mm, more than the quarter of it that creeping needs.
    wall = simulated.outlines(simulated.box(-1.0, 2.0, 0.338, 0.4))

    def end(v, omega):
        drive = simulated.drive(
            lambda time, pose: (v, omega),
            wall,
            assistant=simulated.assistant(),
            seconds=3.0,
            percept=lambda time, rows: Percept(time, rows, 0.0),
        )
        assert drive.gap > 0.002
        return drive.poses[-1]

    assert end(0.4, 0.0)[0] > 0.05
    assert end(-0.4, 0.0)[0] < -0.05
    assert abs(end(0.0, 0.8)[2]) < 0.02  # front into it
    assert abs(end(0.0, -0.8)[2]) < 0.03  # rear into it


def test_what_hangs_above_the_chair_is_passed_under(simulated, xeno):
    wall = simulated.outlines(simulated.box(1.5, 1.6, -1.0, 1.0))

    def percept(time, rows):
        return Percept(time, np.column_stack([rows[:, :2], np.full(len(rows), 2.0)]), 0.015)

    drive = simulated.drive(
        lambda time, pose: (0.8, 0.0),
        wall,
        assistant=simulated.assistant(),
        seconds=3.0,
        percept=percept,
    )
    assert drive.poses[-1][0] > 1.5
    assert xeno.height < 2.0


def test_steps_are_the_same_in_the_mirror(simulated):
    points = simulated.outlines(simulated.box(1.3, 1.5, 0.1, 0.8))
    ends = []
    for side in (1.0, -1.0):
        drive = simulated.drive(
            lambda time, pose, side=side: (0.5, -0.1 * side),
            points * [1.0, side],
            assistant=simulated.assistant(),
            seconds=3.0,
        )
        ends.append(drive.poses[-1] * [1.0, side, side])
    assert ends[0] == pytest.approx(ends[1], abs=0.02)  # cells lie on one side of their edges
