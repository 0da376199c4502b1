"""Where a body on a curve is near the solids, as rows for an optimiser.

For convex body and convex solid the gap along any unit axis is a lower bound of their distance
(separating axis theorem), and the axis of `geometry.separation` attains it. A slot freezes what
the optimiser may not choose: the curve parameter, the axis (fixed in the world if it is an edge
normal of the solid or joins two corners, turning with the body if it is an edge normal of the
body) and the two critical corners on either side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import bezier
from ..geometry import edge_normals, separation
from ..se2 import Array, rotate, transform
from ..vehicle import Vehicle
from ..world import World
from .smoothness import bernstein

SLOTS = 40
SLOT_SIZE = 29  # weights of point and tangent (8 + 8), axis (2 + 2), corners (4 + 4), radius (1)
SAMPLES = 32  # on each segment
FINER = (-0.75, -0.5, -0.25, 0.25, 0.5, 0.75)  # of a sample's step, about the nearest
NEAR = 0.25  # [m]; pairs further apart than this beyond the margin get no slot


@dataclass(frozen=True, eq=False)
class Contacts:
    """Slots for the optimiser, and the nearest of the samples they were picked from.

    Attributes:
        slots: Parameters, shape (SLOTS * SLOT_SIZE,).
        active: Which rows count, shape (2 * SLOTS,).
        clearance: Least distance over all samples [m]; infinite if nothing is there.
        at: x and y of the body origin there [m].
        solid: Index of the solid there in `World.solids`, or -1.
    """

    slots: Array
    active: NDArray[np.bool_]
    clearance: float
    at: tuple[float, float]
    solid: int


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Pairs of a place on the curve and a convex piece, in rows."""

    place: Array  # (N,) segment + parameter
    pose: Array  # (N, 3)
    distance: Array  # (N,)
    slot: Array  # (N, SLOT_SIZE)
    owner: NDArray[np.int64]  # (N,)
    group: NDArray[np.int64]  # (N,) one number for each layer and piece

    @classmethod
    def joined(cls, parts: list[_Pairs]) -> _Pairs:
        """Return all rows of the parts."""
        names = ("place", "pose", "distance", "slot", "owner", "group")
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def curve_poses(control: Array, samples: int) -> Array:
    """Return poses along composite curves at even parameters, shape (K * samples, 3)."""
    parameter = np.linspace(0.0, 1.0, samples)
    points = bezier.evaluate(control[:, None], parameter)
    tangent = bezier.evaluate(control[:, None], parameter, 1)
    heading = np.arctan2(tangent[..., 1], tangent[..., 0])
    return np.concatenate([points, heading[..., None]], axis=-1).reshape(-1, 3)


def _weights(place: Array) -> Array:
    """Return the weights of point and tangent on the 8 control points of both segments.

    Args:
        place: Segment + parameter, in [0, 2], shape (N,).

    Returns:
        Shape (N, 16).
    """
    second = place > 1.0
    parameter = place - second
    rows = np.zeros((len(place), 2, 2, 4))
    for order in range(2):
        rows[np.arange(len(place)), order, second.astype(int)] = bernstein(parameter, order)
    return rows.reshape(len(place), -1)


def find_contacts(world: World, vehicle: Vehicle, control: Array, margin: float) -> Contacts:
    """Return the slots of the pairs of pose and solid that are nearest.

    Even samples first, then finer ones about the nearest sample of each near piece.

    Args:
        world: Solids.
        vehicle: Body.
        control: Control points of two segments, shape (2, 4, 2), [m].
        margin: Clearance asked for [m].
    """
    even = np.linspace(0.0, 2.0, 2 * SAMPLES + 1)
    pairs = _near_pairs(world, vehicle, control, even, margin + NEAR)
    slots = np.zeros((SLOTS, SLOT_SIZE))
    slots[:, :16] = _weights(np.zeros(1))[0]  # an unused slot needs a tangent, too
    active = np.zeros(2 * SLOTS, dtype=bool)
    if not len(pairs.distance):
        x, y = (float(v) for v in control[0, 0])
        return Contacts(slots.ravel(), active, np.inf, (x, y), -1)
    for step in (1.0 / SAMPLES, 0.25 / SAMPLES):
        finer = _finer_places(pairs, margin, step)
        if len(finer):
            more = _near_pairs(world, vehicle, control, finer, margin + NEAR)
            pairs = _Pairs.joined([pairs, more])
    chosen = _spread(pairs)[:SLOTS]
    slots[: len(chosen)] = pairs.slot[chosen]
    active[: 2 * len(chosen)] = True
    nearest = int(pairs.distance.argmin())
    return Contacts(
        slots.ravel(),
        active,
        float(pairs.distance[nearest]),
        (float(pairs.pose[nearest, 0]), float(pairs.pose[nearest, 1])),
        int(pairs.owner[nearest]),
    )


