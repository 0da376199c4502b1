"""The look-ahead tracker: the paper's figures with the paper's law, millimetres with ours."""

import math

import numpy as np
import pytest

from narrows.bezier_section import BezierSection
from narrows.errors import ShapeError
from narrows.path import Path
from narrows.planners.timing import time_path
from narrows.se2 import compose, exponential, wrap
from narrows.tracking.lookahead import LookaheadGains, LookaheadOptions, LookaheadTracker
from narrows.trajectory import Trajectory
from narrows.vehicle import Limits, Vehicle

CHAIR = Vehicle.rectangle(1.1, 0.75, 0.3)
AGILE = Vehicle.rectangle(1.1, 0.75, 0.3, limits=Limits(yaw_rate=3.0))  # no limit is reached
EXACT = LookaheadOptions(delay=0.0)  # for a chair that answers at once

# [DoorBezier, Table I] scenario A with the optimal legs a = |P0P1|, b = |P2P3| of the corrections
START, DOOR, TARGET = (0.1, 1.3), (1.6, 1.8), (0.0, 3.5)
TABLE = {
    "A1": (START, -20, DOOR, 90, 1.058, 0.432),
    "A2": (START, -40, DOOR, 90, 0.856, 0.647),
    "A3": (DOOR, 90, TARGET, 160, 0.698, 1.096),
    "A4": (DOOR, 90, TARGET, 200, 1.358, 0.745),
}


def curve(name: str) -> Path:
    first, heading, last, end_heading, a, b = TABLE[name]
    p, q = np.array(first), np.array(last)
    along = [
        np.array([math.cos(math.radians(h)), math.sin(math.radians(h))])
        for h in (heading, end_heading)
    ]
    return Path((BezierSection([[p, p + a * along[0], q - b * along[1], q]]),))


class Run:
    """A drive of a chair that obeys at once, from a pose, with what the tracker said."""

    def __init__(self, tracker: LookaheadTracker, pose: np.ndarray, period: float = 0.02) -> None:
        """Drive until the tracker has finished."""
        poses, commands, ahead, across, progress = [np.array(pose)], [], [], [], []
        while not tracker.finished and len(commands) < 5000:
            commands.append(tracker.step(period * len(commands), poses[-1]))
            ahead.append(tracker.lookahead_error)
            across.append(tracker.cross_track_error)
            progress.append(tracker.progress)
            v, omega = commands[-1]
            poses.append(compose(poses[-1], exponential(period * np.array([v, 0.0, omega]))))
        self.finished = tracker.finished
        self.poses, self.commands = np.array(poses), np.array(commands)
        self.ahead, self.across = np.array(ahead), np.array(across)
        self.progress = np.array(progress)


def paper_run(name: str, lookahead: float, **changes: float) -> Run:
    options = LookaheadOptions.paper(lookahead=lookahead, **changes)
    path = curve(name)
    return Run(LookaheadTracker(path, AGILE, options), path.start)


@pytest.mark.parametrize(
    ("name", "least", "most"), [("A1", 56, 58), ("A2", 40, 42), ("A3", 29, 36), ("A4", 28, 30)]
)
@pytest.mark.parametrize("lookahead", [0.25, 0.28, 0.30])
def test_the_papers_law_gives_the_papers_55_millimetres(
    name: str, least: float, most: float, lookahead: float
) -> None:
    run = paper_run(name, lookahead)
    assert run.finished
    assert least <= 1e3 * np.abs(run.ahead).max() <= most  # corrections: 57/41/30-35/29 mm
    assert 1e3 * np.abs(run.across).max() <= 20.0  # C_err: 3-20 mm
    assert np.abs(run.commands[:, 1]).max() <= 0.71


def test_the_damped_lookahead_halves_the_error_of_half_a_metre() -> None:
    best = math.sqrt(2 * 0.4 / 10.0)  # 0.28 m
    far = max(np.abs(paper_run(name, 0.5).ahead).max() for name in TABLE)
    near = max(np.abs(paper_run(name, best).ahead).max() for name in TABLE)
    assert far == pytest.approx(0.103, abs=0.002)
    assert near <= 0.56 * far


def test_no_lookahead_brings_the_paper_below_its_55_millimetres() -> None:
    # A1 bends with 1.8 1/m: the law needs D = V kappa / kp to turn at all, near 56 mm here.
    least = min(np.abs(paper_run("A1", x).ahead).max() for x in (0.1, 0.15, 0.2, 0.25, 0.3))
    assert least == pytest.approx(0.056, abs=0.001)


