"""One cubic Bezier segment between two poses: the optimisation of [DoorBezier, Eqs. (10), (11)].

Unknown are the two legs (`bezier_legs`), bounded by regions and convexity. Only sampled obstacles
(12) and the curvature bound, which is not in the paper, are constraints of the program.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

import casadi as ca
import numpy as np

from .. import bezier
from ..nlp import Problem, Solver, SolverOptions
from ..se2 import Array, wrap
from ..solution import Solution
from .bezier_legs import LegBounds, control_points, direction, leg_bounds
from .smoothness import Smoothness, bernstein, cost, cost_symbol, curvature_symbols

GRID = 12  # legs tried on each axis before the optimiser starts


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A disk that the curve's points keep out of [DoorBezier, Eq. (12)].

    Attributes:
        center: Centre, [m].
        distance: d_r, from its centre to the curve [m].
    """

    center: tuple[float, float]
    distance: float


@dataclass(frozen=True)
class SegmentOptions:
    """What one segment has to satisfy.

    Attributes:
        smoothness: The cost.
        convex: Complete convexity (8); without it the curve may bend both ways.
        curvature: Bound of |kappa| at the samples [1/m]; infinite = none, as in the paper.
        samples: Parameters at which obstacles and curvature are kept; the paper takes 1000.
        solver: How to solve.
    """

    smoothness: Smoothness = field(default_factory=Smoothness)
    convex: bool = True
    curvature: float = math.inf
    samples: int = 101
    solver: SolverOptions = field(default_factory=lambda: SolverOptions(iteration_limit=60))


@dataclass(frozen=True, eq=False)
class Segment:
    """The best segment found.

    Attributes:
        control: Control points, shape (4, 2), [m], or None.
        legs: a and b [m], shape (2,), of the best attempt.
        cost: J there, infinite without a curve.
        reason: Why there is no curve, or empty.
        solution: The solver's result behind it, or None where none was needed.
        iterations: Of all starts together.
    """

    control: Array | None
    legs: Array
    cost: float
    reason: str = ""
    solution: Solution | None = None
    iterations: int = 0


@lru_cache(maxsize=16)
def segment_solver(options: SegmentOptions, obstacles: int) -> Solver:
    """Return the compiled program for a number of obstacles.

    Parameters: start x, y, u_x, u_y; end x, y, u_x, u_y; then x, y, 1 / d_r of each obstacle.
    Rows: the squared distances over d_r^2 of each obstacle's samples, at least 1; then the
    curvature at the samples.
    """
    legs, ends = ca.SX.sym("legs", 2), ca.SX.sym("ends", 8)
    disks = ca.SX.sym("disks", 3 * obstacles)
    start, end = ends[0:2].T, ends[4:6].T
    control = ca.vertcat(start, start + legs[0] * ends[2:4].T, end - legs[1] * ends[6:8].T, end)
    parameter = np.linspace(0.0, 1.0, options.samples)
    points = ca.mtimes(ca.DM(bernstein(parameter)), control)
    rows = [
        ((points[:, 0] - disks[3 * k]) ** 2 + (points[:, 1] - disks[3 * k + 1]) ** 2)
        * disks[3 * k + 2] ** 2
        for k in range(obstacles)
    ]
    if math.isfinite(options.curvature):
        rows.append(curvature_symbols(control, parameter)[0])
    problem = Problem(
        unknowns=legs,
        objective=cost_symbol(control, options.smoothness),
        constraints=ca.vertcat(*rows) if rows else ca.SX(0, 1),
        parameters=ca.vertcat(ends, disks),
        name="Bezier segment",
    )
    return Solver(problem, options.solver)


def solve_segment(
    start: Array,
    end: Array,
    region: Array,
    obstacles: tuple[Obstacle, ...] = (),
    options: SegmentOptions | None = None,
) -> Segment:
    """Return the smoothest cubic segment between two poses, or why there is none.

    Starts of the optimiser: the paper's (both free control points at the segment's start, as near
    as the tangents allow) and the best two of a coarse grid over the legs, since "the initial
    value highly decides if the global minimum can be reached".

    Args:
        start: Pose [x, y, heading], shape (3,), [m, m, rad].
        end: Pose, shape (3,).
        region: Half-planes [n_x, n_y, c], n . p <= c, that hold the control points, shape (H, 3).
        obstacles: Disks to keep away from.
        options: What to satisfy; default `SegmentOptions()`.
    """
    chosen = SegmentOptions() if options is None else options
    bounds = leg_bounds(start, end, region, convex=chosen.convex)
    if bounds.reason:
        return Segment(None, bounds.lower, math.inf, bounds.reason)
    chord = end[:2] - start[:2]
    size = float(np.linalg.norm(chord))
    if float(np.dot(chord, direction(start[2]))) > (1.0 - 1e-15) * size and (
        abs(float(wrap(end[2] - start[2]))) < 1e-9
    ):
        return _straight(start, end, bounds, obstacles, chosen)
    attempts = [
        run_segment(start, end, bounds, legs, obstacles, chosen)
        for legs in _starts(start, end, bounds, obstacles, chosen)
    ]
    iterations = sum(attempt.statistics.iterations for attempt in attempts)
    solved = [attempt for attempt in attempts if attempt.is_solved]
    if solved:
        best = min(solved, key=lambda attempt: attempt.objective)
        control = control_points(start, end, best.unknowns)
        return Segment(control, best.unknowns, best.objective, "", best, iterations)
    nearest = min(
        attempts, key=lambda attempt: np.nan_to_num(attempt.constraint_violation, nan=9e9)
    )
    reason = _blocked(start, end, nearest, obstacles, chosen)
    return Segment(None, nearest.unknowns, math.inf, reason, nearest, iterations)


