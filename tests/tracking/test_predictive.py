"""Predictive tracking: two solvers agree, limits hold, delays vanish, failures end in a stop."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from narrows.clearance import certify, clearance_at
from narrows.errors import ShapeError
from narrows.path import Path
from narrows.planners.timing import time_path
from narrows.se2 import compose
from narrows.simulation.plant import PlantOptions
from narrows.tracking.delay import moved
from narrows.tracking.predictive import PredictiveTracker
from narrows.tracking.predictive_options import PredictiveOptions, StepStatus
from narrows.tracking.predictive_program import ProgramShape, build_program, horizon_steps
from narrows.tracking.separating_rows import ROWS_PER_POSE
from narrows.vehicle import Limits, Vehicle
from narrows.world import Solid, World

OPTIONS = PredictiveOptions(delay=0.0, budget=math.inf)
CHAIR = Vehicle.rectangle(1.0, 0.7, 0.25, limits=Limits(speed=0.5))


def parameters_of(program, rng):
    count = len(program.shape.steps)
    size = program.problem.parameters.numel()
    values = rng.uniform(-0.3, 0.3, size)
    assert size == 3 + 2 + 1 + 2 + 5 * count + 2 + 5 * ROWS_PER_POSE * len(
        program.shape.clear_steps
    )
    return values


def test_the_derivatives_of_the_program_are_its_difference_quotients():
    shape = ProgramShape(
        horizon_steps(0.02, 6, 0.1), limits_curvature=True, limits_jerk=True, clear_steps=(2, 4)
    )
    program = build_program(shape)
    rng = np.random.default_rng(3)
    p = parameters_of(program, rng)
    x = rng.uniform(-0.5, 0.5, program.problem.unknowns.numel())
    _, slope, _, rows = program.linearised(x, p)
    h = 1e-6
    for k in range(len(x)):
        step = h * np.eye(len(x))[k]
        after, before = program.linearised(x + step, p), program.linearised(x - step, p)
        # rows of jerk divide by 20 ms twice: 2.5e3 times rounding over h
        assert_allclose((after[0] - before[0]) / (2 * h), slope[:, k], atol=1e-5)
        assert_allclose((after[2] - before[2]) / (2 * h), rows[:, k], atol=1e-5)


def test_the_poses_predicted_are_exact_arcs():
    program = build_program(ProgramShape(horizon_steps(0.02, 6, 0.1)))
    rng = np.random.default_rng(4)
    p, x = parameters_of(program, rng), rng.uniform(-1, 1, program.problem.unknowns.numel())
    pose, expected = tuple(p[:3]), []
    for k, step in enumerate(program.shape.steps):
        pose = moved(*pose, x[2 * k], x[2 * k + 1], step)
        expected.append(pose)
    assert_allclose(program.poses(x, p), expected, atol=1e-9)


@pytest.mark.parametrize("way", [0, 1])
def test_a_chair_stays_on_a_winding_path(drive, winding, way):
    path = winding[way]
    tracker = PredictiveTracker(path, CHAIR, OPTIONS)
    run = drive(tracker, path.start, path)
    assert run.finished
    assert np.abs(run.across).max() < 1e-3
    assert_allclose(run.poses[-1], path.goal, atol=3e-3)
    assert set(np.flatnonzero(list(tracker.counts.values()))) == {0}


def test_reversing_and_turning_on_the_spot_are_followed(drive, shunting):
    run = drive(PredictiveTracker(shunting, CHAIR, OPTIONS), shunting.start, shunting)
    assert run.finished
    assert np.abs(run.across).max() < 3e-3
    assert_allclose(run.poses[-1], shunting.goal, atol=6e-3)
    assert (np.diff(run.progress) >= 0.0).all()


def drives_of(drive, path, *variants):
    start = compose(path.start, [0.0, 0.03, 0.1])
    runs = [drive(PredictiveTracker(path, CHAIR, options), start, path) for options in variants]
    count = min(len(run.poses) for run in runs) - 2
    return [run.poses[:count, :2] for run in runs]


@pytest.mark.slow
def test_quadratic_steps_drive_as_the_solved_program_does(drive, winding):
    once, often, solved = drives_of(
        drive,
        winding[0],
        OPTIONS,
        replace(OPTIONS, iterations=5),
        replace(OPTIONS, method="ipopt"),
    )
    # The same minimiser by two methods; IPOPT stops at 1e-8 of the scaled conditions.
    assert np.hypot(*(often - solved).T).max() < 2e-5
    # One step a period is not the minimiser: from 30 mm and 6 degrees off it is half a mm away.
    assert np.hypot(*(once - solved).T).max() < 1e-3


def test_from_beside_the_path_errors_decay_within_the_limits(drive):
    limits = Limits(speed=0.5, yaw_rate=0.8, lateral_acceleration=0.25)
    chair = Vehicle.rectangle(1.0, 0.7, 0.25, limits=limits)
    path = Path.from_poses([[0, 0, 0], [6, 0, 0]])
    tracker = PredictiveTracker(path, chair, replace(OPTIONS, iterations=2))
    run = drive(tracker, [0.0, 0.25, -0.4], path)
    assert abs(run.across[-1]) < 1e-3
    v, omega = run.commands.T
    rates = np.abs(np.diff(run.commands[:-1], axis=0, prepend=0.0)) / 0.02  # not the last stop
    slack = 1.0 + 1e-4  # what a quadratic step leaves of a row, and rounding
    assert rates[:, 0].max() <= slack * limits.acceleration
    assert rates[:, 1].max() <= slack * limits.yaw_acceleration
    assert np.abs(v).max() <= slack * limits.speed
    assert np.abs(omega).max() <= slack * limits.yaw_rate
    assert np.abs(v * omega).max() <= 1.02 * limits.lateral_acceleration  # linearised once
    assert rates[:, 1].max() >= 0.99 * limits.yaw_acceleration  # the limits did matter


def test_the_jerk_limit_is_kept_where_it_is_asked_for(drive):
    chair = CHAIR.with_limits(jerk=1.0)
    path = Path.from_poses([[0, 0, 0], [3, 0, 0]])
    peaks = {}
    for keep in (False, True):
        tracker = PredictiveTracker(path, chair, replace(OPTIONS, keep_jerk=keep))
        run = drive(tracker, path.start, path)
        rate = np.diff(run.commands[:, 0], prepend=0.0) / 0.02
        middle = slice(0, len(rate) // 2)
        peaks[keep] = np.abs(np.diff(rate, prepend=0.0))[middle].max() / 0.02
        assert run.finished
    assert peaks[True] <= 1.0 + 1e-3
    assert peaks[False] > 3.0


@pytest.mark.parametrize("latency", [0.1, 0.3])
def test_a_latency_it_knows_costs_nothing(drive, winding, latency):
    path = winding[0]
    plant = PlantOptions(motor_lag=0.05, latency=latency)
    motion = time_path(path, CHAIR)
    told = PredictiveTracker(motion, CHAIR, replace(OPTIONS, delay=latency + 0.05))
    assert np.abs(drive(told, path.start, path, plant=plant).across).max() < 1e-3


def test_it_makes_room_where_the_plan_leaves_too_little(drive):
    post = Solid.polygon([[1.5, 0.36], [2.5, 0.36], [2.5, 1.0], [1.5, 1.0]], name="post")
    world, path = World((post,)), Path.from_poses([[0, 0, 0], [4, 0, 0]])
    assert certify(world, CHAIR, path).attained == pytest.approx(0.01)
    tracker = PredictiveTracker(path, CHAIR, replace(OPTIONS, margin=0.03), world=world)
    run = drive(tracker, path.start, path)
    assert clearance_at(world, CHAIR, run.poses)[0].min() > 0.02
    assert np.abs(run.across).max() < 0.03
    assert tracker.counts[StepStatus.CLOSE] > 0  # and it says so
    assert_allclose(run.poses[-1], path.goal, atol=3e-3)


def test_a_clear_plan_is_followed_as_if_there_were_no_solids(drive, winding):
    path = winding[0]
    far = World((Solid.polygon([[0, 2], [3, 2], [3, 3], [0, 3]], name="far"),))
    with_world, without = (
        drive(PredictiveTracker(path, CHAIR, OPTIONS, world=world), path.start, path)
        for world in (far, None)
    )
    assert_allclose(with_world.poses, without.poses, atol=1e-6)


def test_without_solutions_the_plan_goes_on_and_then_the_chair_brakes(drive, winding):
    path = winding[0]
    tracker = PredictiveTracker(path, CHAIR, OPTIONS)
    pose = path.start
    for k in range(60):
        command = tracker.step(0.02 * k, pose)
        pose = np.array(moved(*pose, *command, 0.02))
    tracker._solver.solve = lambda *_, **__: None
    statuses, commands = [], []
    for k in range(60, 130):
        commands.append(tracker.step(0.02 * k, pose))
        statuses.append(tracker.status)
        pose = np.array(moved(*pose, *commands[-1], 0.02))
    assert statuses[:10] == [StepStatus.SHIFTED] * 10  # 0.2 s
    assert set(statuses[10:]) == {StepStatus.BRAKING}
    speeds = np.array(commands)[:, 0]
    assert speeds[9] > 0.3
    assert (np.diff(speeds[9:]) >= -CHAIR.limits.acceleration * 0.02 - 1e-9).all()
    assert speeds[-1] == 0.0


def test_results_that_come_too_late_are_not_used():
    path = Path.from_poses([[0, 0, 0], [3, 0, 0]])
    tracker = PredictiveTracker(path, CHAIR, replace(OPTIONS, budget=1e-9, coast=1e3))
    for k in range(5):
        tracker.step(0.02 * k, path.start)
    assert tracker.counts[StepStatus.SHIFTED] == 5


def test_the_same_drive_comes_out_twice(drive, winding):
    path = winding[1]
    one, two = (drive(PredictiveTracker(path, CHAIR, OPTIONS), path.start, path) for _ in range(2))
    assert (one.commands == two.commands).all()


def test_wrong_options_are_refused_in_words():
    with pytest.raises(ShapeError, match="method must be 'sqp' or 'ipopt'"):
        PredictiveOptions(method="magic")
    with pytest.raises(ShapeError, match="budget must be positive"):
        PredictiveOptions(budget=0.0)
    with pytest.raises(ShapeError, match="at least 2 steps"):
        PredictiveOptions(steps=1)