def test_a_lookahead_of_a_fifth_of_a_metre_halves_the_cross_track_error() -> None:
    worst = {x: max(np.abs(paper_run(n, x).across).max() for n in TABLE) for x in (0.2, 0.26)}
    assert worst[0.2] <= 0.5 * 0.055
    assert worst[0.26] <= 0.007


def test_on_a_circle_the_paper_settles_at_the_error_that_turns_it() -> None:
    radius = 2.0
    arc = Path.from_poses([[0, 0, 0], [0, 2 * radius, math.pi]])
    options = LookaheadOptions.paper()
    options = LookaheadOptions(**{**options.__dict__, "gains": LookaheadGains(10.0, 0.0, 0.0)})
    run = Run(LookaheadTracker(arc, AGILE, options), arc.start)
    # omega = kp D = V / R_chair, and R_chair = R + C_err to a per mille
    assert run.ahead[-50] == pytest.approx(0.4 / (10.0 * radius), rel=5e-3)


@pytest.mark.parametrize("name", TABLE)
@pytest.mark.parametrize("timed", [False, True])
def test_feed_forward_keeps_an_ideal_chair_on_the_path(name: str, timed: bool) -> None:
    path = curve(name)
    motion = time_path(path, CHAIR) if timed else path
    run = Run(LookaheadTracker(motion, CHAIR, EXACT), path.start)
    assert run.finished
    assert np.abs(run.across).max() < 1e-4  # what two-millimetre tables and 20 ms steps leave
    assert np.hypot(*(run.poses[-1] - path.goal)[:2]) < 2e-3


def shunting() -> Path:
    """Return forward, turn on the spot, in reverse on an arc, and forward again."""
    poses = [[0, 0, 0], [1.5, 0, 0], [1.5, 0, 1.0]]
    poses.append(compose(poses[-1], [-0.8, -0.3, 2 * math.atan2(0.3, 0.8)]).tolist())
    poses.append(compose(poses[-1], [1.0, 0.0, 0.0]).tolist())
    return Path.from_poses(poses)


@pytest.mark.parametrize("timed", [False, True])
def test_reversing_and_turning_on_the_spot_are_followed_to_the_end(timed: bool) -> None:
    path = shunting()
    assert path.directions.tolist() == [1, 0, -1, 1]
    motion = time_path(path, CHAIR) if timed else path
    run = Run(LookaheadTracker(motion, CHAIR, EXACT), path.start)
    assert run.finished
    assert np.abs(run.across).max() < 2e-3  # a stop 1 mm early shifts the next leg by as much
    np.testing.assert_allclose(run.poses[-1], path.goal, atol=5e-3)
    assert (np.diff(run.progress) >= 0.0).all()
    signs = np.sign(run.commands[np.abs(run.commands[:, 0]) > 1e-6, 0])
    assert signs[np.flatnonzero(np.diff(signs, prepend=0.0))].tolist() == [1.0, -1.0, 1.0]


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("options", [EXACT, LookaheadOptions.paper()])
def test_it_converges_from_an_offset(direction: float, options: LookaheadOptions) -> None:
    path = Path.from_poses(
        [[0, 0, 0.3], [5 * direction * math.cos(0.3), 5 * direction * math.sin(0.3), 0.3]]
    )
    aside = compose(path.start, [0.0, 0.2, -0.3])
    run = Run(LookaheadTracker(path, AGILE, options), aside)
    assert run.finished
    assert np.abs(run.across[0]) == pytest.approx(0.2, abs=1e-9)
    assert np.abs(run.across[-1]) < 2e-3
    assert abs(wrap(run.poses[-1, 2] - 0.3)) < 0.02


def test_the_mirror_image_is_driven_mirrored() -> None:
    path = curve("A2")
    flip = np.array([1.0, -1.0])
    mirrored = Path((BezierSection(path.sections[0].control * flip),))
    for options in (EXACT, LookaheadOptions.paper()):
        one = Run(LookaheadTracker(path, CHAIR, options), path.start + np.array([0, 0.05, 0.1]))
        other = Run(
            LookaheadTracker(mirrored, CHAIR, options), mirrored.start + np.array([0, -0.05, -0.1])
        )
        np.testing.assert_allclose(other.commands, one.commands * flip, atol=1e-9)
        np.testing.assert_allclose(other.across, -one.across, atol=1e-9)


def test_errors_are_positive_where_the_path_lies_to_the_left() -> None:
    path = Path.from_poses([[0, 0, 0], [3, 0, 0]])
    tracker = LookaheadTracker(path, CHAIR, EXACT)
    for k in range(10):  # 0.03 m to the right of the path, pointing 0.1 rad right
        command = tracker.step(0.02 * k, [0.01 * k, -0.03, -0.1])
    assert tracker.cross_track_error == pytest.approx(0.03)
    assert tracker.lookahead_error == pytest.approx(0.03 + 0.30 * math.sin(0.1))
    assert tracker.heading_error == pytest.approx(0.1)
    assert command[1] > 0.0


