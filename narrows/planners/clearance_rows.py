"""Which corners of the body or of a solid come near along a motion, and along which axis.

The axis that separates two convex shapes is the normal of an edge of one of them, or joins two
corners. An edge's normal turns with the shape it belongs to; the corners of the other shape that
are nearest along it are the ones to watch (separating axis theorem).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from narrows.geometry import separation
from narrows.se2 import Array, rotate, transform
from narrows.vehicle import Vehicle
from narrows.world import ConvexPieces, World

HORIZON = 0.25
"""Distance beyond which a solid is not watched [m]; a solve moves the curve by less."""

_NEAR = 0.10  # m: nearer than this it is watched along the way, not only where it is least
_STRIDE = 0.025  # m between places watched along the way
_ALIGNED = 1e-6  # sine of the angle below which an axis is an edge's normal
_SECOND = 0.12  # m: a second corner this much further along the axis is watched too


@dataclass(frozen=True, eq=False)
class Rows:
    """Corners to keep clear, each against one axis at one parameter of a section.

    Attributes:
        parameter: Where along the section, shape (N,), in [0, 1].
        fields: axis (2), corner (2), support, in_world, required, share; shape (N, 8). See
            `narrows.planners.body_program.ROW_FIELDS`.
        gap: Clearance along the axis there [m], shape (N,).
    """

    parameter: Array
    fields: Array
    gap: Array

    @classmethod
    def joined(cls, sets: list[Rows]) -> Rows:
        """Return the rows of several sets as one."""
        return cls(
            np.concatenate([s.parameter for s in sets]),
            np.concatenate([s.fields for s in sets]),
            np.concatenate([s.gap for s in sets]),
        )

    def nearest(self, count: int) -> Rows:
        """Return the `count` rows with the least to spare, in the motion's order."""
        spare = self.gap - self.fields[:, 6]
        chosen = np.sort(np.argsort(spare, kind="stable")[:count])
        return Rows(self.parameter[chosen], self.fields[chosen], self.gap[chosen])


@dataclass(frozen=True, eq=False)
class _Contacts:
    """Pairs of a parameter and a piece: the pose there, distance, axis from body to solid."""

    parameter: Array
    pose: Array
    piece: NDArray[np.int64]
    distance: Array
    axis: Array

    def take(self, rows: NDArray[np.int64] | NDArray[np.bool_]) -> _Contacts:
        """Return some of the pairs."""
        return _Contacts(
            self.parameter[rows],
            self.pose[rows],
            self.piece[rows],
            self.distance[rows],
            self.axis[rows],
        )

    def and_also(self, other: _Contacts) -> _Contacts:
        """Return the pairs of both."""
        return _Contacts(
            np.concatenate([self.parameter, other.parameter]),
            np.concatenate([self.pose, other.pose]),
            np.concatenate([self.piece, other.piece]),
            np.concatenate([self.distance, other.distance]),
            np.concatenate([self.axis, other.axis]),
        )


def rows_along(
    world: World,
    vehicle: Vehicle,
    motion: Callable[[Array], Array],
    margin: float,
    *,
    samples: int,
) -> tuple[Rows, float]:
    """Return the rows that keep a body clear along a section, and its least clearance found.

    Args:
        world: Solids and bounds.
        vehicle: The body.
        motion: Poses (N, 3) at parameters (N,) in [0, 1], [m, m, rad].
        margin: Clearance required of solids [m]; bounds are required to hold without margin.
        samples: First samples along the section; least distances are then narrowed down between
            them to a twentieth of their spacing.
    """
    parameter = np.linspace(0.0, 1.0, samples)
    poses = motion(parameter)
    step = np.linalg.norm(np.diff(poses[:, :2], axis=0), axis=1)
    travelled = np.concatenate([[0.0], np.cumsum(step)])
    sets, least = [_bound_rows(world, vehicle.outline, parameter, poses)], np.inf
    for layer in vehicle.layers:
        pieces = world.pieces_between(*layer.z)
        if not len(pieces):
            continue
        contacts, sample = _contacts(parameter, poses, layer.polygon, pieces)
        if not len(sample):
            continue
        minimum, along = _watched(contacts, sample, travelled)
        lowest = _narrowed(contacts.take(minimum), motion, layer.polygon, pieces, samples)
        least = min(least, float(lowest.distance.min()))
        watched = lowest.and_also(contacts.take(along))
        sets.append(_solid_rows(watched, layer.polygon, pieces, margin))
    return Rows.joined(sets), least


def _contacts(
    parameter: Array, poses: Array, body: Array, pieces: ConvexPieces
) -> tuple[_Contacts, NDArray[np.int64]]:
    """Return the pairs within the horizon with their signed distances, and their samples."""
    reach = float(np.linalg.norm(body, axis=1).max()) + HORIZON
    away = np.maximum(pieces.low - poses[:, None, :2], poses[:, None, :2] - pieces.high)
    away = np.maximum(away, 0.0)
    sample, piece = np.nonzero(np.hypot(away[..., 0], away[..., 1]) < reach)
    distance, axis = _distance(poses[sample], body, pieces, piece)
    near = distance < HORIZON
    sample, piece = sample[near], piece[near]
    return (
        _Contacts(parameter[sample], poses[sample], piece, distance[near], axis[near]),
        sample,
    )


def _distance(
    poses: Array, body: Array, pieces: ConvexPieces, piece: NDArray[np.int64]
) -> tuple[Array, Array]:
    """Return signed distances and axes of pairs of pose and piece."""
    distance, axis = separation(transform(poses, body), pieces.corners[piece])
    return distance - pieces.radius[piece], axis


