"""Where a chair comes no nearer it backs off, changes sides, goes round, and at last gives up."""

import math

import numpy as np
import pytest

from narrows.errors import ShapeError
from narrows.reactive.navigator_persistence import Persistence, PersistenceOptions

TARGET = np.array([5.0, 0.0])
OPTIONS = PersistenceOptions(patience=2.0, change=10.0, detour=1.0, endurance=200.0, retreats=2)


def watching(options=OPTIONS, *, reverses=True):
    return Persistence(TARGET, 0.1, 1.0, reverses, options)


def circling(time):
    """Where a chair is that drives on a circle, nowhere nearer to its target than at the start."""
    angle = 0.5 * time
    return np.array([0.3 * math.cos(angle) - 0.3, 0.3 * math.sin(angle), angle])


def test_a_chair_that_circles_makes_detours_to_both_sides_wider_and_wider():
    watched, aims = watching(), []
    for k in range(1200):
        watched.watch(0.05 * k, circling(0.05 * k), "")
        if not aims or watched.aim is not aims[-1]:
            aims.append(watched.aim)
    assert aims[0] is TARGET
    across, along = np.array(aims[1:]).T[::-1]
    np.testing.assert_allclose(np.abs(across), [1.0, 1.0, 2.0, 2.0], atol=0.05)
    assert (np.sign(across[1:]) == -np.sign(across[:-1])).all()
    np.testing.assert_allclose(along, 0.5 * np.abs(across), atol=0.1)  # beyond where it is barred
    assert not watched.outcome


def test_at_a_detours_point_it_aims_at_its_target_again():
    watched = watching()
    for k in range(405):
        watched.watch(0.05 * k, circling(0.05 * k), "")
    assert watched.aim is not TARGET
    watched.watch(20.25, np.array([watched.aim[0], watched.aim[1] + 0.5, 0.0]), "")
    assert watched.aim is TARGET


def test_who_comes_nearer_needs_no_detour():
    watched = watching()
    for k in range(1200):
        watched.watch(0.05 * k, np.array([0.07 * 0.05 * k, 0.0, 0.0]), "")
        assert watched.aim is TARGET
        assert not watched.is_backing
    assert watched.first - watched.best == pytest.approx(0.07 * 60.0, abs=0.1)


def test_a_chair_that_does_not_move_backs_off_in_both_turns_and_then_is_stuck():
    watched, sides, time = watching(), [], 0.0
    while not watched.outcome and time < 60.0:
        watched.watch(time, np.zeros(3), "a wall")
        if watched.is_backing:
            sides.append(watched.side)
        time += 0.05
    assert set(sides) == {1.0, -1.0}
    assert watched.outcome == "stuck 5.00 m from the target: a wall"
    assert not watched.arrived


def test_backing_off_ends_after_its_distance():
    watched = watching()
    for k in range(45):
        watched.watch(0.05 * k, np.zeros(3), "")
    assert watched.is_backing
    watched.watch(2.3, np.array([-0.5, 0.0, 0.0]), "")
    assert watched.is_backing
    watched.watch(2.4, np.array([-0.61, 0.0, 0.0]), "")
    assert not watched.is_backing


def test_without_reverse_it_is_stuck_at_once():
    watched = watching(reverses=False)
    for k in range(60):
        watched.watch(0.05 * k, np.zeros(3), "")
        assert not watched.is_backing
    assert watched.outcome.startswith("stuck 5.00 m from the target: obstacles all about")


def test_endurance_has_an_end():
    watched, time = watching(PersistenceOptions(endurance=50.0)), 0.0
    while not watched.outcome:
        watched.watch(time, circling(time), "")
        time += 0.05
    assert 50.0 < time < 60.0
    assert watched.outcome == "comes no nearer than 5.00 m to the target"


@pytest.mark.parametrize("wrong", [{"patience": 0.0}, {"endurance": math.inf}, {"detour": -1.0}])
def test_wrong_numbers_are_refused(wrong):
    with pytest.raises(ShapeError, match=next(iter(wrong))):
        PersistenceOptions(**wrong)
