"""Which corners of the body or of a solid come near along a motion, and along which axis.

The axis that separates two convex shapes is the normal of an edge of one of them, or joins two
corners. An edge's normal turns with the shape it belongs to; the corners of the other shape that
are nearest along it are the ones to watch (separating axis theorem).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from dataclasses import fields as fields_of
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from narrows.se2 import Array, rotate, transform
from narrows.vehicle import Vehicle
from narrows.world import ConvexPieces, World

from .body_distance import BodyDistance
from .contact_finding import (
    FINER,
    HORIZON,
    Contacts,
    Motion,
    Samples,
    contacts_along,
    samples_along,
)

__all__ = ["HORIZON", "Rows", "fine_samples", "rows_along"]

Finder = Callable[[BodyDistance, Any, Samples, float], Contacts | None]

_NEAR = 0.10  # m: bounds nearer than this are watched
_SECOND = 0.12  # m: a second corner this much further along the axis is watched too


@dataclass(frozen=True, eq=False)
class Rows:
    """Corners to keep clear, each against one axis at one parameter of a section.

    Attributes:
        parameter: Where along the section, shape (N,), in [0, 1].
        fields: axis (2), corner (2), support, in_world, required, share; shape (N, 8). See
            `narrows.planners.body_program.ROW_FIELDS`.
        gap: Clearance along the axis there [m], shape (N,).
        between_corners: Distance of two corners that face each other, else infinite, (N,), [m].
        is_least: Whether the clearance is least here along the motion, shape (N,).
    """

    parameter: Array
    fields: Array
    gap: Array
    between_corners: Array
    is_least: NDArray[np.bool_]

    @classmethod
    def joined(cls, sets: list[Rows]) -> Rows:
        """Return the rows of several sets as one."""
        return cls(
            *(np.concatenate([getattr(s, name.name) for s in sets]) for name in fields_of(cls))
        )

    def take(self, rows: NDArray[np.int64]) -> Rows:
        """Return some of the rows."""
        return Rows(*(getattr(self, name.name)[rows] for name in fields_of(self)))

    def nearest(self, count: int) -> Rows:
        """Return the `count` rows with the least to spare, in the motion's order."""
        spare = self.gap - self.fields[:, 6]
        chosen = np.sort(np.argsort(spare, kind="stable")[:count])
        return self.take(chosen)


def rows_along(
    world: World,
    vehicle: Vehicle,
    motion: Motion,
    margin: float,
    *,
    samples: int,
    along: Samples | None = None,
    finder: Finder = contacts_along,
) -> tuple[Rows, float]:
    """Return the rows that keep a body clear along a section, and its least clearance found.

    Args:
        world: Solids and bounds.
        vehicle: The body.
        motion: Poses (N, 3) at parameters (N,) in [0, 1], [m, m, rad].
        margin: Clearance required of solids [m]; bounds are required to hold without margin.
        samples: Coarse samples along the section, see `contact_finding`.
        along: The fine samples, `samples_along(motion, fine_samples(samples))`, if there already.
        finder: What looks for contacts, `contacts_along` or `compiled_contacts`.
    """
    if along is None:
        along = samples_along(motion, fine_samples(samples))
    sets, least = [_bound_rows(world, vehicle.outline, along)], np.inf
    for layer in vehicle.layers:
        pieces = world.pieces_between(*layer.z)
        if not len(pieces):
            continue
        body = BodyDistance.of(layer, pieces)
        contacts = finder(body, motion, along, margin)
        if contacts is not None:
            least = min(least, float(contacts.distance.min()))
            sets += _solid_rows(contacts, layer.polygon, pieces, margin)
    return Rows.joined(sets), least


def fine_samples(samples: int) -> Array:
    """Return the fine samples between so many coarse ones, in [0, 1]."""
    return np.linspace(0.0, 1.0, FINER * (samples - 1) + 1)