def _watched(
    contacts: _Contacts, sample: NDArray[np.int64], travelled: Array
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return each piece's local minima along the samples, and places along what is near."""
    minima: list[int] = []
    along: list[int] = []
    for piece in np.unique(contacts.piece):
        rows = np.flatnonzero(contacts.piece == piece)
        distance, index = contacts.distance[rows], sample[rows]
        before = np.where(np.diff(index, prepend=-2) == 1, np.roll(distance, 1), np.inf)
        after = np.where(np.diff(index, append=-2) == 1, np.roll(distance, -1), np.inf)
        minimum = (distance <= before) & (distance < after)
        minima += rows[minimum].tolist()
        last = -np.inf
        for k in np.flatnonzero(~minimum & (distance < _NEAR)):
            here = float(travelled[index[k]])
            if here - last >= _STRIDE:
                along.append(int(rows[k]))
                last = here
    return np.array(minima, dtype=np.int64), np.array(along, dtype=np.int64)


def _narrowed(
    contacts: _Contacts,
    motion: Callable[[Array], Array],
    body: Array,
    pieces: ConvexPieces,
    samples: int,
) -> _Contacts:
    """Return local minima moved to the least distance between their neighbouring samples."""
    best, width = contacts, 1.0 / (samples - 1)
    offsets = np.array([-4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0]) / 4.5
    for _ in range(2):
        tried = np.clip(best.parameter[:, None] + width * offsets, 0.0, 1.0).ravel()
        pose, piece = motion(tried), np.repeat(best.piece, len(offsets))
        distance, axis = _distance(pose, body, pieces, piece)
        least = distance.reshape(-1, len(offsets)).argmin(axis=1)
        rows = np.arange(len(best.piece)) * len(offsets) + least
        better = distance[rows] < best.distance
        best = _Contacts(
            np.where(better, tried[rows], best.parameter),
            np.where(better[:, None], pose[rows], best.pose),
            best.piece,
            np.where(better, distance[rows], best.distance),
            np.where(better[:, None], axis[rows], best.axis),
        )
        width /= 4.5
    return best


def _solid_rows(contacts: _Contacts, body: Array, pieces: ConvexPieces, margin: float) -> Rows:
    """Return one or two corners for each pair, against the axis that separates it."""
    axis, heading = contacts.axis, contacts.pose[:, 2]
    solid, radius = pieces.corners[contacts.piece], pieces.radius[contacts.piece]
    corners = transform(contacts.pose, body)  # (N, K, 2)
    own_axis = rotate(-heading, axis)
    in_world = ~_is_edge_normal(np.broadcast_to(body, corners.shape), own_axis)
    in_world |= _is_edge_normal(solid, -axis)
    along_body = np.einsum("nkd,nd->nk", corners, axis)
    along_solid = np.einsum("nkd,nd->nk", solid, axis)
    repeated = np.zeros(along_solid.shape, dtype=bool)
    repeated[:, 1:] = ~np.diff(solid, axis=1).any(axis=2)
    near, far = along_body.max(axis=1), along_solid.min(axis=1) - radius
    body_support = np.einsum("kd,nd->nk", body, own_axis).max(axis=1) + radius
    sets = []
    for chosen, direction, support, points, spare in (
        (in_world, axis, far, np.broadcast_to(body, corners.shape), far[:, None] - along_body),
        (
            ~in_world,
            own_axis,
            body_support,
            solid,
            np.where(repeated, np.inf, along_solid - (near + radius)[:, None]),
        ),
    ):
        pair = np.flatnonzero(chosen)
        order = np.argsort(spare[pair], axis=1, kind="stable")[:, :2]
        gap = np.take_along_axis(spare[pair], order, axis=1)
        row, which = np.nonzero(gap <= gap[:, :1] + _SECOND)
        pair, corner = pair[row], order[row, which]
        kind = np.full(len(pair), 1.0 if chosen is in_world else 0.0)
        fields = np.column_stack(
            [
                direction[pair],
                points[pair, corner],
                support[pair],
                kind,
                np.full(len(pair), margin),
                np.ones(len(pair)),
            ]
        )
        sets.append(Rows(contacts.parameter[pair], fields, gap[row, which]))
    return Rows.joined(sets)


def _is_edge_normal(polygons: Array, axis: Array) -> NDArray[np.bool_]:
    """Return whether each axis (N, 2) is the outward normal of an edge of its polygon (N, K, 2)."""
    edge = np.roll(polygons, -1, axis=1) - polygons
    length = np.linalg.norm(edge, axis=2)
    along = np.abs(np.einsum("nkd,nd->nk", edge, axis))
    outward = edge[..., 1] * axis[:, None, 0] - edge[..., 0] * axis[:, None, 1]
    return np.asarray(((along <= _ALIGNED * length) & (outward > 0.0) & (length > 0.0)).any(axis=1))


def _bound_rows(world: World, body: Array, parameter: Array, poses: Array) -> Rows:
    """Return rows that keep the body inside the bounds where it comes near them."""
    fields, which, gaps = [], [], []
    if world.bounds is not None:
        normals = np.array([[-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
        offsets = np.array([-world.bounds[0], -world.bounds[1], world.bounds[2], world.bounds[3]])
        reach = transform(poses, body) @ normals.T  # (N, K, 4)
        gap = offsets - reach.max(axis=1)  # (N, 4)
        for side in np.flatnonzero(gap.min(axis=0) < _NEAR):
            for sample in np.unique([int(gap[:, side].argmin()), 0, len(poses) - 1]):
                corner = int(reach[sample, :, side].argmax())
                fields.append([*normals[side], *body[corner], offsets[side], 1.0, 0.0, 1.0])
                which.append(float(parameter[sample]))
                gaps.append(float(gap[sample, side]))
    return Rows(np.array(which), np.array(fields).reshape(-1, 8), np.array(gaps))