def _finer_places(pairs: _Pairs, margin: float, step: float) -> Array:
    """Return places about the nearest sample of every piece that is nearly too near."""
    tight = pairs.distance < margin + 0.05
    found: list[float] = []
    for group in np.unique(pairs.group[tight]):
        rows = np.flatnonzero(pairs.group == group)
        nearest = pairs.place[rows[pairs.distance[rows].argmin()]]
        found += [float(nearest + step * part) for part in FINER]
    places = np.unique(np.array(found))
    return places[(places > 0.0) & (places < 2.0)]


def _spread(pairs: _Pairs) -> NDArray[np.int64]:
    """Return the order in which pairs get slots: near ones first, neighbours in time later.

    A pair is worth its distance plus a fine for each nearer pair of the same piece beside it.
    """
    order = np.argsort(pairs.distance)
    place, group = pairs.place[order], pairs.group[order]
    beside = np.abs(place[:, None] - place) < 1.5 / SAMPLES
    crowded = np.tril(beside & (group[:, None] == group), -1).sum(axis=1)
    worth = pairs.distance[order] + 0.02 * crowded
    return np.asarray(order[np.argsort(worth, kind="stable")])


def _near_pairs(
    world: World, vehicle: Vehicle, control: Array, place: Array, reach: float
) -> _Pairs:
    """Return the pairs at places on the curve that are nearer than the reach."""
    second = (place > 1.0).astype(int)
    points, tangent = (
        bezier.evaluate(control[second], place - second, order) for order in range(2)
    )
    poses = np.column_stack([points, np.arctan2(tangent[:, 1], tangent[:, 0])])
    found: list[_Pairs] = []
    groups = 0
    for layer in vehicle.layers:
        pieces = world.pieces_between(*layer.z)
        if not len(pieces):
            continue
        body = transform(poses, layer.polygon)  # (N, K, 2)
        radius = float(np.linalg.norm(layer.polygon, axis=1).max())
        beside = np.maximum(pieces.low - poses[:, None, :2], poses[:, None, :2] - pieces.high)
        apart = np.linalg.norm(np.maximum(beside, 0.0), axis=2)  # to the pieces' boxes, (N, P)
        row, piece = np.nonzero(apart < radius + reach)
        result = separation(body[row], pieces.corners[piece])
        distance = result.distance - pieces.radius[piece]
        near = np.flatnonzero(distance < reach)
        row, piece = row[near], piece[near]
        slot = _slots(
            layer.polygon, poses[row], body[row], pieces.corners[piece], result.axis[near]
        )
        slot[:, :16] = _weights(place[row])
        slot[:, 28] = pieces.radius[piece]
        owner = pieces.owner[piece]
        found.append(_Pairs(place[row], poses[row], distance[near], slot, owner, groups + piece))
        groups += len(pieces)
    if not found:
        none = np.zeros(0, dtype=np.int64)
        return _Pairs(
            np.zeros(0), np.zeros((0, 3)), np.zeros(0), np.zeros((0, SLOT_SIZE)), none, none
        )
    return _Pairs.joined(found)


def _slots(polygon: Array, poses: Array, body: Array, solid: Array, axis: Array) -> Array:
    """Return axis and critical corners of each pair, shape (N, SLOT_SIZE).

    Args:
        polygon: Body corners in the body frame, shape (K, 2).
        poses: Shape (N, 3).
        body: Body corners in the world, shape (N, K, 2).
        solid: Solid's corners, shape (N, M, 2).
        axis: Unit vectors from body to solid, shape (N, 2).
    """
    rows = np.arange(len(poses))
    slot = np.zeros((len(poses), SLOT_SIZE))
    axis_body = rotate(-poses[:, 2], axis)
    turning = (axis_body @ edge_normals(polygon).T).max(axis=1) > 1.0 - 1e-9
    slot[:, 16:18] = np.where(turning[:, None], 0.0, axis)
    slot[:, 18:20] = np.where(turning[:, None], axis_body, 0.0)
    corners = np.argsort(-np.einsum("nkd,nd->nk", body, axis), axis=1)[:, :2]
    along = np.einsum("nmd,nd->nm", solid, axis)
    # Pieces with fewer corners repeat their last: a repeated corner must not take both places.
    repeated = np.zeros(along.shape, dtype=bool)
    repeated[:, 1:] = (solid[:, 1:] == solid[:, :-1]).all(axis=2)
    vertices = np.argsort(np.where(repeated, np.inf, along), axis=1)
    first, second = vertices[:, 0], vertices[:, min(1, solid.shape[1] - 1)]
    second = np.where(repeated[rows, second], first, second)
    slot[:, 20:22], slot[:, 22:24] = polygon[corners[:, 0]], polygon[corners[:, 1]]
    slot[:, 24:26], slot[:, 26:28] = solid[rows, first], solid[rows, second]
    # An axis of the body's edge has one critical line of the body; one of the solid's edge, one
    # of the solid: the other side brings its two corners.
    slot[:, 22:24] = np.where(turning[:, None], slot[:, 20:22], slot[:, 22:24])
    slot[:, 26:28] = np.where(turning[:, None], slot[:, 26:28], slot[:, 24:26])
    return slot
