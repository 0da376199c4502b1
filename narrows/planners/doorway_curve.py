"""Two cubic segments through a door, optimised together with the exact body: the program.

Beyond [DoorBezier], whose segments are planned one after the other for a point: the legs of both
segments and the pose of their join are unknowns of one program, the curvature is continuous at the
join, bounded along the curve, and the body keeps a margin to the solids. The body enters through
`Contacts`: at a parameter of the curve one separating axis between body and solid, an edge normal
of either, with two critical vertices each; rows of the program say the gap along the axis is at
least the margin less one common `lack`, which the objective makes as small as it can be.

The cost is (10a) of both segments, or its arc-length form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from ..nlp import Problem, Solver, SolverOptions
from ..se2 import Array
from ..solution import Solution
from .bezier_legs import direction
from .body_contacts import SLOT_SIZE, SLOTS, Contacts
from .smoothness import Smoothness, cost_symbol, curvature_symbols

UNKNOWNS = ("a_1", "b_1", "a_2", "b_2", "along", "aside", "tilt", "lack", "excess")
LEGS_AND_JOIN = 7  # unknowns that shape the curve; the others are elastic
LACK_PRICE = 1e3  # [cost / m]: a millimetre missing weighs as much as J = 1 1/m^2
EXCESS_PRICE = 5e2  # [cost m]: 0.01 1/m of curvature too much weighs like 5 mm missing
CURVATURE_SAMPLES = 24  # on each segment
SHORTEST_LEG = 0.05  # [m]


@dataclass(frozen=True)
class DoorwayBounds:
    """What holds for one solve; a switch is a bound that is infinite or of no width.

    Attributes:
        join: Greatest |along|, |aside| [m] and |tilt| [rad] of the join from the door's middle.
        leg: Greatest leg [m].
        curvature: Bound of |kappa| [1/m], infinite = none.
        continuous: Whether the curvature is continuous at the join.
        convex: Whether each segment is completely convex.
        margin: Clearance asked for at the contacts [m].
    """

    join: tuple[float, float, float]
    leg: float
    curvature: float
    continuous: bool
    convex: bool
    margin: float


def curve_of(start: Array, goal: Array, door: Array, unknowns: Array) -> Array:
    """Return the control points of both segments, shape (..., 2, 4, 2), [m].

    Args:
        start: Pose, shape (3,).
        goal: Pose, shape (3,).
        door: Middle of the door and its heading, shape (3,).
        unknowns: As in `UNKNOWNS`, shape (..., 9); the elastic ones are not used.
    """
    z = np.asarray(unknowns, dtype=float)[..., None]
    ahead = direction(door[2])
    left = np.array([-ahead[1], ahead[0]])
    join = door[:2] + z[..., 4, :] * ahead + z[..., 5, :] * left
    heading = door[2] + z[..., 6, :]
    along = np.concatenate([np.cos(heading), np.sin(heading)], axis=-1)
    begin, end = np.broadcast_to(start[:2], join.shape), np.broadcast_to(goal[:2], join.shape)
    legs = (
        begin + z[..., 0, :] * direction(start[2]),
        join - z[..., 1, :] * along,
        join + z[..., 2, :] * along,
        end - z[..., 3, :] * direction(goal[2]),
    )
    first = np.stack([begin, legs[0], legs[1], join], axis=-2)
    second = np.stack([join, legs[2], legs[3], end], axis=-2)
    return np.stack([first, second], axis=-3)


def turn_signs(start: Array, goal: Array, door: Array) -> Array:
    """Return which way each segment turns, +1 left, -1 right, from the headings, shape (2,)."""
    turns = [math.sin(door[2] - start[2]), math.sin(goal[2] - door[2])]
    return np.array([1.0 if turn >= 0.0 else -1.0 for turn in turns])


def _control_symbols(z: ca.SX, poses: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the control points (4, 2) of both segments; poses are x, y, heading of three."""
    start, goal, door = poses[0:3], poses[3:6], poses[6:9]

    def unit(heading: ca.SX) -> ca.SX:
        return ca.horzcat(ca.cos(heading), ca.sin(heading))

    ahead = unit(door[2])
    left = ca.horzcat(-ahead[1], ahead[0])
    join = door[0:2].T + z[4] * ahead + z[5] * left
    along = unit(door[2] + z[6])
    begin, end = start[0:2].T, goal[0:2].T
    first = ca.vertcat(begin, begin + z[0] * unit(start[2]), join - z[1] * along, join)
    second = ca.vertcat(join, join + z[2] * along, end - z[3] * unit(goal[2]), end)
    return first, second


def _cross(a: ca.SX, b: ca.SX) -> ca.SX:
    return a[0] * b[1] - a[1] * b[0]