def test_commands_keep_the_chairs_limits() -> None:
    slow = CHAIR.with_limits(speed=0.3, reverse_speed=0.1, yaw_rate=0.4)
    path = shunting()
    run = Run(LookaheadTracker(path, slow, EXACT), path.start + np.array([0.0, 0.1, 0.2]))
    assert run.finished
    assert run.commands[:, 0].max() <= 0.3 + 1e-12
    assert run.commands[:, 0].min() >= -0.1 - 1e-12
    assert np.abs(run.commands[:, 1]).max() <= 0.4 + 1e-12


def test_the_integral_never_asks_for_more_than_its_limit() -> None:
    path = Path.from_poses([[0, 0, 0], [60, 0, 0]])
    gains = LookaheadGains(0.0, 5.0, 0.0)
    options = LookaheadOptions(gains=gains, integral_limit=0.2, by_distance=False)
    tracker = LookaheadTracker(path, CHAIR, options)
    rates = [tracker.step(0.02 * k, [0.005 * k, -0.3, 0.0])[1] for k in range(300)]
    assert max(rates) == pytest.approx(0.2)
    back = [tracker.step(6.0 + 0.02 * k, [1.5, 0.3, 0.0])[1] for k in range(20)]
    assert back[-1] < 0.2  # it leaves the limit at once, it does not have to unwind


def test_the_integral_rests_while_the_yaw_rate_is_limited() -> None:
    path = Path.from_poses([[0, 0, 0], [60, 0, 0]])
    options = LookaheadOptions(
        gains=LookaheadGains(10.0, 1.0, 0.0),
        integral_limit=3.0,
        by_distance=False,
    )
    tracker = LookaheadTracker(path, CHAIR, options)
    for k in range(200):  # 10 x 0.2 m asks for 2 rad/s, the chair may turn by 1.2
        assert tracker.step(0.02 * k, [0.005 * k, -0.2, 0.0])[1] == pytest.approx(1.2)
    # back on the path nothing is left of four seconds of error
    assert tracker.step(4.02, [1.0, 0.0, 0.0])[1] == pytest.approx(0.0, abs=1e-9)


def test_a_chair_that_passed_the_end_has_finished() -> None:
    path = Path.from_poses([[0, 0, 0], [1, 0, 0]])
    tracker = LookaheadTracker(path, CHAIR, EXACT)
    for k in range(12):
        tracker.step(0.02 * k, [0.1 * k, 0.0, 0.0])
    assert tracker.finished
    assert tracker.progress == 1.0
    assert (tracker.step(1.0, [1.2, 0.0, 0.0]) == 0.0).all()


def test_a_trajectory_is_driven_on_time() -> None:
    path = curve("A4")
    trajectory = time_path(path, CHAIR)
    run = Run(LookaheadTracker(trajectory, CHAIR, EXACT), path.start)
    times = 0.02 * np.arange(len(run.poses))
    late = np.linalg.norm(run.poses[:, :2] - trajectory(times)[:, :2], axis=1)
    assert late.max() < 2e-3
    assert times[-1] == pytest.approx(trajectory.duration, abs=0.1)


def test_a_sampled_trajectory_is_driven_like_the_one_it_came_from() -> None:
    trajectory = time_path(curve("A2"), CHAIR)
    sampled = Trajectory.from_samples(trajectory.times, trajectory.poses)
    run = Run(LookaheadTracker(sampled, CHAIR, EXACT), trajectory.poses[0])
    assert np.abs(run.across).max() < 1e-3
    assert np.hypot(*(run.poses[-1] - trajectory.poses[-1])[:2]) < 2e-3


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: LookaheadGains(kp=-1.0), "gain kp must be a finite number >= 0, got -1.0"),
        (lambda: LookaheadOptions(lookahead=0.0), "lookahead must be a finite positive number"),
        (lambda: LookaheadOptions(delay=-0.1), "delay must be a finite number >= 0"),
    ],
)
def test_senseless_options_are_refused(make, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ShapeError, match=message):
        make()


def test_time_must_go_on() -> None:
    tracker = LookaheadTracker(Path.from_poses([[0, 0, 0], [1, 0, 0]]), CHAIR)
    tracker.step(0.0, [0, 0, 0])
    with pytest.raises(ShapeError, match="time must increase"):
        tracker.step(0.0, [0, 0, 0])
