"""Drives by what is perceived, as the page asks for them."""

import time

import numpy as np
import pytest

from narrows.commands.controllers import controller_names, make_controller
from narrows.errors import InputError
from narrows.interfaces import PlanStatus
from narrows.scene import Goal, Scene, load_scene, load_vehicle
from narrows.viewer.page_controllers import (
    ALONE,
    CONTROLLERS,
    ZONE,
    CommandControllers,
    chair_key,
    drive_controller,
    driver_names,
)
from narrows.viewer.page_driver import BY_HAND, PageDriver
from narrows.viewer.page_motion import driven_motion
from narrows.viewer.page_report import Report
from narrows.viewer.page_words import drive_words
from narrows.world import Solid, World


def open_floor():
    """Return a floor with a post beside the way, two metres to the goal."""
    post = Solid.circle(1.0, 1.4, 0.1, name="post")
    return Scene(load_vehicle("narrow-arcs"), World((post,)), [0, 0, 0], Goal([2.0, 0, 0]))


class Hand(Report):
    """A report that holds the stick, then stops."""

    def __init__(self, stick, seconds):
        """Hold the stick for some seconds."""
        super().__init__()
        self.stick, self.seconds, self.poses = stick, seconds, []

    def __call__(self, share):
        """Take down where the chair is."""
        if isinstance(share, dict):
            self.poses.append((share["time"], share["pose"]))

    def latest(self):
        """Return the stick, later that it stops."""
        return self.stick if self.poses[-1][0] < self.seconds else "stop"


@pytest.mark.slow
def test_the_navigator_drives_and_what_it_knew_is_kept():
    drive = drive_controller(Report(), open_floor(), None, ZONE, "", None)
    assert not drive.judgement.contacts
    assert drive.record.poses[-1, 0] == pytest.approx(2.0, abs=0.2)
    motion = driven_motion(drive)
    assert [curve.title for curve in motion.curves][-1] == "intrusion"
    assert set(motion.states) <= {"goal", "zone", "stopped", "backing"}
    seen = motion.moment(1.0)
    assert seen.rays.shape[1:] == (2, 3)
    # The post is where it is, seen from where the chair was.
    near = np.hypot(seen.points[:, 0] - 1.0, seen.points[:, 1] - 1.4)
    assert len(near)
    assert near.max() < 0.2


@pytest.mark.slow
def test_the_navigator_of_the_command_line_keeps_to_the_plan():
    commanded = CommandControllers(controller_names(), make_controller)
    scene = load_scene("examples/scenes/door.yaml")
    drive = drive_controller(Report(), scene, None, "navigator", "", None, commanded)
    assert drive.judgement.reached
    assert drive.record.has_reference
    assert drive.moments


@pytest.mark.slow
def test_somebody_alone_drives_the_way_of_the_plan():
    scene = load_scene("examples/scenes/l-corridor.yaml")
    drive = drive_controller(Report(), scene, None, ALONE, "steady", None)
    assert drive.plan.status is PlanStatus.CERTIFIED
    assert drive.record.length > 3.0
    assert drive_words(drive.judgement).headline in (
        "reached",
        "not reached",
        "driven with contact",
    )


@pytest.mark.slow
def test_the_stick_of_the_page_drives_in_real_time():
    hand = Hand((0.5, 0.0), 1.0)
    begun = time.monotonic()
    drive = drive_controller(hand, open_floor(), None, ALONE, BY_HAND, None)
    assert time.monotonic() - begun > 1.0
    assert 0.1 < drive.record.poses[-1, 0] < 1.0
    assert abs(drive.record.poses[-1, 1]) < 0.02
    np.testing.assert_array_equal(hand.poses[0][1], [0.0, 0.0, 0.0])


def test_a_stick_that_says_nonsense_is_at_rest_or_at_its_end():
    hand = Hand("what?", 9.0)
    driver = PageDriver(hand, open_floor())
    np.testing.assert_array_equal(driver.step(0.0, [0, 0, 0], [0, 0]), [0, 0])
    hand.stick = (7.0, -7.0)
    np.testing.assert_array_equal(driver.step(0.01, [0, 0, 0], [0, 0]), [1, -1])
    assert not driver.finished
    hand.stick = "stop"
    driver.step(0.02, [0.5, 0, 0], [0, 0])
    assert driver.finished
    assert driver.progress == pytest.approx(0.5)


def test_nobody_of_that_name_is_an_error():
    with pytest.raises(InputError, match="no such controller"):
        drive_controller(Report(), open_floor(), None, "autopilot", "", None)
    with pytest.raises(InputError, match="no such driver"):
        drive_controller(Report(), open_floor(), None, ALONE, "nobody", None)
    assert BY_HAND in driver_names()
    assert ZONE in CONTROLLERS


def test_safety_regions_are_another_chair_s_when_a_limit_differs():
    chair = load_vehicle("narrow-arcs")
    assert chair_key(chair) == chair_key(load_vehicle("narrow-arcs"))
    assert chair_key(chair) != chair_key(chair.with_limits(speed=0.5))
    assert chair_key(chair) != chair_key(load_vehicle("xeno"))
