"""Finding the corner or the door between start and goal in any walls, by edges and rays."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene import Scene
from ..se2 import Array, rotate, wrap
from .arc_path import CornerFrame
from .corridor_turn import Corner
from .door_arc import DoorTurn

MOST_PIECES = 120
"""Convex pieces of walls beyond which a scene is not looked at: neither quick nor a corner."""

_TURNS = (math.radians(4.9), math.radians(150.1))
_OFF_WALL = math.radians(40.0)  # between a pose's heading and the walls it drives along
_RIGHT = math.radians(0.6)  # of a door's turn from a right angle
_NEAR = 0.01  # m: from a corner, where its sides are probed
_FACE = 0.03  # m: before a wall's face, where the corridor goes on
_DEEP = 1.2  # m: thickness from which a wall is the side of another corridor
_STEP = 0.02  # m: rays through a door are that far apart
_BACK = (
    -0.01,
    -0.4,
    -0.8,
    -1.2,
    -1.6,
    -2.0,
    -2.4,
)  # m: before the corner, where the width is measured
_ASKEW = 0.01  # rad: between a wall and the leg it bounds
_FAR = 1e3  # m: nothing there


@dataclass(frozen=True, eq=False)
class FoundTurn:
    """A corner or door between start and goal.

    Attributes:
        frame: Where it is.
        shape: Widths and angle.
        start: Start in its frame.
        goal: Goal in its frame.
        opens: Whether the first leg's outer wall ends at the corner: seen from the goal it is a
            door or a side corridor.
    """

    frame: CornerFrame
    shape: Corner | DoorTurn
    start: tuple[float, float, float]
    goal: tuple[float, float, float]
    opens: bool

    @property
    def turn(self) -> float:
        """Angle turned [rad], positive."""
        return self.shape.turn if isinstance(self.shape, Corner) else 0.5 * math.pi


def find_turn(scene: Scene) -> FoundTurn | str:
    """Return the turn between start and goal, or why none is recognised.

    A known door between them gives the directions of both legs, else the walls nearest to start
    and goal and most nearly along their headings. Among the walls' corners between them the
    nearest is the inner one; rays across the legs give the widths. Where the first leg goes on
    behind the opening it is a door (or a side corridor): its thickness is that of the far jamb.
    Solids other than walls are not looked at.
    """
    pieces = scene.world.pieces_between(0.0, scene.vehicle.height)
    solid = pieces.radius == 0.0
    if not solid.any() or len(pieces) > MOST_PIECES:
        return "no arc: there are no walls to turn between, or too many to be one corner"
    polygons = pieces.corners[solid]
    begin, end = _edges(polygons)
    before, after = _leg_headings(scene, begin, end)
    if before is None or after is None:
        return "no arc: no wall runs along the heading of the start or of the goal"
    turn = float(wrap(after - before))
    if not _TURNS[0] <= abs(turn) <= _TURNS[1]:
        degrees = math.degrees(abs(turn))
        return (
            f"no arc: from start to goal the walls turn by {degrees:.0f} degrees, not by 5 to 150"
        )
    side = 1 if turn > 0.0 else -1
    return _turn_at(scene, polygons, (begin, end), before, side, abs(turn))


def _edges(polygons: Array) -> tuple[Array, Array]:
    """Return both ends of all edges that have a length, shapes (E, 2)."""
    begin = polygons.reshape(-1, 2)
    end = np.roll(polygons, -1, axis=1).reshape(-1, 2)
    kept = np.abs(end - begin).max(axis=1) > 1e-9
    return begin[kept], end[kept]


def _leg_headings(scene: Scene, begin: Array, end: Array) -> tuple[float | None, float | None]:
    """Return the headings along both legs: through a known door, else along walls."""
    start, goal = scene.start[:2], scene.goal.pose[:2]
    for door in scene.world.doors:
        (x0, y0), (x1, y1) = (
            rotate(-door.heading, p - np.array(door.center)) for p in (start, goal)
        )
        if x0 < 0.0 < x1 and abs(y0) > 0.5 * door.width and abs(y1) < 3.0 * door.width:
            return door.heading - math.copysign(0.5 * math.pi, y0), door.heading
        if x1 < 0.0 < x0 and abs(y1) > 0.5 * door.width and abs(y0) < 3.0 * door.width:
            back = door.heading + math.pi
            return back, door.heading + math.copysign(0.5 * math.pi, y1)
    pair = [_leg_heading(pose, begin, end) for pose in (scene.start, scene.goal.pose)]
    return pair[0], pair[1]


def _leg_heading(pose: Array, begin: Array, end: Array) -> float | None:
    """Return the heading nearest to a pose's along a wall near to it, or None.

    A radian off weighs as much as ten metres away.
    """
    edge = end - begin
    length = np.hypot(edge[:, 0], edge[:, 1])
    angle = np.arctan2(edge[:, 1], edge[:, 0])
    off = np.mod(angle - pose[2] + 0.5 * math.pi, math.pi) - 0.5 * math.pi
    share = np.clip(np.einsum("ed,ed->e", pose[:2] - begin, edge) / length**2, 0.0, 1.0)
    gap = np.hypot(*(begin + share[:, None] * edge - pose[:2]).T)
    score = np.where((np.abs(off) < _OFF_WALL) & (length > 0.3), np.abs(off) + 0.1 * gap, np.inf)
    best = int(score.argmin())
    return None if np.isinf(score[best]) else float(pose[2] + off[best])


def _turn_at(
    scene: Scene,
    polygons: Array,
    edges: tuple[Array, Array],
    heading: float,
    side: int,
    turn: float,
) -> FoundTurn | str:
    """Return the turn at the nearest inner corner, for legs of known directions."""
    mirror = np.array([1.0, float(side)])

    def framed(points: Array) -> Array:
        return np.asarray(rotate(-heading, points) * mirror)

    walls = framed(polygons)
    walls = walls if side > 0 else walls[:, ::-1]
    start, goal = framed(scene.start[:2]), framed(scene.goal.pose[:2])
    corner = _inner_corner(walls, start, goal, turn)
    if corner is None:
        return "no arc: no corner of a wall lies between start and goal on the inside of the turn"
    rays = _Rays(framed(edges[0]), framed(edges[1]))
    shape = _shape(rays, corner, turn)
    if isinstance(shape, str):
        return shape
    width = shape.before if isinstance(shape, Corner) else shape.corridor
    beside = corner + np.array([_FACE, -_NEAR])
    opens = float(rays.cast(beside, np.array([0.0, -1.0]))[0]) + _NEAR > width + 0.05
    origin = rotate(heading, corner * mirror)
    frame = CornerFrame(origin, heading, side)
    start_pose, goal_pose = (frame.pose_in_frame(p) for p in (scene.start, scene.goal.pose))
    return FoundTurn(frame, shape, start_pose, goal_pose, opens)


def _inner_corner(walls: Array, start: Array, goal: Array, turn: float) -> Array | None:
    """Return the convex corner of the walls, of the turn's angle, nearest to both lines, or None.

    Args:
        walls: Counter-clockwise convex pieces in the frame of the first leg, shape (P, K, 2).
        start: Point, shape (2,).
        goal: Point, shape (2,).
        turn: Angle [rad].
    """
    points = np.unique(walls.reshape(-1, 2).round(7), axis=0)
    along, right = np.array([math.cos(turn), math.sin(turn)]), [math.sin(turn), -math.cos(turn)]
    off = points[:, 1] - start[1]
    off_goal = (goal - points) @ right
    ahead = (goal - points) @ along
    fits = (off > 0.0) & (off_goal > 0.0) & (ahead > 0.0) & (points[:, 0] > start[0] - 0.3)
    order = np.argsort((off + off_goal)[fits])[:12]
    chosen = points[fits][order]
    if not len(chosen):
        return None
    angles = np.array([turn + 0.15, 0.5 * (turn + math.pi), math.pi - 0.15])
    free = np.array([math.pi + 0.15, 1.5 * math.pi + 0.5 * turn, 2.0 * math.pi + turn - 0.15])
    ring = np.concatenate([angles, free])
    around = _NEAR * np.stack([np.cos(ring), np.sin(ring)], axis=-1)
    inside = _inside(walls, chosen[:, None] + around)
    found = np.flatnonzero((inside == [True, True, True, False, False, False]).all(axis=1))
    return chosen[found[0]] if len(found) else None


def _inside(walls: Array, points: Array) -> NDArray[np.bool_]:
    """Return which points (..., 2) lie in one of the convex pieces."""
    edge = np.roll(walls, -1, axis=1) - walls  # (P, K, 2)
    rel = points[..., None, None, :] - walls
    cross = edge[..., 0] * rel[..., 1] - edge[..., 1] * rel[..., 0]
    return np.asarray((cross >= 0.0).all(axis=-1).any(axis=-1))


@dataclass(frozen=True, eq=False)
class _Rays:
    """Edges to cast rays at, both ends, shapes (E, 2)."""

    begin: Array
    end: Array

    def across(self, direction: Array) -> _Rays:
        """Return the edges at right angles to a direction: the walls along a leg."""
        edge = self.end - self.begin
        off = np.abs(edge @ direction) / np.hypot(edge[:, 0], edge[:, 1])
        return _Rays(self.begin[off < _ASKEW], self.end[off < _ASKEW])

    def cast(self, origin: Array, direction: Array) -> Array:
        """Return the distance to the first edge from origins (N, 2), shape (N,)."""
        if not len(self.begin):
            return np.full(len(np.atleast_2d(origin)), _FAR)
        edge = self.end - self.begin
        rel = self.begin - np.atleast_2d(origin)[:, None]
        across = direction[0] * edge[:, 1] - direction[1] * edge[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            ray = (rel[..., 0] * edge[:, 1] - rel[..., 1] * edge[:, 0]) / across
            share = (rel[..., 0] * direction[1] - rel[..., 1] * direction[0]) / across
        hit = (np.abs(across) > 1e-12) & (share >= 0.0) & (share <= 1.0) & (ray > 1e-6)
        return np.asarray(np.where(hit, ray, _FAR).min(axis=1))


def _shape(rays: _Rays, corner: Array, turn: float) -> Corner | DoorTurn | str:
    """Return widths, and thickness of a door, from rays across the legs.

    The median of several rays is a leg's width: niches and what stands at the wall do not count,
    the certificate sees them.
    """
    right = np.array([math.sin(turn), -math.cos(turn)])
    along = np.array([math.cos(turn), math.sin(turn)])
    back = np.column_stack([_BACK, np.full(len(_BACK), -_NEAR)])
    down = np.array([0.0, -1.0])
    before = _median(rays.across(down).cast(corner + back, down)) + _NEAR
    depth = np.arange(_STEP / 2.0, _DEEP, _STEP)
    deeper = np.concatenate([depth, _DEEP - np.array(_BACK)])
    walls = rays.across(right)
    across = walls.cast(corner + deeper[:, None] * along + _NEAR * right, right) + _NEAR
    width = float(across[0])
    if before >= _FAR or _median(across) >= _FAR:
        return "no arc: there is no wall across from the inner corner to turn along"
    beside = corner - _FACE * along + _NEAR * right
    goes_on = float(rays.cast(beside, right)[0]) + _NEAR > width + 0.05
    if goes_on and abs(turn - 0.5 * math.pi) < _RIGHT:
        jamb = across[: len(depth)] < width + 0.05
        deep = len(jamb) if jamb.all() else int(jamb.argmin())
        thickness = _FAR if deep == len(jamb) else float(depth[deep] - _STEP / 2.0)
        return DoorTurn(before, float(across[:deep].min()), thickness)
    return Corner(before, _median(across), turn)


def _median(values: Array) -> float:
    """Return the median of the finite distances, or that of nothing there."""
    known = np.sort(values[values < _FAR])
    return float(known[len(known) // 2]) if len(known) else _FAR
