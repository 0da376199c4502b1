"""The program of predictive tracking: commands over a horizon, stated in CasADi.

The chair moves on exact arcs, p_{k+1} = p_k + v h sinc(a) [cos, sin](theta_k + a) with
a = omega h / 2, theta_{k+1} = theta_k + 2 a, over steps h that grow from one control period. The
states are eliminated, so the unknowns are the commands and the clearance missing at some of the
steps' ends: what a dense QP solver wants.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np

from ..errors import ShapeError
from ..nlp import Problem
from ..se2 import Array
from .separating_rows import ROWS_PER_POSE


@dataclass(frozen=True)
class PredictiveWeights:
    """What costs how much: each is the deviation that costs as much as the others', per second.

    Attributes:
        along: Error along the reference [m].
        across: Error across it [m].
        heading: Heading error [rad].
        speed: Deviation of the speed from the reference's [m/s].
        yaw_rate: Deviation of the yaw rate [rad/s].
        acceleration: Deviation of the acceleration [m/s^2].
        yaw_acceleration: Deviation of the yaw acceleration [rad/s^2].
        terminal: Factor on the cost of the last pose, per step.
        missing: Clearance missing to the margin [m]. With `across` three times as large the plan
            is left by nine tenths of what is missing.
    """

    along: float = 0.03
    across: float = 0.02
    heading: float = 0.05
    speed: float = 0.2
    yaw_rate: float = 0.5
    acceleration: float = 1.0
    yaw_acceleration: float = 4.0
    terminal: float = 5.0
    missing: float = 0.006

    def __post_init__(self) -> None:
        """Check that all are positive."""
        for name, value in self.__dict__.items():
            if not value > 0.0:
                raise ShapeError(f"weight {name} must be a positive number, got {value}")


@dataclass(frozen=True)
class ProgramShape:
    """What a program is compiled for.

    Attributes:
        steps: Durations of the horizon's steps [s]; the first is the control period.
        weights: Costs.
        limits_curvature: Whether it has rows for the curvature limit.
        limits_jerk: Whether it has rows for the jerk limit.
        clear_steps: Steps at whose ends the body is kept clear, empty for none.
    """

    steps: tuple[float, ...]
    weights: PredictiveWeights = field(default_factory=PredictiveWeights)
    limits_curvature: bool = False
    limits_jerk: bool = False
    clear_steps: tuple[int, ...] = ()


def horizon_steps(period: float, count: int, longest: float) -> tuple[float, ...]:
    """Return durations that grow by a third from the control period to the longest [s].

    >>> horizon_steps(0.75, 3, 1.25)
    (0.75, 1.0, 1.25)
    """
    return tuple(min(4.0**k * period / 3.0**k, max(longest, period)) for k in range(count))


@dataclass(frozen=True, eq=False)
class PredictiveProgram:
    """A compiled program.

    Unknowns: [v_0, omega_0, v_1, ...] (2 N), clearance missing at the K clear steps (K).
    Parameters, in order: pose (3), last command (2), last acceleration (1), reference command
    before (2), reference poses (N, 3), reference commands (N, 2), signed curvature limit (1), time
    to end an acceleration (1), rows of clearance (M, 5). Rows: rates of v (N) and omega (N),
    lateral acceleration (N), omega -+ limit v (2 N, optional), jerk (N) and v + time to end the
    acceleration x its rate (N, both optional), clearance (M).

    Attributes:
        shape: What it is compiled for.
        problem: The nonlinear program, for IPOPT.
        linear: (x, p) -> residuals r, their Jacobian, rows g, their Jacobian. The objective is
            |r|^2.
        poses: (x, p) -> predicted poses (N, 3) at the ends of the steps.
    """

    shape: ProgramShape
    problem: Problem
    linear: ca.Function
    poses: ca.Function

    @property
    def count(self) -> int:
        """Number of steps N."""
        return len(self.shape.steps)

    @cached_property
    def row_gaps(self) -> Array:
        """Time between the middles of successive commands, from the last one sent, (N,), [s]."""
        steps = np.array(self.shape.steps)
        return np.asarray(0.5 * (steps + np.concatenate([steps[:1], steps[:-1]])))

    def linearised(self, x: Array, p: Array) -> tuple[Array, Array, Array, Array]:
        """Return r, dr/dx, g, dg/dx at a point."""
        r, slope, g, rows = self.linear(x, p)
        return np.asarray(r).ravel(), np.asarray(slope), np.asarray(g).ravel(), np.asarray(rows)


@lru_cache(maxsize=8)
def build_program(shape: ProgramShape) -> PredictiveProgram:
    """Return the program of a shape, compiled once in a process; about 50 ms."""
    count = len(shape.steps)
    clear = len(shape.clear_steps)
    unknowns = ca.SX.sym("x", 2 * count + clear)
    pose, last = ca.SX.sym("pose", 3), ca.SX.sym("last", 2)
    last_acceleration, before = ca.SX.sym("acceleration"), ca.SX.sym("before", 2)
    poses, commands = ca.SX.sym("poses", 3, count), ca.SX.sym("commands", 2, count)
    sharpest, ending = ca.SX.sym("sharpest"), ca.SX.sym("ending")
    rows = ca.SX.sym("rows", 5, ROWS_PER_POSE * clear)
    parameters = ca.vertcat(
        pose,
        last,
        last_acceleration,
        before,
        ca.vec(poses),
        ca.vec(commands),
        sharpest,
        ending,
        ca.vec(rows),
    )
    controls, missing = ca.reshape(unknowns[: 2 * count], 2, count), unknowns[2 * count :]
    durations = ca.DM([shape.steps[k] for k in shape.clear_steps])
    predicted = _driven(pose, controls, shape.steps)
    residuals = ca.vertcat(
        _pose_residuals(shape, predicted, poses),
        _control_residuals(shape, controls, commands, last, before),
        ca.sqrt(durations) * missing / shape.weights.missing,
    )
    constraints = ca.vertcat(
        _limit_rows(shape, controls, last, last_acceleration, sharpest, ending),
        _clearance_rows(shape, predicted, rows, missing),
    )
    problem = Problem(
        unknowns, ca.sumsqr(residuals), constraints, parameters, "predictive tracking"
    )
    slopes = [ca.densify(ca.jacobian(part, unknowns)) for part in (residuals, constraints)]
    linear = ca.Function(
        "linear", [unknowns, parameters], [residuals, slopes[0], constraints, slopes[1]]
    )
    path = ca.Function("poses", [unknowns, parameters], [ca.horzcat(*predicted).T])
    return PredictiveProgram(shape, problem, linear, path)


def _driven(pose: ca.SX, controls: ca.SX, steps: tuple[float, ...]) -> list[ca.SX]:
    """Return the poses at the ends of the steps, each (3, 1)."""
    x, y, heading = pose[0], pose[1], pose[2]
    poses = []
    for k, step in enumerate(steps):
        v, half = controls[0, k], 0.5 * step * controls[1, k]
        # sinc to fourth order: at half a radian a step it is right to 1e-5.
        chord = v * step * (1.0 - half**2 / 6.0 + half**4 / 120.0)
        x = x + chord * ca.cos(heading + half)
        y = y + chord * ca.sin(heading + half)
        heading = heading + 2.0 * half
        poses.append(ca.vertcat(x, y, heading))
    return poses


def _pose_residuals(shape: ProgramShape, predicted: list[ca.SX], poses: ca.SX) -> ca.SX:
    weights, parts = shape.weights, []
    for k, pose in enumerate(predicted):
        dx, dy = pose[0] - poses[0, k], pose[1] - poses[1, k]
        c, s = ca.cos(poses[2, k]), ca.sin(poses[2, k])
        factor = weights.terminal if k == len(predicted) - 1 else 1.0
        errors = ca.vertcat(
            (c * dx + s * dy) / weights.along,
            (c * dy - s * dx) / weights.across,
            (pose[2] - poses[2, k]) / weights.heading,
        )
        parts.append(math.sqrt(shape.steps[k] * factor) * errors)
    return ca.vertcat(*parts)


def _control_residuals(
    shape: ProgramShape, controls: ca.SX, commands: ca.SX, last: ca.SX, before: ca.SX
) -> ca.SX:
    weights, parts = shape.weights, []
    off_before, step_before = last - before, shape.steps[0]
    for k, step in enumerate(shape.steps):
        off = controls[:, k] - commands[:, k]
        change = (off - off_before) / (0.5 * (step + step_before))
        errors = ca.vertcat(
            off[0] / weights.speed,
            off[1] / weights.yaw_rate,
            change[0] / weights.acceleration,
            change[1] / weights.yaw_acceleration,
        )
        parts.append(math.sqrt(step) * errors)
        off_before, step_before = off, step
    return ca.vertcat(*parts)


def _limit_rows(
    shape: ProgramShape,
    controls: ca.SX,
    last: ca.SX,
    last_acceleration: ca.SX,
    sharpest: ca.SX,
    ending: ca.SX,
) -> ca.SX:
    steps = (shape.steps[0], *shape.steps)
    gaps = [0.5 * (a + b) for a, b in zip(steps, shape.steps, strict=False)]
    before = ca.horzcat(last, controls[:, :-1])
    rates = (controls - before) / ca.repmat(ca.DM(gaps).T, 2, 1)
    v, omega = controls[0, :].T, controls[1, :].T
    parts = [rates[0, :].T, rates[1, :].T, v * omega]
    if shape.limits_curvature:
        # |omega| <= limit |v|; v keeps its sign on a leg and `sharpest` has it.
        parts += [omega - sharpest * v, -omega - sharpest * v]
    if shape.limits_jerk:
        earlier = ca.vertcat(last_acceleration, rates[0, :-1].T)
        # With v + a t <= most and t = greatest a / jerk, v can end at most: along the line the
        # acceleration falls as a' = -a / t, which the jerk allows.
        parts += [(rates[0, :].T - earlier) / ca.DM(gaps), v + ending * rates[0, :].T]
    return ca.vertcat(*parts)


def _clearance_rows(
    shape: ProgramShape, predicted: list[ca.SX], rows: ca.SX, missing: ca.SX
) -> ca.SX:
    parts = [ca.SX(0, 1)]
    for place, k in enumerate(shape.clear_steps):
        x, y, heading = predicted[k][0], predicted[k][1], predicted[k][2]
        c, s = ca.cos(heading), ca.sin(heading)
        for j in range(ROWS_PER_POSE * place, ROWS_PER_POSE * (place + 1)):
            n_x, n_y, h, v_x, v_y = (rows[i, j] for i in range(5))
            corner_x, corner_y = x + c * v_x - s * v_y, y + s * v_x + c * v_y
            parts.append(n_x * corner_x + n_y * corner_y - h - missing[place])
    return ca.vertcat(*parts)
