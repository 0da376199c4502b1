"""Contacts are found on the swept body, counted as spells, against moving solids by time."""

import math

import numpy as np
import pytest

from narrows.simulation.contacts import certify_drive, contacts
from narrows.vehicle import Vehicle
from narrows.world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.6, 0.3)
NEEDLE = Vehicle.rectangle(0.02, 0.02, 0.01)


def along(x: np.ndarray, step: float = 0.01) -> tuple[np.ndarray, np.ndarray]:
    """Return times and poses of a drive on the x axis through positions."""
    poses = np.zeros((len(x), 3))
    poses[:, 0] = x
    return step * np.arange(len(x)), poses


def test_a_wall_thinner_than_a_step_is_not_jumped() -> None:
    wall = Solid.polygon([[1.049, -1], [1.051, -1], [1.051, 1], [1.049, 1]], name="sheet")
    times, poses = along(np.arange(0.0, 2.05, 0.1))  # rows at 1.0 and 1.1: both are clear
    assert not certify_drive(World((wall,)), NEEDLE, times, poses).is_clear
    found = contacts(World((wall,)), NEEDLE, times, poses)
    assert len(found) == 1
    assert found[0].start == pytest.approx(0.10)
    assert found[0].end == pytest.approx(0.11)
    assert "sheet" in found[0].reason


def test_a_clear_drive_has_no_contact_and_its_true_clearance() -> None:
    wall = Solid.polygon([[-1, 0.5], [4, 0.5], [4, 0.6], [-1, 0.6]], name="wall")
    times, poses = along(np.linspace(0.0, 2.0, 201))
    assert contacts(World((wall,)), CHAIR, times, poses) == ()
    assert certify_drive(World((wall,)), CHAIR, times, poses).clearance == pytest.approx(
        0.2, abs=1e-3
    )


def test_two_posts_apart_are_two_contacts_and_a_scrape_is_one() -> None:
    posts = tuple(Solid.circle(x, 0.32, 0.05, name=f"post {x}") for x in (2.0, 6.0))
    times, poses = along(np.linspace(0.0, 8.0, 801))  # 1 m/s
    found = contacts(World(posts), CHAIR, times, poses)
    assert len(found) == 2
    assert "post 2.0" in found[0].reason
    # the front corner meets a post, to 0.02 in y: |x - 2| <= sqrt(0.05^2 - 0.02^2) beside 0.3
    reach = math.sqrt(0.05**2 - 0.02**2)
    assert found[0].start == pytest.approx(2.0 - 0.7 - reach, abs=0.011)
    assert found[0].end == pytest.approx(2.0 + 0.3 + reach, abs=0.011)
    near = tuple(Solid.circle(x, 0.32, 0.05) for x in (2.0, 3.3, 4.6))  # less than 0.5 s apart
    assert len(contacts(World(near), CHAIR, times, poses)) == 1


def test_leaving_the_bounds_is_a_contact() -> None:
    times, poses = along(np.linspace(0.0, 2.0, 201))
    world = World(bounds=(-1.0, -1.0, 2.0, 1.0))
    found = contacts(world, CHAIR, times, poses)
    assert len(found) == 1
    assert found[0].start == pytest.approx(1.3 / 2.0 * 2.0, abs=0.02)  # front at 2.0, 1 m/s
    assert "bounds" in found[0].reason


def test_a_person_is_met_only_when_there() -> None:
    times, poses = along(np.linspace(0.0, 2.0, 201))  # front passes x = 1.5 at 0.8 s
    crossing = MovingSolid(0.2, np.array([[0.0, 1.5, 3.0], [2.0, 1.5, -3.0]]), name="person")
    late = MovingSolid(0.2, crossing.path + np.array([10.0, 0.0, 0.0]), name="person")
    found = contacts(World(moving=(crossing,)), CHAIR, times, poses)
    assert len(found) == 1
    assert "person" in found[0].reason
    assert contacts(World(moving=(late,)), CHAIR, times, poses) == ()


@pytest.mark.parametrize("side", [0.9, 0.4])
def test_a_chair_that_stands_can_be_walked_into(side: float) -> None:
    x = np.concatenate([np.linspace(0.0, 1.0, 101), np.full(300, 1.0), np.linspace(1.0, 1.5, 51)])
    times, poses = along(x)
    # walks past the standing chair between 2 s and 3 s
    person = MovingSolid(0.25, np.array([[2.0, 1.2, 5.0], [2.5, 1.2, side], [3.0, 1.2, 5.0]]))
    found = contacts(World(moving=(person,)), CHAIR, times, poses)
    if side - 0.25 < 0.3:
        assert len(found) == 1
        # centre comes within 0.55 m of the axis: at 2.5 -+ 0.5 (0.55 - 0.4) / 4.6
        assert found[0].start == pytest.approx(2.5 - 0.5 * 0.15 / 4.6, abs=0.011)
        assert found[0].end == pytest.approx(2.5 + 0.5 * 0.15 / 4.6, abs=0.011)
    else:
        assert found == ()


