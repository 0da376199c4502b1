"""A chair's senses answer by schedule, late and with faults; what they tell is there."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
import shapely

from narrows.errors import InputError, ShapeError
from narrows.interfaces import Percept
from narrows.perception.camera import Mounting
from narrows.perception.map_options import MapOptions
from narrows.perception.obstacles import ObstacleFinder
from narrows.perception.ranges import ScannerMounting
from narrows.perception.surroundings import Sight
from narrows.scene import Goal, Scene
from narrows.se2 import transform
from narrows.simulation.chair_senses import ChairSenses, two_lasers
from narrows.simulation.depth_sensor import DepthSensor, kinect
from narrows.simulation.fitted_sensors import (
    Faults,
    FittedCamera,
    FittedLaser,
    FittedUltrasound,
    Schedule,
)
from narrows.simulation.judge import judge
from narrows.simulation.laser import LaserManners, LaserScanner
from narrows.simulation.simulator import SimulationOptions, simulate
from narrows.simulation.ultrasound import sensor_ring
from narrows.vehicle import Vehicle
from narrows.world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.6, 0.3)
HERE = np.zeros(3)
WALL = Solid.polygon([[2, -1.5], [2.2, -1.5], [2.2, 1.5], [2, 1.5]], name="wall")
PROMPT = Schedule(rate=10.0, latency=0.0)
CLEAN = LaserManners(noise=0.0, dropouts=0.0)
LASER = LaserScanner(ScannerMounting(x=0.7), CLEAN, "front")


def scene(*solids: Solid, moving: tuple[MovingSolid, ...] = ()) -> Scene:
    return Scene(CHAIR, World(solids, moving=moving), HERE, Goal(np.array([9.0, 0, 0])))


def laser(faults: Faults | None = None, **schedule: float) -> FittedLaser:
    plan = replace(PROMPT, faults=faults or Faults(), **schedule)
    return FittedLaser(LASER, plan)


def camera(mounting: Mounting, believed: Mounting | None = None, **schedule) -> FittedCamera:
    finder = ObstacleFinder(kinect(believed or mounting, width=320, height=240))
    plan = replace(PROMPT, **schedule)
    return FittedCamera(DepthSensor(kinect(mounting, width=320, height=240)), finder, plan)


def live(senses: ChairSenses, until: float, pose=HERE, believed=None) -> list[Percept]:
    """Return the percepts of all control steps of a chair that stands."""
    here = np.asarray(pose, dtype=float)
    belief = here if believed is None else np.asarray(believed, dtype=float)
    steps = round(until / 0.02)
    return [senses.perceive(0.02 * k, here, belief) for k in range(steps + 1)]


def test_what_is_told_is_there_and_what_is_there_is_told():
    """Each point is a cell or less from an outline, each outline in view has a point near."""
    post, box = Solid.circle(1.8, 1.0, 0.2), Solid.polygon([[-1, 1], [0, 1], [0, 2], [-1, 2]])
    place = scene(WALL, post, box)
    percept = live(two_lasers(place, rng=np.random.default_rng(1)), 1.0)[-1]
    outlines = shapely.union_all(
        [WALL.shape.exterior, box.shape.exterior, shapely.Point(1.8, 1.0).buffer(0.2, 64).exterior]
    )
    told = shapely.points(percept.points[:, :2])
    # 1 cm of noise, 4 deviations, and half a cell's diagonal
    assert shapely.distance(outlines, told).max() < 0.04 + percept.spread
    cloud = shapely.MultiPoint(list(told))
    for front in ([2.0, 0.0], [2.0, -1.0], [1.626, 0.903], [-0.5, 1.0]):
        assert shapely.Point(front).distance(cloud) < 0.06
    assert ((percept.points[:, 2] > 0.0) & (percept.points[:, 2] < 0.2)).all()  # 0.12 m's band


def test_nothing_is_known_until_an_answer_has_arrived_and_then_of_its_time():
    senses = ChairSenses(scene(WALL), [laser(rate=10.0, latency=0.05)])
    percepts = live(senses, 0.3)
    times = np.array([percept.time for percept in percepts])
    assert (times[:3] == -math.inf).all()  # 0, 0.02, 0.04 s
    assert all(len(percept.points) == 0 for percept in percepts[:3])
    np.testing.assert_allclose(times[3:8], 0.0)  # measured at 0, here from 0.06 s
    np.testing.assert_allclose(times[8:13], 0.1)  # 0.16 s to 0.24 s
    assert len(percepts[3].points) > 50


@dataclass(eq=False)
class Clock:
    """A sensor that answers the time and keeps what was entered."""

    schedule: Schedule
    name: str = "clock"
    measured: list[float] = field(default_factory=list)
    entered: list[tuple[float, tuple[float, ...]]] = field(default_factory=list)

    def measure(self, world, pose, time, rng):
        self.measured.append(round(time, 6))
        return time

    def spoilt(self, answer):
        return math.nan

    def enter(self, answer, known):
        self.entered.append((round(answer, 6), tuple(known.pose)))


def clocked(until: float, faults: Faults | None = None, **schedule) -> Clock:
    clock = Clock(Schedule(**schedule, faults=faults or Faults()))
    live(ChairSenses(scene(), [clock]), until)
    return clock


def test_sensors_measure_at_their_rate():
    assert clocked(1.0, rate=12.5).measured == [round(0.08 * k, 6) for k in range(13)]
    thirty = clocked(2.0, rate=30.0).measured
    assert len(thirty) == 61
    assert max(np.diff(thirty)) == pytest.approx(0.04)  # to the grid of control steps
    assert clocked(0.5, rate=10.0, phase=0.05).measured[:2] == [0.06, 0.16]
    assert len(clocked(1.0, rate=1000.0).measured) == 51  # once a control step


def test_faults_silence_spoil_lose_and_delay():
    silent = clocked(1.0, Faults(silent=((0.25, 0.55), (0.85, math.inf))), rate=10.0)
    assert silent.measured == [0.0, 0.1, 0.2, 0.6, 0.7, 0.8]
    spoilt = clocked(0.5, Faults(invalid=((0.15, 0.25),)), rate=10.0, latency=0.0)
    np.testing.assert_equal([t for t, _ in spoilt.entered], [0.0, 0.1, math.nan, 0.3, 0.4, 0.5])
    lossy = clocked(40.0, Faults(lost=0.3), rate=25.0, latency=0.0)
    assert len(lossy.entered) == pytest.approx(700, abs=60)  # of 1,001: 4 deviations
    late = clocked(1.0, Faults(late=((0.15, 0.25, 0.25),)), rate=10.0, latency=0.0)
    assert [t for t, _ in late.entered] == [0.0, 0.1, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    jittery = clocked(2.0, Faults(jitter=0.3), rate=10.0, latency=0.0)
    entered = [t for t, _ in jittery.entered]
    assert entered == sorted(entered)  # overtaken ones are left out
    assert len(entered) < len(jittery.measured)


def test_answers_are_entered_where_the_chair_believed_to_be_when_they_were_measured():
    clock = Clock(Schedule(rate=10.0, latency=0.06))
    senses = ChairSenses(scene(), [clock])
    for k in range(40):
        senses.perceive(0.02 * k, np.array([9.0, 9.0, 1.0]), np.array([0.01 * k, 0.0, 0.0]))
    for time, pose in clock.entered:
        assert pose == pytest.approx((0.5 * time, 0.0, 0.0))
    assert senses.map.pose.tolist() == pytest.approx([0.39, 0.0, 0.0])


@pytest.mark.parametrize("faults", [Faults(silent=((0.5, 9.0),)), Faults(invalid=((0.5, 9.0),))])
def test_silence_and_scans_of_nothing_age_and_free_nothing(faults):
    senses = ChairSenses(scene(WALL), [laser(faults)])
    before = live(senses, 0.4)[-1]
    assert before.time == 0.4
    for k in range(21, 60):
        percept = senses.perceive(0.02 * k, HERE, HERE)
    assert percept.time == pytest.approx(0.4)
    np.testing.assert_array_equal(percept.points, before.points)
    np.testing.assert_array_equal(percept.unknown, before.unknown)


def test_the_most_silent_sensor_gives_the_time():
    rear = FittedLaser(
        replace(LASER, name="rear"), replace(PROMPT, faults=Faults(silent=((0.15, math.inf),)))
    )
    senses = ChairSenses(scene(WALL), [laser(), rear])
    assert live(senses, 1.0)[-1].time == pytest.approx(0.1)
    assert senses.heard == pytest.approx({"front": 1.0, "rear": 0.1})
    assert set(senses.answers) == {"front", "rear"}


def test_a_believed_pose_that_is_off_does_not_move_what_is_seen():
    offset = np.array([0.4, -0.3, 0.5])
    true = live(ChairSenses(scene(WALL), [laser()]), 0.2)[-1].points
    off = live(ChairSenses(scene(WALL), [laser()]), 0.2, believed=offset)[-1].points
    cloud = shapely.MultiPoint(true[:, :2])
    assert shapely.distance(shapely.points(off[:, :2]), cloud).max() < 0.06  # cells turned


def test_what_is_out_of_view_is_remembered_where_odometry_says():
    """The post is seen, the chair turns right round; slip of the heading turns the memory."""
    post = Solid.circle(1.5, 0.0, 0.1)
    ahead = FittedLaser(
        LaserScanner(ScannerMounting(x=0.7), replace(CLEAN, field=1.0, beams=201), "front"), PROMPT
    )
    for drift in (0.0, 0.2):
        senses = ChairSenses(scene(post), [ahead], options=MapOptions(cell=0.02))
        live(senses, 0.3)
        for k in range(16, 120):
            heading = min(0.05 * (k - 15), math.pi)
            true = np.array([0.0, 0.0, heading])
            percept = senses.perceive(0.02 * k, true, true * (1.0 + drift / math.pi))
        place = transform([0.0, 0.0, -math.pi - drift], np.array([[1.4, 0.0]]))[0]
        gap = np.hypot(*(percept.points[:, :2] - place).T)
        assert gap.min() < 0.03
        assert np.hypot(*percept.points[:, :2].T).min() == pytest.approx(1.4, abs=0.03)


def test_somebody_who_leaves_is_forgotten_where_he_was_and_known_where_he_is():
    walker = MovingSolid(0.2, np.array([[1.0, 1.5, 0.0], [2.0, 1.5, 1.0]]))
    senses = ChairSenses(scene(WALL, moving=(walker,)), [laser()])
    percepts = live(senses, 4.0)

    def near(percept: Percept, x: float, y: float) -> bool:
        return bool((np.hypot(*(percept.points[:, :2] - [x, y]).T) < 0.1).any())

    assert near(percepts[50], 1.3, 0.0)
    assert near(percepts[-1], 1.35, 0.9)
    assert not near(percepts[-1], 1.3, 0.0)


def test_a_depth_camera_tells_heights():
    """A table: its top in its own band, free below; its legs reach the floor."""
    top = Solid.polygon([[1.3, -0.4], [1.9, -0.4], [1.9, 0.4], [1.3, 0.4]], z=(0.70, 0.74))
    leg = Solid.circle(1.4, 0.3, 0.05, z=(0.0, 0.70))
    mounted = camera(Mounting(1.2, math.radians(32), x=0.3))
    senses = ChairSenses(scene(top, leg), [mounted], rng=np.random.default_rng(0))
    percept = live(senses, 0.5)[-1]
    at_edge = np.hypot(*(percept.points[:, :2] - [1.3, 0.0]).T) < 0.08
    assert at_edge.any()
    np.testing.assert_allclose(percept.points[at_edge, 2], 0.75)  # the band 0.7 to 0.8
    at_leg = np.hypot(*(percept.points[:, :2] - [1.35, 0.3]).T) < 0.08
    assert percept.points[at_leg, 2].min() < 0.4
    assert senses.answers["camera"].seen.sight is Sight.SEEN


def test_a_camera_knocked_over_and_one_before_a_wall_are_silent_or_say_so():
    blind = camera(Mounting(0.8, math.radians(30), x=1.9))  # 10 cm before the wall
    senses = ChairSenses(scene(WALL), [blind])
    assert live(senses, 0.4)[-1].time == -math.inf
    knocked = camera(Mounting(0.8, math.radians(45)), Mounting(0.8, math.radians(30)))
    senses = ChairSenses(scene(WALL), [knocked])
    percept = live(senses, 0.4)[-1]
    assert senses.answers["camera"].seen.sight is Sight.FLOOR_ASSUMED
    assert percept.time == pytest.approx(0.4)
    assert not senses.map.is_free(np.array([[1.2, 0.0]])).any()


def test_glass_is_seen_by_ultrasound_only():
    glass = Solid.polygon([[1.5, -1], [1.6, -1], [1.6, 1], [1.5, 1]], name="glass")
    ring = FittedUltrasound(sensor_ring(CHAIR), schedule=PROMPT)
    seen = {}
    for sensor in (laser(), ring):
        senses = ChairSenses(scene(WALL, glass), [sensor], invisible=["glass"])
        rows = live(senses, 0.5)[-1].points
        seen[sensor.name] = float(rows[np.abs(rows[:, 1]) < 0.1, 0].min())
    assert seen["front"] == pytest.approx(2.0, abs=0.05)
    assert seen["ultrasound"] == pytest.approx(1.5, abs=0.05)


def test_the_same_seed_gives_the_same_percepts_and_faults_of_one_leave_the_other_alone():
    def percepts(seed: int, lost: float) -> tuple[np.ndarray, np.ndarray]:
        rear = FittedLaser(replace(LASER, name="rear"), replace(PROMPT, faults=Faults(lost=lost)))
        front = FittedLaser(replace(LASER, manners=LaserManners()), PROMPT)
        senses = ChairSenses(scene(WALL), [front, rear], rng=np.random.default_rng(seed))
        last = live(senses, 1.0)[-1]
        return last.points, senses.answers["front"].ranges

    one, again, other = percepts(1, 0.5), percepts(1, 0.5), percepts(2, 0.5)
    np.testing.assert_array_equal(one[0], again[0])
    np.testing.assert_array_equal(one[1], again[1])
    assert not np.array_equal(one[1], other[1], equal_nan=True)
    np.testing.assert_array_equal(percepts(1, 0.0)[1], one[1])


class Halting:
    """Drives straight on until something is near ahead, or senses are silent for too long."""

    def __init__(self) -> None:
        """Begin."""
        self.progress, self.finished = 0.0, False
        self.signals: dict[str, float] = {}

    def step(self, time, pose, percept):
        rows = percept.points[np.abs(percept.points[:, 1]) < 0.4, 0]
        gap = float(rows[rows > 0.7].min(initial=9.0)) - percept.spread - 0.7
        self.signals = {"age": time - percept.time}
        stop = gap < 0.3 or self.signals["age"] > 0.3
        return np.array([0.0 if stop else 0.4, 0.0])


@pytest.mark.parametrize(
    ("faults", "x"), [(Faults(), 1.0), (Faults(silent=((1.0, math.inf),)), 0.5)]
)
def test_a_drive_by_lasers_ends_before_the_wall_and_blind_it_ends_at_once(faults, x):
    place = scene(WALL)
    senses = two_lasers(place, schedule=Schedule(faults=faults), rng=np.random.default_rng(3))
    options = SimulationOptions(time_limit=5.0)
    record = simulate(place, Halting(), senses=senses, options=options)
    assert judge(place, record).contacts == ()
    assert record.poses[-1, 0] == pytest.approx(x, abs=0.12)
    assert np.abs(record.wheel_speeds[-1]).max() < 0.005


def test_odd_senses_have_their_answers():
    """An empty world is free, from inside a solid nothing is known, odd input is refused."""
    empty = ChairSenses(scene(), [laser()])
    assert len(live(empty, 0.2)[-1].points) == 0
    assert empty.map.is_free(np.array([[2.0, 0.0]])).all()
    inside = ChairSenses(scene(Solid.circle(0.7, 0.0, 0.2)), [laser()])
    assert live(inside, 0.2)[-1].time == -math.inf
    for pose, belief in (([math.nan, 0, 0], HERE), (HERE, [0, 0, math.inf])):
        with pytest.raises(ShapeError, match="three finite numbers"):
            empty.perceive(1.0, np.array(pose), np.array(belief))
    with pytest.raises(ShapeError, match="finite number"):
        empty.perceive(math.nan, HERE, HERE)
    for sensors in ([], [laser(), laser()]):
        with pytest.raises(InputError, match="different names"):
            ChairSenses(scene(), sensors)
    with pytest.raises(InputError, match="no reach"):
        ChairSenses(scene(), [laser()], reach=math.nan)


@pytest.mark.parametrize(
    "wrong",
    [
        {"silent": ((2.0, 1.0),)},
        {"late": ((0.0, 1.0, -0.1),)},
        {"lost": 1.5},
        {"jitter": math.nan},
        {"invalid": ((math.nan, 1.0),)},
    ],
)
def test_faults_that_are_none_are_refused(wrong):
    with pytest.raises(InputError):
        Faults(**wrong)
    for schedule in ({"rate": 0.0}, {"latency": -1.0}, {"phase": math.inf}):
        with pytest.raises(InputError):
            Schedule(**schedule)