def _solid_rows(contacts: Contacts, body: Array, pieces: ConvexPieces, margin: float) -> list[Rows]:
    """Return one or two corners for each pair, against the axis that separates it."""
    return [
        _corners_of_body(contacts.take(contacts.in_world), body, pieces, margin),
        _corners_of_solid(contacts.take(~contacts.in_world), body, pieces, margin),
    ]


def _corners_of_body(contacts: Contacts, body: Array, pieces: ConvexPieces, margin: float) -> Rows:
    """Return rows of the body's corners against axes that stay with the solids."""
    axis, solid = contacts.axis, pieces.corners[contacts.piece]
    corners = transform(contacts.pose, body)  # (N, A, 2)
    along = corners[..., 0] * axis[:, :1] + corners[..., 1] * axis[:, 1:]
    far = (solid[..., 0] * axis[:, :1] + solid[..., 1] * axis[:, 1:]).min(axis=1)
    far = far - pieces.radius[contacts.piece]
    nearest = _two_nearest(far[:, None] - along)
    row, corner = nearest.row, nearest.corner
    return _rows(contacts, nearest, axis[row], body[corner], far[row], 1.0, margin)


def _corners_of_solid(contacts: Contacts, body: Array, pieces: ConvexPieces, margin: float) -> Rows:
    """Return rows of the solids' corners against axes that stay with the body."""
    axis, solid = contacts.axis, pieces.corners[contacts.piece]
    own_axis = rotate(-contacts.pose[:, 2], axis)
    repeated = np.zeros(solid.shape[:2], dtype=bool)
    repeated[:, 1:] = ~np.diff(solid, axis=1).any(axis=2)
    support = (own_axis @ body.T).max(axis=1) + pieces.radius[contacts.piece]
    away = solid - contacts.pose[:, None, :2]
    along = away[..., 0] * axis[:, :1] + away[..., 1] * axis[:, 1:]
    nearest = _two_nearest(np.where(repeated, np.inf, along - support[:, None]))
    row, corner = nearest.row, nearest.corner
    return _rows(contacts, nearest, own_axis[row], solid[row, corner], support[row], 0.0, margin)


class _Nearest(NamedTuple):
    """Corners chosen: of which contact (N,), which corner (N,), what it has to spare (N,) [m]."""

    row: NDArray[np.int64]
    corner: NDArray[np.int64]
    gap: Array
    is_first: NDArray[np.bool_]


def _two_nearest(spare: Array) -> _Nearest:
    """Return each contact's nearest corner, and a second one if near, of spares (M, K)."""
    order = np.argsort(spare, axis=1, kind="stable")[:, :2]
    gap = np.take_along_axis(spare, order, axis=1)
    row, which = np.nonzero(gap <= gap[:, :1] + _SECOND)
    return _Nearest(row, order[row, which], gap[row, which], which == 0)


def _rows(
    contacts: Contacts,
    nearest: _Nearest,
    axis: Array,
    corner: Array,
    support: Array,
    in_world: float,
    margin: float,
) -> Rows:
    row, is_first = nearest.row, nearest.is_first
    fields = np.empty((len(row), 8))
    fields[:, :2], fields[:, 2:4], fields[:, 4] = axis, corner, support
    fields[:, 5:] = in_world, margin, 1.0
    return Rows(
        contacts.parameter[row],
        fields,
        nearest.gap,
        np.where(is_first, contacts.between_corners[row], np.inf),
        is_first & contacts.is_least[row],
    )


def _bound_rows(world: World, body: Array, along: Samples) -> Rows:
    """Return rows that keep the body inside the bounds where it comes near them."""
    parameter, poses = along.parameter[::FINER], along.pose[::FINER]
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
    count = len(gaps)
    return Rows(
        np.array(which),
        np.array(fields).reshape(-1, 8),
        np.array(gaps),
        np.full(count, np.inf),
        np.zeros(count, dtype=bool),
    )