def test_a_chair_that_never_moves_is_judged_too() -> None:
    times, poses = along(np.zeros(50))
    wall = Solid.polygon([[0.6, -1], [0.8, -1], [0.8, 1], [0.6, 1]], name="wall")
    assert len(contacts(World((wall,)), CHAIR, times, poses)) == 1
    assert certify_drive(World((wall,)), CHAIR, times, poses).clearance == pytest.approx(-0.1)
    assert len(contacts(World((wall,)), CHAIR, times[:1], poses[:1])) == 1
    assert certify_drive(World(), CHAIR, times, poses).is_clear
    outside = World(bounds=(-0.2, -1.0, 2.0, 1.0))
    assert len(contacts(outside, CHAIR, times, poses)) == 1


def stop_and_go(stop: float, go: float, duration: float = 6.0) -> tuple[np.ndarray, np.ndarray]:
    """Return a drive at 0.5 m/s until `stop`, standing until `go`, driving on."""
    times = np.arange(0.0, duration, 0.01)
    x = 0.5 * (np.minimum(times, stop) + np.maximum(times - go, 0.0))
    return along(x)


PASSER = MovingSolid(0.25, np.array([[2.0, 1.0, 2.0], [3.0, 1.0, -2.0]]), name="passer")
"""Walks across what is 1 m ahead, touching a chair that stands there from 2.36 s to 2.64 s."""


@pytest.mark.parametrize(
    ("stop", "go", "walked_into"),
    [
        (1.6, 9.0, True),  # stands since 0.76 s and for ever
        (1.6, 2.7, True),  # and goes on when the passer is gone
        (1.6, 2.6, False),  # goes on into the passer
        (1.9, 9.0, False),  # has stood for 0.46 s only: it drove into the way
    ],
)
def test_somebody_who_walks_into_a_chair_that_stood_is_told_apart(stop, go, walked_into):
    found = contacts(World(moving=(PASSER,)), CHAIR, *stop_and_go(stop, go))
    assert len(found) == 1
    assert found[0].while_standing is walked_into


def test_a_standing_chair_that_touches_a_wall_too_has_a_contact_of_its_own():
    wall = Solid.polygon([[1.49, -1], [1.6, -1], [1.6, 1], [1.49, 1]], name="wall")  # front at 1.5
    times, poses = along(np.full(400, 0.8))
    found = contacts(World((wall,), moving=(PASSER,)), CHAIR, times, poses)
    assert [contact.while_standing for contact in found] == [False]


def test_somebody_at_a_chair_that_never_moved_walked_into_it():
    times, poses = along(np.full(400, 0.8))
    found = contacts(World(moving=(PASSER,)), CHAIR, times, poses)
    assert [contact.while_standing for contact in found] == [True]
    still = MovingSolid(0.25, np.array([[0.0, 1.0, 0.0]]))
    one = contacts(World(moving=(still,)), CHAIR, times[:1], poses[:1])
    assert [contact.while_standing for contact in one] == [True]


@pytest.mark.parametrize("speed", [0.0, 0.05])
def test_somebody_who_stays_at_the_chair_costs_no_look_at_every_row(speed, monkeypatch):
    """Rows at which the body overlaps need no proof; without that, halving says the same."""
    walk = [[0.0, 0.8, 3.0], [2.0, 0.8, 0.45], [4.0, 0.9, 0.45], [6.0, 0.8, 3.0]]
    world = World(moving=(MovingSolid(0.25, np.array(walk), name="she"),))
    times = np.arange(0.0, 6.0, 0.02)
    poses = np.zeros((len(times), 3))
    poses[:, 0] = speed * np.minimum(times, 4.0)
    asked = []

    def counted(*arguments):
        asked.append(arguments)
        return certify_drive(*arguments)

    monkeypatch.setattr("narrows.simulation.contacts.certify_drive", counted)
    found = contacts(world, CHAIR, times, poses)
    assert len(found) == 1
    assert found[0].start == pytest.approx(2.0 - 0.10 / 1.275, abs=0.021)  # 0.55 m from the axis
    assert len(asked) < 60  # a dozen for each end of the spell; one for each row would be 200
    monkeypatch.setattr(
        "narrows.simulation.contacts._meets_moving", lambda *_: np.zeros(len(times), dtype=bool)
    )
    assert contacts(world, CHAIR, times, poses) == found
    assert len(asked) > 200
