"""Where an opening in a wall ends: at the wall, at its reveal, or at a leaf that meets it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .ranges import Beam
from .walls import SortedScan, Wall, WallOptions

_NEIGHBOUR = 0.6  # m: wall beside an opening within this is its side
_CORNER = 0.05  # m: an edge lies that far inside the last beam that passes, at most
_LEAF = 1.0  # m: length of a door leaf
_BEGIN = 0.25  # m: a face begins that near to the wall's plane
_THICKEST = 0.45  # m: wall
_SLANT = math.radians(20.0)  # between what stands across a wall and what slants to it
_GAP = 0.2  # m: what is further apart is not one side
_ROUND = 0.01  # m: returns of a corner seen from the side lie within this across
_STRIP = 0.03  # m: returns of a reveal or a leaf lie within this across


@dataclass(frozen=True, eq=False)
class Crossing:
    """Where the beams of a scan meet a wall's plane.

    Attributes:
        along: Where a beam crosses the plane, shape (N,), [m]; NaN where it does not.
        depth: How far behind the plane its return lies, shape (N,), [m]; infinite: clear, NaN: no
            answer.
        place: Where its return lies along the wall, shape (N,), [m].
        foot: Distance of the sensor from the plane [m].
    """

    along: Array
    depth: Array
    place: Array
    foot: float


def crossing_of(scan: SortedScan, wall: Wall) -> Crossing:
    """Return where the beams of a scan meet a wall's plane."""
    facing = scan.directions @ wall.normal
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.where(facing > 0.03, wall.distance / facing, np.nan)
        along = reach * (scan.directions @ wall.tangent)
    returned = scan.beams == Beam.RETURN
    depth = np.where(returned, scan.ranges * facing - wall.distance, np.nan)
    depth[scan.beams == Beam.CLEAR] = np.inf
    place = np.where(returned, scan.ranges * (scan.directions @ wall.tangent), np.nan)
    return Crossing(along, depth, place, wall.distance)


def passages(passing: NDArray[np.bool_], silent: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return first and last beam of each run that passes, up to two silent ones bridged."""
    beams = np.flatnonzero(passing)
    if len(beams) < 3:
        return []
    breaks = np.flatnonzero(np.diff(beams) > 1)
    ends = [-1]
    for k in breaks.tolist():
        between = silent[beams[k] + 1 : beams[k + 1]]
        if len(between) > 2 or not between.all():
            ends.append(k)
    ends.append(len(beams) - 1)
    return [
        (int(beams[before + 1]), int(beams[last]))
        for before, last in pairwise(ends)
        if last - before >= 3
    ]


@dataclass(frozen=True)
class Edge:
    """One side of an opening: place along the wall, its error, depth of its face [m]."""

    place: float
    error: float
    depth: float


def edge_of(
    cross: Crossing, beam: int, side: int, *, widest: float, walls: WallOptions
) -> Edge | None:
    """Return the edge beside the outermost beam that passes; None if nothing marks it.

    Where returns lie on a face that leads away from the wall, of the jamb or of a leaf: that face.
    Where a jamb is seen from the side and its innermost returns lie behind the plane: those.
    Else the middle between the last beam that passes and the innermost return of the wall.
    """
    inward = side * (cross.along[beam] - cross.place)  # how far inside that beam a return lies
    near = (inward < _CORNER) & (inward > -widest) & (np.abs(cross.depth) < _LEAF)
    seeds = inward[near & (np.abs(cross.depth) < _BEGIN)]
    if not len(seeds) or not _is_next(cross, beam, side):
        return None
    innermost = float(seeds.max())
    within = near & (inward <= innermost)
    face, corner = (within & (inward >= innermost - width) for width in (_STRIP, _ROUND))
    depth = max(float(cross.depth[face].max()), 0.0)
    error = walls.error
    away = face & (np.abs(cross.depth) > walls.tolerance)
    if away.any() and np.count_nonzero(face) >= 3 and float(cross.depth[face].std()) > 2.0 * error:
        count, place = int(np.count_nonzero(away)), float(np.median(cross.place[away]))
        return Edge(place, error / math.sqrt(count), depth)
    count = int(np.count_nonzero(corner))
    behind = float(cross.depth[corner].mean()) > 1.5 * error / math.sqrt(count)
    if behind and side * cross.along[beam] > 0.2 * cross.foot:
        return Edge(float(np.median(cross.place[corner])), error, depth)
    half = 0.5 * innermost
    return Edge(float(cross.along[beam] - side * half), abs(half), depth)


def _is_next(cross: Crossing, beam: int, side: int) -> bool:
    """Return whether the next beam that answers ends behind the wall's plane, or at it, or a leaf.

    If it ends before it, further from any face than a leaf is thick, something hides the edge.
    """
    following = beam + side
    while 0 <= following < len(cross.depth) and np.isnan(cross.depth[following]):
        following += side
    if not 0 <= following < len(cross.depth):
        return False
    return bool(cross.depth[following] > -_LEAF)


def side_length(cross: Crossing, edge: Edge, side: int, tolerance: float) -> float:
    """Return how much of the wall is seen beside an edge, or the length of a leaf there [m]."""
    outward = side * (cross.place - edge.place)
    flat = (np.abs(cross.depth) <= tolerance) & (outward > -_STRIP) & (outward < _NEIGHBOUR)
    face = (np.abs(outward) <= _STRIP) & (np.abs(cross.depth) < _LEAF)
    before, behind = _span(-cross.depth[face]), _span(cross.depth[face])
    return max(_span(outward[flat]), before, behind)


def is_crossed(wall: Wall, edge: Edge, others: Sequence[Wall]) -> bool:
    """Return whether another wall runs through the plane at an edge, or meets it at a slant.

    A jamb or a leaf stands across the plane and ends.
    """
    for other in others:
        sine = float(wall.normal[0] * other.normal[1] - wall.normal[1] * other.normal[0])
        if other is wall or abs(sine) < math.sin(_SLANT):
            continue
        points = other.distance * other.normal + other.along[:, None] * other.tangent
        depth = points @ wall.normal - wall.distance
        place = (other.distance - wall.distance * float(wall.normal @ other.normal)) / sine
        if abs(place - edge.place) > _BEGIN or np.abs(depth).min() > _BEGIN:
            continue
        before, behind = _span(-depth), _span(depth)
        if abs(sine) < math.cos(_SLANT) or min(before, behind) > _THICKEST:
            return True
        if before > 1.1 * _LEAF or behind > 1.1 * _LEAF + _THICKEST:
            return True
    return False


def _span(places: Array) -> float:
    """Return how far rows of at least four places go on from 0 without a wide gap [m]."""
    rows = np.sort(places[places > -_STRIP])
    if len(rows) < 4 or rows[0] > _BEGIN:
        return 0.0
    gaps = np.flatnonzero(np.diff(rows) > _GAP)
    last = int(gaps[0]) if len(gaps) else len(rows) - 1
    return float(rows[last]) if last >= 3 else 0.0
