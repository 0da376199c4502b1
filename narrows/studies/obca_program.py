"""The program of OBCA: collision avoidance by the duals of the distance, the whole body, one NLP.

For a body {G z <= g} at the pose (p, R) and a solid {A y <= b} the distance is at least d where
multipliers lambda, mu >= 0 exist with

    (A p - b)'lambda - g'mu >= d,   G'mu + R'A'lambda = 0,   |A'lambda| <= 1

[OBCA]; for a circle of centre c and radius r a vector w takes the place of A'lambda:
w.(p - c) - r - g'mu >= d. The motion is N arcs of equal length h and curvatures kappa_k, so that
the poses between the nodes are known exactly; the nodes alone are kept clear, as in the original.
Minimised is what our own planner minimises: INT kappa^2 + l^2 kappa_s^2 + a ds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from ..errors import ShapeError
from ..geometry import edge_normals, separation
from ..nlp import Problem, Solver, SolverOptions
from ..path import Path
from ..scene import Scene
from ..se2 import Array, rotate, transform, wrap
from ..solution import Solution

_NODES = 60  # arcs: about 75 mm each on a way through a door
_RATE_LENGTH, _LENGTH_WEIGHT = 0.3, 0.05  # l [m], a [1/m^2]: those of our planner
_GOAL_SHARE = 0.999
# The multipliers are not unique where a corner faces a corner: IPOPT's last digits take for ever.
_OPTIONS = SolverOptions(
    tolerance=1e-6,
    iteration_limit=400,
    time_limit=20.0,
    further=(("acceptable_tol", 1e-3), ("acceptable_iter", 8)),
)


@dataclass(frozen=True)
class ProgramShape:
    """Sizes a program is compiled for: edges of the body, and of each solid (0: circle)."""

    body: int
    solids: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class HalfPlanes:
    """A convex polygon as normals (K, 2) and offsets (K,); a circle as its centre and radius."""

    normals: Array
    offsets: Array
    corners: Array
    radius: float

    @property
    def edges(self) -> int:
        """Edges, 0 for a circle."""
        return 0 if self.radius > 0.0 else len(self.normals)

    @property
    def values(self) -> Array:
        """What the program is told."""
        if self.radius > 0.0:
            return np.array([*self.corners[0], self.radius])
        return np.concatenate([self.normals.ravel(), self.offsets])


def half_planes(corners: Array, radius: float) -> HalfPlanes:
    """Return a convex solid as the program takes it.

    Args:
        corners: Counter-clockwise, repeated ones allowed, shape (K, 2), [m]; one for a circle.
        radius: Of a circle [m]; 0 for a polygon.

    Raises:
        ShapeError: If the solid is a polygon with rounded corners.
    """
    distinct = np.concatenate([[True], np.any(np.diff(corners, axis=0) != 0.0, axis=1)])
    corners = corners[distinct]
    if radius > 0.0 and len(corners) > 1:
        raise ShapeError("OBCA here knows polygons and circles, no rounded polygons")
    if radius > 0.0:
        return HalfPlanes(np.zeros((0, 2)), np.zeros(0), corners, radius)
    normals = edge_normals(corners)
    return HalfPlanes(normals, np.einsum("kd,kd->k", normals, corners), corners, 0.0)


class ObcaProgram:
    """The NLP for bodies and solids of so many edges, compiled once."""

    def __init__(self, shape: ProgramShape) -> None:
        """State and compile it."""
        self.shape = shape
        self.widths = [edges if edges else 2 for edges in shape.solids]
        poses, bends, step = (
            ca.SX.sym("poses", 3, _NODES + 1),
            ca.SX.sym("bends", _NODES),
            ca.SX.sym("step"),
        )
        duals = [ca.SX.sym(f"lambda_{i}", n, _NODES + 1) for i, n in enumerate(self.widths)]
        pushes = [ca.SX.sym(f"mu_{i}", shape.body, _NODES + 1) for i in range(len(duals))]
        body = ca.SX.sym("body", 3 * shape.body)
        solids = [ca.SX.sym(f"solid_{i}", 3 * max(n, 1)) for i, n in enumerate(shape.solids)]
        margin = ca.SX.sym("margin")
        dynamics = [poses[:, k + 1] - _arc_end(poses[:, k], bends[k], step) for k in range(_NODES)]
        gaps, ties, norms = [], [], []
        for edges, solid, dual, push in zip(shape.solids, solids, duals, pushes, strict=True):
            for k in range(_NODES + 1):
                gap, tie, norm = _dual_rows(poses[:, k], body, solid, edges, dual[:, k], push[:, k])
                gaps.append(gap - margin)
                ties.append(tie)
                norms.append(norm)
        cost = ca.sumsqr(bends) * step + _LENGTH_WEIGHT * _NODES * step
        cost += _RATE_LENGTH**2 * ca.sumsqr(bends[1:] - bends[:-1]) / step
        self.counts = (3 * _NODES, 2 * len(ties), len(gaps), len(norms))
        problem = Problem(
            ca.vertcat(ca.vec(poses), bends, step, *map(ca.vec, duals), *map(ca.vec, pushes)),
            cost,
            ca.vertcat(*dynamics, *ties, *gaps, *norms),
            ca.vertcat(body, *solids, margin),
            name="OBCA",
        )
        self.solver = Solver(problem, _OPTIONS)

    @staticmethod
    @lru_cache(maxsize=8)
    def of(shape: ProgramShape) -> ObcaProgram:
        """Return the program for a shape, compiled at its first use."""
        return ObcaProgram(shape)

    def start(
        self, scene: Scene, guess: Path, body: HalfPlanes, solids: Sequence[HalfPlanes]
    ) -> Array:
        """Return the unknowns of a rough path, duals from the axes that separate."""
        poses = guess(np.linspace(0.0, guess.span, _NODES + 1))  # (N + 1, 3)
        step = guess.length / _NODES
        poses[0] = scene.start
        most = scene.vehicle.limits.curvature
        bends = np.clip(np.diff(poses[:, 2]) / step, -0.98 * most, 0.98 * most)
        outlines = transform(poses, body.corners)
        duals, pushes = [], []
        for solid in solids:
            corners = np.broadcast_to(solid.corners, (_NODES + 1, *solid.corners.shape))
            away = -separation(outlines, corners).axis  # from the solid to the body
            duals.append(cone_weights(solid.normals, away) if solid.edges else away)
            pushes.append(cone_weights(body.normals, rotate(-poses[:, 2], -away)))
        return np.concatenate(
            [
                poses.ravel(),
                bends,
                [step],
                *(d.ravel() for d in duals),
                *(p.ravel() for p in pushes),
            ]
        )

    def solve(
        self,
        scene: Scene,
        body: HalfPlanes,
        solids: Sequence[HalfPlanes],
        start: Array,
        margin: float,
    ) -> Solution:
        """Solve from a start."""
        nodes, goal, limits = _NODES + 1, scene.goal, scene.vehicle.limits
        lower, upper = np.full(len(start), -np.inf), np.full(len(start), np.inf)
        lower[:3] = upper[:3] = scene.start
        reach = _GOAL_SHARE * np.array([*[goal.position_tolerance / np.sqrt(2.0)] * 2, 0.0])
        reach[2] = _GOAL_SHARE * goal.heading_tolerance
        last = goal.pose.copy()
        last[2] = start[3 * nodes - 1] + wrap(goal.pose[2] - start[3 * nodes - 1])
        lower[3 * nodes - 3 : 3 * nodes] = last - reach
        upper[3 * nodes - 3 : 3 * nodes] = last + reach
        self._bound_places(scene, lower, upper)
        lower[3 * nodes : 3 * nodes + _NODES] = -limits.curvature
        upper[3 * nodes : 3 * nodes + _NODES] = limits.curvature
        begin = 3 * nodes + _NODES
        lower[begin] = 1e-3
        begin += 1
        for edges, width in zip(self.shape.solids, self.widths, strict=True):
            if edges:
                lower[begin : begin + width * nodes] = 0.0
            begin += width * nodes
        lower[begin:] = 0.0
        equal = self.counts[0] + self.counts[1]
        row_lower = np.concatenate(
            [np.zeros(equal + self.counts[2]), np.full(self.counts[3], -1.0)]
        )
        row_upper = np.zeros(len(row_lower))
        row_upper[equal : equal + self.counts[2]] = np.inf
        row_upper[equal + self.counts[2] :] = 1.0
        return self.solver.solve(
            start,
            parameters=np.concatenate([body.values, *(s.values for s in solids), [margin]]),
            lower=row_lower,
            upper=row_upper,
            unknown_lower=lower,
            unknown_upper=upper,
        )

    def _bound_places(self, scene: Scene, lower: Array, upper: Array) -> None:
        """Keep the body origin inside the bounds; the body itself is left to the walls."""
        if scene.world.bounds is None:
            return
        x_min, y_min, x_max, y_max = scene.world.bounds
        for axis, (low, high) in enumerate(((x_min, x_max), (y_min, y_max))):
            rows = slice(3 + axis, 3 * _NODES, 3)
            lower[rows], upper[rows] = low, high

    def path(self, solution: Solution) -> Path:
        """Return the arcs of a solution."""
        return Path.from_poses(solution.unknowns[: 3 * (_NODES + 1)].reshape(-1, 3))


def _arc_end(pose: ca.SX, bend: ca.SX, step: ca.SX) -> ca.SX:
    """Return where an arc ends: the chord of an arc turning by 2u is step sin(u)/u, as a series."""
    half = 0.5 * bend * step
    chord = step * (1.0 - half**2 / 6.0 + half**4 / 120.0)
    middle = pose[2] + half
    return ca.vertcat(
        pose[0] + chord * ca.cos(middle), pose[1] + chord * ca.sin(middle), pose[2] + 2.0 * half
    )


def _dual_rows(
    pose: ca.SX, body: ca.SX, solid: ca.SX, edges: int, dual: ca.SX, push: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return the dual bound on the distance, what must vanish, and |A'lambda|^2."""
    count = push.shape[0]
    own_normals, own_offsets = ca.reshape(body[: 2 * count], 2, count).T, body[2 * count :]
    if edges:
        normals, offsets = ca.reshape(solid[: 2 * edges], 2, edges).T, solid[2 * edges :]
        away = normals.T @ dual
        beyond = ca.dot(dual, normals @ pose[:2] - offsets)
    else:
        away = dual
        beyond = ca.dot(dual, pose[:2] - solid[:2]) - solid[2]
    cosine, sine = ca.cos(pose[2]), ca.sin(pose[2])
    in_body = ca.vertcat(cosine * away[0] + sine * away[1], -sine * away[0] + cosine * away[1])
    return beyond - ca.dot(own_offsets, push), own_normals.T @ push + in_body, ca.sumsqr(away)


def cone_weights(normals: Array, directions: Array) -> Array:
    """Return weights >= 0 of two neighbouring normals that make each direction, shape (M, K)."""
    following = np.roll(normals, -1, axis=0)
    cross = normals[:, 0] * following[:, 1] - normals[:, 1] * following[:, 0]  # (K,)
    first = directions[:, :1] * following[:, 1] - directions[:, 1:] * following[:, 0]
    second = directions[:, 1:] * normals[:, 0] - directions[:, :1] * normals[:, 1]
    first, second = first / cross, second / cross  # (M, K)
    best = np.minimum(first, second).argmax(axis=1)
    rows = np.arange(len(directions))
    weights = np.zeros((len(directions), len(normals)))
    weights[rows, best] += np.maximum(first[rows, best], 0.0)
    weights[rows, (best + 1) % len(normals)] += np.maximum(second[rows, best], 0.0)
    return weights
