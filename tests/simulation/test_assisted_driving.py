"""A driver's chair with and without an assistant."""

import dataclasses
import math

import numpy as np
import pytest

from narrows.errors import InputError
from narrows.interfaces import Percept
from narrows.reactive.assistant import Assistant
from narrows.reactive.assistant_options import AssistantOptions
from narrows.reactive.door_ahead import DoorAhead
from narrows.reactive.safety_regions import RegionOptions, SafetyRegions
from narrows.reactive.smooth_motion import MotionLimits, SmoothMotion
from narrows.scene import Goal, Scene, load_vehicle
from narrows.se2 import compose
from narrows.simulation.assisted_driving import AssistedDriving, Odometer, Seat, UnknownIsFree
from narrows.simulation.assisted_driving_doors import CertifiedDoorPaths, DoorSense
from narrows.simulation.chair_senses import two_lasers
from narrows.simulation.driver_hostile import HostileDriver
from narrows.simulation.driver_sight import Sight
from narrows.simulation.driver_sticks import make_stick
from narrows.simulation.judge import judge
from narrows.simulation.localisation import EncoderOdometry
from narrows.simulation.plant import PlantOptions
from narrows.simulation.senses import IdealSenses
from narrows.simulation.simulator import SimulationOptions, simulate
from narrows.world import Solid, World

CHAIR = load_vehicle("xeno")
LIMITS = MotionLimits.of(CHAIR)
PERIOD = 0.05
HALL = World(
    (
        Solid.polygon([[-3, -2], [4, -2], [4, -1.9], [-3, -1.9]]),
        Solid.polygon([[-3, 1.9], [4, 1.9], [4, 2], [-3, 2]]),
        Solid.polygon([[4, -2], [4.1, -2], [4.1, 2], [4, 2]], name="end"),
        Solid.polygon([[-3.1, -2], [-3, -2], [-3, 2], [-3.1, 2]]),
        Solid.circle(1.5, 1.0, 0.3, name="pillar"),
    )
)
HERE = Scene(CHAIR, HALL, np.array([-1.5, 0.0, 0.0]), Goal(np.array([3.0, 0.0, 0.0])))


class Pusher:
    """Somebody who holds the stick where they are told, for some seconds."""

    def __init__(self, stick, seconds=math.inf):
        """Push a stick somewhere, until when."""
        self.at, self.seconds, self.seen = np.array(stick), seconds, []
        self.finished = False

    progress = 0.0

    def step(self, time, pose, motion):
        self.seen.append((time, *pose, *motion))
        self.finished = time > self.seconds
        return self.at


@pytest.fixture(scope="module")
def regions():
    """Coarse regions: larger cells and fewer directions, as safe and sooner computed."""
    options = RegionOptions(latency=0.1, directions=160, levels=20, cell=0.04)
    return SafetyRegions.compute(CHAIR, options)


def ride(driver, mover, *, senses=None, seconds=8.0, device="joystick", plant=None, seed=0):
    seat = Seat(senses)
    options = SimulationOptions(
        plant or PlantOptions(),
        EncoderOdometry(),
        step=0.025,
        period=PERIOD,
        time_limit=seconds,
    )
    controller = AssistedDriving(driver, make_stick(device, LIMITS), seat, mover)
    rng = np.random.default_rng(seed)
    return simulate(HERE, controller, senses=seat, options=options, rng=rng)


def test_without_assistance_the_chair_drives_into_the_wall():
    record = ride(Pusher([1.0, 0.0]), SmoothMotion(LIMITS, period=PERIOD))
    assert judge(HERE, record).collisions
    assert record.wheel_speeds.max() == pytest.approx(0.8, abs=0.01)


@pytest.mark.slow
def test_with_assistance_the_same_push_stops_before_the_wall(regions):
    mover = Assistant(CHAIR, regions, AssistantOptions(period=PERIOD))
    record = ride(Pusher([1.0, 0.0]), mover, senses=IdealSenses(HALL), seconds=14.0)
    verdict = judge(HERE, record)
    assert not verdict.collisions
    assert 0.0 < verdict.min_clearance < 0.2  # near the wall, not far from it
    assert np.abs(record.wheel_speeds[-1]).max() < 0.005


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_a_hostile_driver_hits_nothing(regions, seed):
    mover = Assistant(CHAIR, regions, AssistantOptions(period=PERIOD))
    senses = UnknownIsFree(two_lasers(HERE, rng=np.random.default_rng(seed)))
    driver = HostileDriver(Sight(HALL), np.random.default_rng(seed))
    record = ride(
        driver, mover, senses=senses, seconds=25.0, plant=PlantOptions(slip=0.01), seed=seed
    )
    assert record.length > 0.3  # it did move
    assert not judge(HERE, record).collisions


