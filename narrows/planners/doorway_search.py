"""Search for the best pair of segments through a door: many starts, few solves, true clearances.

The contacts that stand for the body in the program are taken from one curve and describe its
neighbourhood. So: spread candidate curves over all legs and joins, judge them by samples, and
improve the best few; each step solves the program within a trust radius about the curve the
contacts are from, and counts only if the clearance measured on the new curve bears it out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from .. import bezier
from ..bezier_section import BezierSection
from ..clearance import Certificate, certify, clearance_at
from ..errors import ShapeError
from ..nlp import SolverOptions
from ..path import Path
from ..se2 import Array
from ..solution import Solution
from ..vehicle import Vehicle
from ..world import Solid, World
from .body_contacts import Contacts, curve_poses, find_contacts
from .doorway_curve import (
    EXCESS_PRICE,
    LACK_PRICE,
    LEGS_AND_JOIN,
    SHORTEST_LEG,
    DoorwayBounds,
    curve_of,
    doorway_solver,
    run_doorway,
)
from .smoothness import Smoothness

CANDIDATES = 4000
JUDGED = 120  # candidates whose clearance is sampled
APART = 0.25  # [m, rad] between two starts
EXCESS_TOLERANCE = 1e-4  # [1/m]; what the solver leaves


@dataclass(frozen=True, eq=False)
class DoorwayCurve:
    """A pair of segments and what is known of it.

    Attributes:
        control: Control points, shape (2, 4, 2), [m].
        cost: J of both segments together.
        excess: By how much curvature bound or continuity are broken [1/m].
        certificate: The proof of its clearance.
        solves: Programs solved to find it.
        iterations: Of all solves together.
    """

    control: Array
    cost: float
    excess: float
    certificate: Certificate
    solves: int
    iterations: int

    @property
    def is_drivable(self) -> bool:
        """Whether curvature bound and continuity are kept."""
        return self.excess <= EXCESS_TOLERANCE


@dataclass(frozen=True, eq=False)
class DoorwayTask:
    """What is searched through.

    Attributes:
        world: Solids; bounds count as walls.
        vehicle: Body.
        poses: Start, goal, door, each shape (3,).
        bounds: What holds.
        smoothness: The cost.
        solver: How to solve.
        body: Whether the body keeps the margin; else only the curve counts.
    """

    world: World
    vehicle: Vehicle
    poses: tuple[Array, Array, Array]
    bounds: DoorwayBounds
    smoothness: Smoothness
    solver: SolverOptions
    body: bool


def with_frame(world: World) -> World:
    """Return the world with its bounds as four walls, for optimisers that know only solids."""
    if world.bounds is None:
        return world
    x0, y0, x1, y1 = world.bounds
    t = 1.0
    boxes = [
        (x0 - t, y0 - t, x0, y1 + t),
        (x1, y0 - t, x1 + t, y1 + t),
        (x0 - t, y0 - t, x1 + t, y0),
        (x0 - t, y1, x1 + t, y1 + t),
    ]
    frame = tuple(
        Solid.polygon([[a, b], [c, b], [c, d], [a, d]], z=(0.0, 100.0), name="the world's bounds")
        for a, b, c, d in boxes
    )
    return replace(world, solids=world.solids + frame)


def search_doorway(task: DoorwayTask, *, starts: int) -> DoorwayCurve | None:
    """Return the best pair of segments found, or None if no start led anywhere.

    Best: drivable before not, then the margin kept before not, then the clearance where it is
    not kept and the cost where it is.

    Args:
        task: What is asked.
        starts: Number of starts that are improved.
    """
    framed = replace(task, world=with_frame(task.world))
    best: DoorwayCurve | None = None
    solves = iterations = 0
    for initial in spread_starts(framed, starts):
        improved = _improve(framed, initial)
        solves, iterations = solves + improved.solves, iterations + improved.iterations
        curve = _certified(task, framed, improved)
        if curve is not None and (best is None or _rank(task, curve) < _rank(task, best)):
            best = curve
    return None if best is None else replace(best, solves=solves, iterations=iterations)


def _rank(task: DoorwayTask, curve: DoorwayCurve) -> tuple[float, ...]:
    lacking = max(0.0, task.bounds.margin - curve.certificate.clearance) if task.body else 0.0
    lacking = 0.0 if lacking < 1e-3 else lacking  # the certificate's own tolerance
    return (0.0 if curve.is_drivable else curve.excess, lacking, curve.cost)


def spread_starts(task: DoorwayTask, count: int) -> list[Array]:
    """Return unknowns of the most promising candidates, at least `APART` from each other.

    Candidates fill the legs and the join evenly (an additive recurrence, the same every time).
    Cheap judgement first: the cost, with curvature and its jump priced; then sampled clearance.
    """
    start, goal, door = task.poses
    ways = np.array([np.linalg.norm(door[:2] - p[:2]) for p in (start, goal)])
    join = np.array(task.bounds.join)
    low = np.concatenate([np.maximum(SHORTEST_LEG, 0.1 * ways).repeat(2), -join])
    high = np.concatenate([np.maximum(0.1, 0.9 * ways).repeat(2), join])
    unknowns = np.zeros((CANDIDATES, LEGS_AND_JOIN + 2))
    unknowns[:, :LEGS_AND_JOIN] = low + _evenly_spread(CANDIDATES, LEGS_AND_JOIN) * (high - low)
    control = curve_of(start, goal, door, unknowns)  # (C, 2, 4, 2)
    node = np.linspace(0.0, 1.0, 12)
    bend = bezier.curvature(control[:, :, None], node)  # (C, 2, 12)
    worth = np.trapezoid(bend**2, node, axis=-1).sum(axis=1)
    sharpest = np.abs(bend).max(axis=(1, 2))
    worth += EXCESS_PRICE * np.maximum(0.0, sharpest - task.bounds.curvature)
    if task.bounds.continuous:
        worth += 20.0 * np.abs(bend[:, 0, -1] - bend[:, 1, 0])
    order = np.argsort(worth)
    if task.body:
        order = order[:JUDGED]
        poses = np.concatenate([curve_poses(control[k], 16) for k in order])
        clearance = clearance_at(task.world, task.vehicle, poses)[0].reshape(len(order), -1)
        lacking = np.maximum(0.0, task.bounds.margin - clearance.min(axis=1))
        order = order[np.argsort(worth[order] + LACK_PRICE * lacking)]
    chosen: list[Array] = []
    for k in order:
        if all(np.abs(unknowns[k] - other).max() > APART for other in chosen):
            chosen.append(unknowns[k])
        if len(chosen) == count:
            break
    return chosen


def _evenly_spread(count: int, dimensions: int) -> Array:
    """Return points that fill the unit cube evenly, shape (count, dimensions).

    Additive recurrence with the powers of 1 / g, g^(d + 1) = g + 1.
    """
    root = 2.0
    for _ in range(40):
        root = (1.0 + root) ** (1.0 / (dimensions + 1))
    step = root ** -np.arange(1.0, dimensions + 1.0)
    return np.asarray((0.5 + np.outer(np.arange(1, count + 1), step)) % 1.0)


@dataclass(frozen=True, eq=False)
class _Improved:
    """Where the improvement of one start ended."""

    unknowns: Array | None
    cost: float
    solves: int
    iterations: int


def _improve(task: DoorwayTask, initial: Array, *, rounds: int = 12) -> _Improved:
    """Improve one start until the program promises less than 0.2 %."""
    solver = doorway_solver(task.smoothness, task.solver)
    point, merit, cost = initial, math.inf, math.inf
    contacts = _contacts(task, point)
    radius, solves, iterations, accepted = 0.3, 0, 0, False
    for _ in range(rounds):
        trial = run_doorway(solver, task.poses, contacts, task.bounds, point, radius)
        solves, iterations = solves + 1, iterations + trial.statistics.iterations
        if not trial.is_solved:
            radius *= 0.4
            if radius < 1e-3:
                break
            continue
        seen = _contacts(task, trial.unknowns)
        found = _merit(task, trial, seen)
        promised, kept = merit - trial.objective, merit - found
        step = float(np.abs(trial.unknowns - point)[:LEGS_AND_JOIN].max())
        if not accepted or kept > 0.1 * promised:
            if accepted and kept > 0.7 * promised and step > 0.9 * radius:
                radius *= 2.0
            point, contacts, merit, accepted = trial.unknowns, seen, found, True
            cost = _cost(trial)
        else:
            radius = 0.3 * step
        if promised < 0.002 * merit or radius < 1e-3:
            break
    return _Improved(point if accepted else None, cost, solves, iterations)


def _contacts(task: DoorwayTask, unknowns: Array) -> Contacts:
    control = curve_of(*task.poses, unknowns)
    contacts = find_contacts(task.world, task.vehicle, control, task.bounds.margin)
    if task.body:
        return contacts
    return replace(contacts, active=np.zeros_like(contacts.active), clearance=math.inf)


def _cost(solution: Solution) -> float:
    lack, excess = solution.unknowns[LEGS_AND_JOIN:]
    return float(solution.objective - LACK_PRICE * lack - EXCESS_PRICE * excess)


def _merit(task: DoorwayTask, solution: Solution, seen: Contacts) -> float:
    """Return the objective with the lack measured on the curve instead of promised."""
    lack = max(0.0, task.bounds.margin - seen.clearance)
    return _cost(solution) + LACK_PRICE * lack + EXCESS_PRICE * float(solution.unknowns[-1])


def _certified(task: DoorwayTask, framed: DoorwayTask, improved: _Improved) -> DoorwayCurve | None:
    """Return the curve with its certificate; ask for more where samples saw too little.

    Between samples the body may come nearer than at them. What the certificate misses is added
    to the margin of the program, twice at most.
    """
    if improved.unknowns is None:
        return None
    unknowns, cost = improved.unknowns, improved.cost
    certificate = _certificate(task, unknowns)
    solver = doorway_solver(task.smoothness, task.solver)
    asked = task.bounds.margin
    for _ in range(2 if task.body else 0):
        missing = task.bounds.margin - (-1.0 if certificate is None else certificate.clearance)
        if certificate is None or not 0.0 < missing < 0.03:
            break
        asked += missing + 2e-4
        bounds = replace(task.bounds, margin=asked)
        contacts = _contacts(framed, unknowns)
        trial = run_doorway(solver, task.poses, contacts, bounds, unknowns, 0.1)
        if not trial.is_solved:
            break
        better = _certificate(task, trial.unknowns)
        if better is None or better.clearance <= certificate.clearance:
            break
        if trial.unknowns[-1] > max(EXCESS_TOLERANCE, unknowns[-1]):
            break
        unknowns, cost, certificate = trial.unknowns, _cost(trial), better
    if certificate is None:
        return None
    control = curve_of(*task.poses, unknowns)
    return DoorwayCurve(control, cost, float(unknowns[-1]), certificate, 0, 0)


def _certificate(task: DoorwayTask, unknowns: Array) -> Certificate | None:
    try:
        path = Path((BezierSection(curve_of(*task.poses, unknowns)),))
    except ShapeError:  # a curve that stands still has no heading
        return None
    return certify(task.world, task.vehicle, path)