def _convexity_rows(control: ca.SX) -> ca.SX:
    """Return w1 and w2 of [DoorBezier, Eq. (7)] without their factors |P0P1| and |P2P3|."""
    legs = [control[k + 1, :] - control[k, :] for k in range(3)]
    first = _cross(legs[0] / ca.norm_2(legs[0]), legs[1])
    return ca.vertcat(first, _cross(legs[1], legs[2] / ca.norm_2(legs[2])))


def _contact_rows(control: ca.SX, lack: ca.SX, slots: ca.SX) -> ca.SX:
    """Return the gap at every slot along its axis, for two pairs of vertices each, plus lack."""
    rows = []
    for k in range(SLOTS):
        slot = slots[SLOT_SIZE * k : SLOT_SIZE * (k + 1)]
        point = ca.mtimes(slot[0:8].T, control)
        tangent = ca.mtimes(slot[8:16].T, control)
        ahead = tangent / ca.sqrt(tangent[0] ** 2 + tangent[1] ** 2)
        left = ca.horzcat(-ahead[1], ahead[0])
        axis = slot[16:18].T + slot[18] * ahead + slot[19] * left
        for pair in range(2):
            corner, vertex = (
                slot[20 + 2 * pair : 22 + 2 * pair],
                slot[24 + 2 * pair : 26 + 2 * pair],
            )
            body = point + corner[0] * ahead + corner[1] * left
            rows.append(ca.dot(axis, vertex.T - body) - slot[28] + lack)
    return ca.vertcat(*rows)


@lru_cache(maxsize=4)
def doorway_solver(smoothness: Smoothness, options: SolverOptions) -> Solver:
    """Return the compiled program; one serves every scene.

    Parameters: start, goal, door (9), turn signs (2), slots. Rows: the curvatures at the join,
    their difference from above and below (2), then curvature at the samples from above and from
    below (2 x 2 x samples), convexity (4), contacts (2 x slots).
    """
    z = ca.SX.sym("z", len(UNKNOWNS))
    poses, signs = ca.SX.sym("poses", 9), ca.SX.sym("signs", 2)
    slots = ca.SX.sym("slots", SLOT_SIZE * SLOTS)
    first, second = _control_symbols(z, poses)
    parameter = np.linspace(0.0, 1.0, CURVATURE_SAMPLES)
    bends = [curvature_symbols(control, parameter)[0] for control in (first, second)]
    bend = ca.vertcat(bends[0][-1] - bends[1][0], *bends)
    lack, excess = z[7], z[8]
    rows = ca.vertcat(
        bend - excess,
        bend + excess,
        signs[0] * _convexity_rows(first),
        signs[1] * _convexity_rows(second),
        _contact_rows(ca.vertcat(first, second), lack, slots),
    )
    problem = Problem(
        unknowns=z,
        objective=cost_symbol(first, smoothness)
        + cost_symbol(second, smoothness)
        + LACK_PRICE * lack
        + EXCESS_PRICE * excess,
        constraints=rows,
        parameters=ca.vertcat(poses, signs, slots),
        name="two segments through a door",
    )
    return Solver(problem, options)


def run_doorway(
    solver: Solver,
    poses: tuple[Array, Array, Array],
    contacts: Contacts,
    bounds: DoorwayBounds,
    initial: Array,
    radius: float = math.inf,
) -> Solution:
    """Solve once for given contacts.

    Args:
        solver: From `doorway_solver`.
        poses: Start, goal, door, each shape (3,).
        contacts: Where body and solids are near.
        bounds: What holds.
        initial: Unknowns, shape (9,).
        radius: How far legs [m] and join [m, rad] may move from the initial ones: contacts taken
            from one curve say little about a far one.
    """
    samples = 2 * CURVATURE_SAMPLES
    bend = np.full(1 + samples, bounds.curvature)
    bend[0] = 0.0 if bounds.continuous else np.inf
    convex = np.full(4, 0.0 if bounds.convex else -np.inf)
    gaps = np.where(contacts.active, bounds.margin, -np.inf)
    unbounded = np.full(1 + samples, np.inf)
    shape, join = initial[:LEGS_AND_JOIN], np.array(bounds.join)
    least = np.maximum(np.concatenate([np.full(4, SHORTEST_LEG), -join]), shape - radius)
    most = np.minimum(np.concatenate([np.full(4, bounds.leg), join]), shape + radius)
    return solver.solve(
        initial,
        parameters=np.concatenate([*poses, turn_signs(*poses), contacts.slots]),
        lower=np.concatenate([-unbounded, -bend, convex, gaps]),
        upper=np.concatenate([bend, unbounded, np.full(4 + len(gaps), np.inf)]),
        unknown_lower=np.concatenate([least, [0.0, 0.0]]),
        unknown_upper=np.concatenate([most, [np.inf, np.inf]]),
    )