def run_segment(
    start: Array,
    end: Array,
    bounds: LegBounds,
    initial: Array | Solution,
    obstacles: tuple[Obstacle, ...],
    options: SegmentOptions,
) -> Solution:
    """Solve from one start, legs or an earlier solution, within bounds from `leg_bounds`."""
    disks = [(*disk.center, 1.0 / disk.distance) for disk in obstacles]
    ends = (*start[:2], *direction(start[2]), *end[:2], *direction(end[2]))
    away = np.ones(options.samples * len(obstacles))
    bends = np.full(options.samples if math.isfinite(options.curvature) else 0, options.curvature)
    return segment_solver(options, len(obstacles)).solve(
        initial,
        parameters=np.concatenate([ends, np.ravel(disks)]),
        lower=np.concatenate([away, -bends]),
        upper=np.concatenate([np.full_like(away, np.inf), bends]),
        unknown_lower=bounds.lower,
        unknown_upper=bounds.upper,
    )


def _straight(
    start: Array,
    end: Array,
    bounds: LegBounds,
    obstacles: tuple[Obstacle, ...],
    options: SegmentOptions,
) -> Segment:
    """Return the straight line: its cost is 0 whatever the legs, so nothing is optimised."""
    size = float(np.linalg.norm(end[:2] - start[:2]))
    legs = np.clip(np.full(2, size / 3.0), bounds.lower, bounds.upper)
    control = control_points(start, end, legs)
    short = _shortfalls(control, obstacles, options)
    if len(short) and short.max() > 0.0:
        reason = f"an obstacle lies {short.max() * 1e3:.0f} mm too near to the straight line"
        return Segment(None, legs, math.inf, reason)
    return Segment(control, legs, 0.0)


def _shortfalls(control: Array, obstacles: tuple[Obstacle, ...], options: SegmentOptions) -> Array:
    """Return by how much the curve's samples come too near to each obstacle, shape (K,), [m]."""
    points = bezier.evaluate(control, np.linspace(0.0, 1.0, options.samples))
    return np.array(
        [o.distance - np.linalg.norm(points - o.center, axis=1).min() for o in obstacles]
    )


def _starts(
    start: Array,
    end: Array,
    bounds: LegBounds,
    obstacles: tuple[Obstacle, ...],
    options: SegmentOptions,
) -> list[Array]:
    """Return legs to start the optimiser from."""
    axes = [
        np.linspace(low, high, GRID + 2)[1:-1]
        for low, high in zip(bounds.lower, bounds.upper, strict=True)
    ]
    legs = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    control = control_points(start, end, legs)
    worth = cost(control, options.smoothness)
    points = bezier.evaluate(control[:, None], np.linspace(0.0, 1.0, 24))  # (G, 24, 2)
    for disk in obstacles:
        near = np.linalg.norm(points - disk.center, axis=-1).min(axis=1)
        worth = worth + 1e3 * np.maximum(0.0, disk.distance - near)
    if math.isfinite(options.curvature):
        sharpest = np.abs(bezier.curvature(control[:, None], np.linspace(0.0, 1.0, 24))).max(axis=1)
        worth = worth + 1e2 * np.maximum(0.0, sharpest - options.curvature)
    order = np.argsort(np.nan_to_num(worth, nan=np.inf))
    best = legs[order[0]]
    apart = np.linalg.norm(legs - best, axis=1) > 0.35 * np.linalg.norm(bounds.upper - bounds.lower)
    others = [legs[k] for k in order if apart[k]][:1]
    along = float(np.dot(end[:2] - start[:2], direction(end[2])))
    paper = np.clip([0.0, along], bounds.lower, bounds.upper)
    return [best, *others, np.asarray(paper)]


def _blocked(
    start: Array,
    end: Array,
    nearest: Solution,
    obstacles: tuple[Obstacle, ...],
    options: SegmentOptions,
) -> str:
    """Return which constraint the best attempt breaks, by how much."""
    control = control_points(start, end, nearest.unknowns)
    short = _shortfalls(control, obstacles, options)
    if len(short) and short.max() > 1e-6:
        x, y = obstacles[int(short.argmax())].center
        return (
            f"no curve stays far enough from the obstacle at ({x:.2f}, {y:.2f}); the best one "
            f"found is {short.max() * 1e3:.0f} mm too near"
        )
    bend = float(np.abs(bezier.curvature(control, np.linspace(0.0, 1.0, options.samples))).max())
    if bend > options.curvature:
        return (
            f"the curve would have to bend with {bend:.2f} 1/m (radius {1.0 / bend:.2f} m), "
            f"allowed are {options.curvature:.2f} 1/m"
        )
    return f"the optimiser found no curve: {nearest.message}"
