"""What the assistant does when it sees late, badly or nothing, or knows its motion no more."""

import math

import numpy as np
import pytest

from narrows.interfaces import Percept
from narrows.reactive.assistant_options import AssistantOptions
from narrows.reactive.assistant_view import View
from narrows.se2 import invert, transform

NOTHING = np.zeros((0, 2))


SPOILT = {
    "missing": lambda time, rows: None,
    "not a number": lambda time, rows: Percept(time, np.vstack([rows, [[math.nan] * 3]])),
    "infinite": lambda time, rows: Percept(time, np.array([[math.inf, 0.0, 0.1]])),
    "from the future": lambda time, rows: Percept(time + 1.0, rows),
    "never": lambda time, rows: Percept(-math.inf, rows),
    "too old": lambda time, rows: Percept(time - 0.7, rows),
    "no spread": lambda time, rows: Percept(time, rows, math.nan),
}


@pytest.mark.parametrize("fault", SPOILT)
def test_a_chair_that_perceives_nothing_of_use_stops_before_what_it_saw(simulated, fault):
    def percept(time, rows):
        return SPOILT[fault](time, rows) if time > 1.6 else Percept(time, rows, 0.015)

    wall = simulated.outlines(simulated.box(2.1, 2.2, -2.0, 2.0))
    drive = simulated.drive(
        lambda time, pose: (0.8, 0.0),
        wall,
        assistant=simulated.assistant(),
        seconds=4.5,
        percept=percept,
    )
    _, taken, _ = drive.arrays()
    assert taken[80, 0] > 0.3
    assert (np.diff(taken[81:, 0]) <= 1e-12).all()
    assert (taken[-20:] == 0.0).all()
    assert drive.gap > 0.02
    assert drive.signals[-1]["trust"] == 0.0


def test_a_chair_that_never_saw_anything_never_moves(simulated):
    drive = simulated.drive(
        lambda time, pose: (0.8, 0.5),
        NOTHING,
        assistant=simulated.assistant(),
        seconds=0.5,
        percept=lambda time, rows: None,
    )
    assert (drive.arrays()[1] == 0.0).all()


def test_the_older_the_percept_the_slower_the_chair(simulated):
    def fastest(age):
        drive = simulated.drive(
            lambda time, pose: (0.8, 0.0),
            NOTHING,
            assistant=simulated.assistant(),
            seconds=3.0,
            percept=lambda time, rows: Percept(time - age, rows),
        )
        return drive.arrays()[1][:, 0].max()

    assert fastest(0.25) == pytest.approx(0.8)
    assert fastest(0.425) == pytest.approx(0.4, abs=0.01)  # half-way from 0.25 s to 0.6 s
    assert fastest(0.6) == 0.0


def test_what_appears_all_of_a_sudden_is_braked_for_fully(simulated):
    # Half a metre ahead at 0.8 m/s: full braking needs 0.4 m, a comfortable one 0.7 m.
    wall = simulated.outlines(simulated.box(2.5, 2.6, -1.0, 1.0))
    seen = []

    def percept(time, rows):
        is_near = len(rows) > 0 and rows[:, 0].min() < 0.85 + 0.55
        seen.append(is_near or any(seen[-1:]))
        return Percept(time, rows if seen[-1] else rows[:0], 0.015)

    drive = simulated.drive(
        lambda time, pose: (0.8, 0.0),
        wall,
        assistant=simulated.assistant(),
        seconds=5.0,
        percept=percept,
    )
    _, taken, full = drive.arrays()
    assert taken[:, 0].max() == pytest.approx(0.8)
    assert full.sum() > 5
    assert drive.gap > 0.0
    assert np.abs(taken[:, 1]).max() < 1e-9


