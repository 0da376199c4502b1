"""Nonlinear model-predictive tracking: the best commands over the next second, every period."""

from __future__ import annotations

import math
import time as clocks

import numpy as np
from numpy.typing import ArrayLike

from ..path import Path
from ..se2 import Array
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from ..world import World
from .clock import Clock
from .delay import DelayPrediction
from .legs import Leg, legs_of
from .predictive_options import PredictiveOptions, StepStatus
from .predictive_program import PredictiveProgram, ProgramShape, build_program, horizon_steps
from .predictive_solve import HorizonSolver
from .schedule import Schedule
from .separating_rows import SeparatingRows

_REACH = 0.15  # m: how far from its last place the foot is looked for
_MISSING = 1e-4  # m: less missing clearance than this is the solver's tolerance


class PredictiveTracker:
    """Steers by the best commands over a horizon of about 1.3 s, planned anew every period.

    Minimised are the errors of the predicted poses to the reference's and the deviations of the
    commands and their rates from the reference's own (`PredictiveWeights`). Kept are the chair's
    speed, yaw rate, acceleration, yaw acceleration, lateral acceleration, curvature and, if asked,
    jerk; with a world, also a margin to solids that stand still, as far as it can be.

    Convergence: around a reference the limits allow, the cost-to-go falls as long as the horizon
    is long against the chair's answer: there is no terminal constraint and no proof; the tests
    show errors of 0.2 m decay. The pose is first carried over the known delay by the commands on
    their way, so a latency that is known costs no accuracy on a steady curve.

    Every step ends in a `StepStatus`. Without a solution the plan of the step before goes on for
    `coast`, then the chair brakes to a stop on its curve; it resumes as soon as there is one.

    It assumes poses once a `period`, and a start within about 0.3 m of the path.

    Attributes:
        status: How the last command came about.
        counts: How many steps ended in each status.
        clearance_missing: Greatest clearance missing to the margin in the last plan [m].
    """

    def __init__(
        self,
        motion: Path | Trajectory,
        vehicle: Vehicle,
        options: PredictiveOptions | None = None,
        *,
        world: World | None = None,
    ) -> None:
        """Table the path and compile the program.

        Args:
            motion: The path, driven at the cruising speed; or a trajectory, driven at its own.
            vehicle: Its limits are kept.
            options: Default `PredictiveOptions()`.
            world: Solids to keep the margin to; None: the plan alone is followed.
        """
        self.options = PredictiveOptions() if options is None else options
        self.status = StepStatus.SOLVED
        self.counts = dict.fromkeys(StepStatus, 0)
        self.clearance_missing = 0.0
        self._limits = vehicle.limits
        self._legs = legs_of(motion.path if isinstance(motion, Trajectory) else motion)
        self._schedule = Schedule.of(motion, self._legs, vehicle, speed=self.options.speed)
        self._solids = None if world is None else SeparatingRows(world, vehicle)
        self._program = self._build()
        self._solver = HorizonSolver(self._program, self._limits, self.options)
        self._ends = np.cumsum(self._program.shape.steps)
        self._middles = self._ends - 0.5 * np.array(self._program.shape.steps)
        self._prediction = DelayPrediction(self.options.delay)
        self._ticks = Clock(self.options.period)
        self._reached = 0.0
        self._last = np.zeros(2)
        self._acceleration = 0.0
        self._failing = 0.0  # s without a solution
        self._begin(0)
        # Whatever is loaded or compiled at the first solve must not count against its budget.
        still = self._legs[0].pose(self._legs[0].start)
        self._command(np.array(still), self.options.period, -math.inf)
        self.counts = dict.fromkeys(StepStatus, 0)
        self._failing = 0.0
        self._begin(0)

    def _build(self) -> PredictiveProgram:
        options = self.options
        steps = horizon_steps(options.period, options.steps, options.longest_step)
        clear: tuple[int, ...] = ()
        if self._solids is not None:
            clear = tuple(range(2, len(steps), 2))
        shape = ProgramShape(
            steps,
            options.weights,
            limits_curvature=math.isfinite(self._limits.curvature),
            limits_jerk=options.keep_jerk,
            clear_steps=clear,
        )
        return build_program(shape)

    def _begin(self, index: int) -> None:
        """Start a leg, or finish behind the last."""
        self._index = index
        self._clock = 0.0
        self._plan: Array | None = None
        self._before = np.zeros(2)
        if index < len(self._legs):
            self._near = self._legs[index].start

    @property
    def progress(self) -> float:
        """Greatest progress along the path reached so far, [m] or [rad]."""
        return self._reached

    @property
    def finished(self) -> bool:
        """Whether the end of the path is reached or passed."""
        return self._index >= len(self._legs)

    def step(self, time: float, pose: ArrayLike) -> Array:
        """Return the command for the coming period; zero once finished. See `Tracker.step`."""
        begun = clocks.thread_time()
        x, y, heading = (float(value) for value in np.asarray(pose, dtype=float))
        period = self._ticks.tick(time)
        command = np.zeros(2)
        if not self.finished:
            ahead = self._prediction.predict(time, x, y, heading)
            if not self._arrived(ahead):
                command = self._command(np.array(ahead), period, begun)
        self._acceleration = float(command[0] - self._last[0]) / period
        self._last = command
        self._prediction.sent(time, float(command[0]), float(command[1]))
        return command.copy()

    def _arrived(self, pose: tuple[float, float, float]) -> bool:
        """Find the chair's place on the leg; go on to the next leg where this one is done."""
        leg, options = self._legs[self._index], self.options
        x, y, heading = pose
        if leg.direction == 0:
            within = min(max(self._near, leg.start), leg.end)
            off = math.remainder(heading - leg.heading(within), 2.0 * math.pi)
            self._near = within + math.copysign(1.0, leg.turn) * off
            close = options.arrival_turn
        else:
            self._near = leg.project(x, y, near=self._near, reach=_REACH).progress
            close = options.arrival
        self._reached = max(self._reached, min(self._near, leg.end))
        late = self._clock - self._schedule.durations[self._index]
        if late >= options.patience or (late >= 0.0 and self._near >= leg.end - close):
            self._reached = leg.end
            self._begin(self._index + 1)
            return True
        return False

    def _command(self, pose: Array, period: float, begun: float) -> Array:
        """Return the command at a predicted pose."""
        leg = self._legs[self._index]
        poses, commands = self._reference(leg)
        # The heading's turns are those of the reference.
        pose[2] += 2.0 * math.pi * round((poses[0, 2] - pose[2]) / (2.0 * math.pi))
        guess = self._guess(commands, period)
        parameters = self._parameters(leg, pose, poses, commands, guess)
        status = StepStatus.SOLVED
        found = self._solve(leg, guess, parameters, keep_jerk=True)
        if found is None and self._program.shape.limits_jerk:
            status = StepStatus.JERKY
            found = self._solve(leg, guess, parameters, keep_jerk=False)
        self._before = commands[0]
        self._clock = self._schedule.advanced(self._index, self._clock, self._near, period)
        in_time = clocks.thread_time() - begun <= self.options.budget
        if found is not None:
            self._plan = found
            self.clearance_missing = float(found[2 * self._program.count :].max(initial=0.0))
        if found is not None and in_time:
            self._failing = 0.0
            self._note(StepStatus.CLOSE if self.clearance_missing > _MISSING else status)
            return np.array(found[:2])
        self._failing += period
        if found is None:
            self._plan = guess
        if self._failing <= self.options.coast + 1e-9:
            self._note(StepStatus.SHIFTED)
            return np.array(guess[:2])
        self._note(StepStatus.BRAKING)
        self._plan = None
        return self._braked(period)

    def _solve(self, leg: Leg, guess: Array, parameters: Array, *, keep_jerk: bool) -> Array | None:
        return self._solver.solve(
            guess, parameters, direction=leg.direction, last=self._last, keep_jerk=keep_jerk
        )

    def _note(self, status: StepStatus) -> None:
        self.status = status
        self.counts[status] += 1

    def _braked(self, period: float) -> Array:
        """Return the last command slowed down, its curvature kept; on the spot the yaw rate."""
        speed = abs(float(self._last[0]))
        if speed > 0.0:
            share = max(speed - self._limits.acceleration * period, 0.0) / speed
        else:
            rate = abs(float(self._last[1]))
            slower = max(rate - self._limits.yaw_acceleration * period, 0.0)
            share = slower / rate if rate > 0.0 else 0.0
        return np.asarray(share * self._last)

    def _reference(self, leg: Leg) -> tuple[Array, Array]:
        """Return reference poses (N, 3) at the steps' ends and mean commands (N, 2) on them."""
        times = self._clock + np.concatenate([[0.0], self._ends])
        progress = self._schedule.progress(self._index, times)
        rows = leg.origin + leg.step * np.arange(len(leg.poses))
        poses = np.column_stack([np.interp(progress, rows, column) for column in leg.poses.T])
        steps = np.diff(times)
        commands = np.column_stack(
            [leg.direction * np.diff(progress) / steps, np.diff(poses[:, 2]) / steps]
        )
        return poses[1:], commands

    def _guess(self, commands: Array, period: float) -> Array:
        """Return the plan of the step before, one period on, or else the reference's commands."""
        count = len(commands)
        guess = np.zeros(self._program.problem.unknowns.numel())
        if self._plan is None:
            guess[: 2 * count] = commands.ravel()
            return guess
        guess[2 * count :] = self._plan[2 * count :]
        plan = self._plan[: 2 * count].reshape(count, 2)
        later = self._middles + period
        for column in range(2):
            guess[column : 2 * count : 2] = np.interp(later, self._middles, plan[:, column])
        return guess

    def _parameters(
        self, leg: Leg, pose: Array, poses: Array, commands: Array, guess: Array
    ) -> Array:
        sharpest = leg.direction * min(self._limits.curvature, 1e3)
        ending = self._limits.acceleration / self._limits.jerk
        parts = [
            *(pose, self._last, np.array([self._acceleration]), self._before),
            *(poses.ravel(), commands.ravel(), np.array([sharpest, ending])),
        ]
        clear = self._program.shape.clear_steps
        if self._solids is not None and clear:
            blank = np.zeros(self._program.problem.parameters.numel())
            blank[:3] = pose
            predicted = np.asarray(self._program.poses(guess, blank))
            within = self.options.margin + 0.3
            parts.append(self._solids.pick(predicted[list(clear)], within).ravel())
        return np.concatenate(parts)