def test_the_driver_is_told_the_truth_and_not_what_odometry_believes():
    driver = Pusher([1.0, 0.3])
    plant = PlantOptions(left_radius_error=-0.05)
    record = ride(driver, SmoothMotion(LIMITS, period=PERIOD), seconds=4.0, plant=plant)
    seen = np.array(driver.seen)
    rows = np.searchsorted(record.times, seen[:, 0] - 1e-9)
    assert seen[:, 1:4] == pytest.approx(record.poses[rows], abs=1e-12)
    assert np.abs(record.estimates[-1] - record.poses[-1]).max() > 0.02
    # Felt a period late: the speed there and the one a period before differ by 0.03 m/s at most.
    forward = record.wheel_speeds[rows].mean(axis=1)
    assert seen[5:, 4] == pytest.approx(forward[5:], abs=0.05)


def test_a_finished_driver_commands_a_stop():
    record = ride(Pusher([1.0, 0.0], seconds=1.0), SmoothMotion(LIMITS, period=PERIOD))
    assert record.duration < 5.0
    assert np.abs(record.wheel_speeds[-1]).max() < 0.005


def test_motion_is_the_arc_between_poses():
    odometer, twist = Odometer(2), np.array([0.6, -0.9])
    pose = np.array([1.0, 2.0, 3.0])
    for k in range(5):
        found = odometer.motion(0.05 * k, pose)
        half = 0.5 * twist[1] * 0.05
        chord = twist[0] * 0.05 * math.sin(half) / half
        pose = compose(pose, [chord * math.cos(half), chord * math.sin(half), 2.0 * half])
    assert found == pytest.approx(twist, abs=1e-9)
    assert (Odometer(1).motion(0.0, pose) == 0.0).all()


def test_both_sticks_give_the_command_a_trained_driver_reaches_for():
    for device in ("joystick", "head-joystick"):
        stick = make_stick(device, LIMITS)
        for v, omega in ((0.4, 0.3), (0.0, -0.8), (-0.2, 0.1)):
            assert stick.command(stick.reach(v, omega)) == pytest.approx([v, omega], abs=1e-9)
    assert (make_stick("head-joystick", LIMITS).command([0.2, -0.2]) == 0.0).all()  # dead zone
    with pytest.raises(InputError, match="no such input device"):
        make_stick("voice", LIMITS)


def test_unknown_places_are_taken_for_free_and_nothing_else_is_changed():
    class Told:
        def perceive(self, time, true_pose, believed_pose):
            return Percept(time, np.ones((2, 3)), 0.01, np.ones((3, 2)))

    percept = UnknownIsFree(Told()).perceive(1.5, np.zeros(3), np.zeros(3))
    assert (percept.time, percept.spread, len(percept.points), len(percept.unknown)) == (
        1.5,
        0.01,
        2,
        0,
    )


def test_a_certified_path_leads_through_the_door_it_is_asked_for():
    paths = CertifiedDoorPaths(CHAIR)
    door = DoorAhead(2.0, 0.3, 0.15, 0.8)
    path = paths(door)
    assert path is not None
    assert path[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)
    end = compose(door.pose, [0.75, 0.0, 0.0])
    assert np.hypot(*(path[-1] - end)[:2]) < 0.06  # the goal's tolerance
    assert np.hypot(*np.diff(path[:, :2], axis=0).T).max() < 0.1
    assert (paths.asked, paths.found) == (1, 1)


def test_a_door_too_narrow_has_no_path():
    assert CertifiedDoorPaths(CHAIR)(DoorAhead(2.0, 0.0, 0.0, 0.6)) is None


def test_the_door_ahead_is_sensed_where_it_is():
    walls = (
        Solid.polygon([[0, 0.4], [0.1, 0.4], [0.1, 2], [0, 2]]),
        Solid.polygon([[0, -2], [0.1, -2], [0.1, -0.4], [0, -0.4]]),
    )
    start = np.array([-2.0, 0.2, -0.1])
    scene = Scene(CHAIR, World(walls), start, Goal(np.array([1.5, 0.0, 0.0])))
    senses = two_lasers(scene)
    doors, found = DoorSense(senses), None
    for k in range(12):
        pose = start + np.array([0.02 * k, 0.0, 0.0])
        senses.perceive(0.05 * k, pose, pose)
        found = doors.ahead(0.05 * k, pose) or found
    assert found is not None
    seen = compose(pose, dataclasses.astuple(found)[:3])
    # Carried from the scan to the step it was told at; beams 0.5 degrees apart see edges to 3 cm.
    assert seen == pytest.approx([0.0, 0.0, 0.0], abs=0.08)
    assert found.width == pytest.approx(0.8, abs=0.06)