def test_what_was_seen_last_is_carried_along_by_the_chair_s_motion():
    view = View(0.25, 0.6)
    points = np.array([[1.0, 0.5, 0.1], [2.0, -1.0, 0.2]])
    view.update(0.0, Percept(0.0, points, 0.02, points[:, :2]), np.zeros(3))
    moved = np.array([0.3, 0.1, 0.4])
    view.update(0.02, None, moved)
    assert view.trust == 0.0
    assert view.points[:, :2] == pytest.approx(transform(invert(moved), points[:, :2]))
    assert view.unknown == pytest.approx(view.points[:, :2])
    assert view.points[:, 2] == pytest.approx(points[:, 2])


def test_it_stops_before_places_it_knows_nothing_of(simulated):
    places = simulated.outlines(simulated.box(2.0, 2.5, -2.0, 2.0))

    def drive(**options):
        def percept(time, rows):
            return Percept(time, np.zeros((0, 3)), 0.015, rows[:, :2])

        return simulated.drive(
            lambda time, pose: (0.8, 0.0),
            places,
            assistant=simulated.assistant(AssistantOptions(**options)),
            seconds=7.0,
            percept=percept,
        )

    assert drive().gap > 0.02
    for speed in (0.1, 0.3):
        feeling = drive(unknown_speed=speed)
        assert feeling.gap < 0.0
        taken = feeling.arrays()[1][:, 0]
        inside = [taken[k] for k, pose in enumerate(feeling.poses) if 1.2 < pose[0] < 1.5]
        assert np.array(inside) == pytest.approx(speed, abs=1e-6)


def test_what_reaches_far_beyond_its_points_is_kept_further_off(simulated):
    wall = simulated.outlines(simulated.box(2.0, 2.1, -2.0, 2.0))
    drive = simulated.drive(
        lambda time, pose: (0.8, 0.0),
        wall,
        assistant=simulated.assistant(),
        seconds=6.0,
        percept=lambda time, rows: Percept(time, rows, 0.08),  # the regions allow for 15 mm
    )
    assert 0.08 < drive.gap < 0.15


def test_a_chair_set_down_on_unknown_ground_may_leave_it(simulated):
    places = simulated.outlines(simulated.box(-0.2, 0.8, -0.3, 0.3), step=0.1)
    drive = simulated.drive(
        lambda time, pose: (0.5, 0.0),
        NOTHING,
        assistant=simulated.assistant(),
        seconds=2.0,
        percept=lambda time, rows: Percept(time, rows, 0.015, places),
    )
    assert drive.poses[-1][0] > 0.3


def test_a_chair_that_runs_faster_than_told_is_braked_fully(simulated):
    assistant = simulated.assistant()
    wall = np.column_stack([np.full(40, 1.2), np.linspace(-0.5, 0.5, 40), np.full(40, 0.1)])
    for k in range(30):
        assistant.step(0.02 * k, [0.2, 0.0], [0.1, 0.0], Percept(0.02 * k, wall, 0.015))
    assistant.step(0.6, [0.2, 0.0], [0.8, 0.0], Percept(0.6, wall, 0.015))
    assert assistant.signals["full_braking"] == 1.0


def test_more_points_than_can_be_looked_at_stop_the_chair(simulated):
    assistant = simulated.assistant()
    rng = np.random.default_rng(0)
    crowd = np.column_stack([rng.uniform(-2.0, 2.0, (200_000, 2)), np.full(200_000, 0.1)])
    for k in range(5):
        taken = assistant.step(0.02 * k, [0.8, 0.0], [0.0, 0.0], Percept(0.02 * k, crowd))
    assert taken.tolist() == [0.0, 0.0]


def test_a_motion_that_is_not_known_stops_the_chair(simulated):
    assistant = simulated.assistant()
    for k in range(150):
        motion = [math.nan, 0.0] if k > 40 else [0.0, 0.0]
        taken = assistant.step(0.02 * k, [0.8, 0.0], motion, Percept(0.02 * k, np.zeros((0, 3))))
        if k == 40:
            assert taken[0] > 0.2
    assert taken[0] == 0.0
