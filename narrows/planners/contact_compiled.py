"""`contacts_along` through the compiled loops; imports numba, so only where many are asked for."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from narrows.geometry import edge_normals
from narrows.se2 import Array

from .body_distance import BodyDistance
from .contact_finding import FINER, HORIZON, WATCH, Contacts, Samples
from .contact_kernel import CORNERS, FOUND, SOLID_EDGE, Course, Watch, contacts
from .planning_clock import clock
from .section_motion import SectionMotion

_ROOM = 4000  # contacts at most


class _Packed(NamedTuple):
    """A body and pieces as the loops want them, see `contact_kernel.contacts`."""

    body: Array
    pieces: Array
    sides: NDArray[np.int64]
    boxes: Array
    found: Array
    of_piece: NDArray[np.int64]


@lru_cache(maxsize=64)
def _packed(body: BodyDistance) -> _Packed:
    pieces = body.pieces
    different = np.ones(pieces.corners.shape[:2], dtype=bool)
    different[:, 1:] = np.diff(pieces.corners, axis=1).any(axis=2)
    return _Packed(
        np.ascontiguousarray(np.concatenate([body.body, edge_normals(body.body)], axis=1)),
        np.ascontiguousarray(np.concatenate([pieces.corners, body.normals], axis=2)),
        different.sum(axis=1),
        np.hstack([pieces.low, pieces.high]),
        np.empty((_ROOM, FOUND)),
        np.empty(_ROOM, dtype=np.int64),
    )


def compiled_contacts(
    body: BodyDistance, motion: SectionMotion, samples: Samples, required: float
) -> Contacts | None:
    """Return what `contacts_along` does, the least distances narrowed down further."""
    packed, pieces = _packed(body), body.pieces
    places = samples.pose[:, :2]
    chosen = pieces.near(places.min(axis=0), places.max(axis=0), body.radius + HORIZON)
    with clock.loading_of(contacts):
        count = contacts(
            Course(motion.powers, float(motion.direction), len(samples.parameter), FINER),
            Watch(HORIZON, WATCH.near, required + WATCH.close, WATCH.stride, WATCH.close_stride),
            packed.body,
            body.radius,
            packed.pieces,
            packed.sides,
            pieces.radius,
            packed.boxes,
            chosen,
            packed.found,
            packed.of_piece,
        )
    if not count:
        return None
    found, piece = packed.found[:count].copy(), packed.of_piece[:count].copy()
    kind = found[:, 7]
    between = np.where(kind == CORNERS, found[:, 4] + pieces.radius[piece], np.inf)
    return Contacts(
        found[:, 0],
        found[:, 1:4],
        piece,
        found[:, 4],
        found[:, 5:7],
        kind >= SOLID_EDGE,
        between,
        found[:, 8] == 1.0,
    )
