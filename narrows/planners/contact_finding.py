"""Where along a motion a body comes near which pieces, least distances and what is near between.

Distances are taken at coarse samples, finer ones where the body may come near between them, and
each least one is then narrowed down between its neighbours.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from narrows.se2 import Array

from .body_distance import BodyDistance, Measured

HORIZON = 0.25
"""Distance beyond which a solid is not watched [m]; a solve moves the curve by less."""

FINER = 6
"""Fine samples for each coarse one."""


class Watching(NamedTuple):
    """What is watched besides the least distances.

    Attributes:
        near: Nearer than this it is watched along the way [m].
        stride: Between places watched along the way [m].
        close: Beyond what is required; nearer it is watched more densely [m].
        close_stride: Between places there [m].
    """

    near: float = 0.08
    stride: float = 0.04
    close: float = 0.010
    close_stride: float = 0.014


WATCH = Watching()

_OFFSETS = np.array([-4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0]) / 3.5
_PARABOLAS = 2
_WITHIN = 0.015  # m beyond what is required: least distances that are narrowed down

Motion = Callable[[Array], Array]


class Contacts(NamedTuple):
    """Pairs of a place and a piece.

    Attributes:
        parameter: Where along the section, shape (N,), in [0, 1].
        pose: The pose there, shape (N, 3).
        piece: Index of the piece, shape (N,).
        distance: Signed distance [m], shape (N,).
        axis: Unit vector from body to solid, world frame, shape (N, 2).
        in_world: Whether the axis stays with the solid, shape (N,).
        between_corners: Distance of two corners that face each other, else infinite, (N,), [m].
        is_least: Whether the distance is least here along the motion, and smoothly so, (N,).
    """

    parameter: Array
    pose: Array
    piece: NDArray[np.int64]
    distance: Array
    axis: Array
    in_world: NDArray[np.bool_]
    between_corners: Array
    is_least: NDArray[np.bool_]

    @classmethod
    def of(
        cls,
        parameter: Array,
        pose: Array,
        piece: NDArray[np.int64],
        measured: Measured,
        *,
        is_least: bool,
    ) -> Contacts:
        """Return the pairs of measured distances."""
        distance, axis, in_world, between = measured
        least = np.full(len(piece), is_least)
        return cls(parameter, pose, piece, distance, axis, in_world, between, least)

    def take(self, rows: NDArray[np.int64] | NDArray[np.bool_]) -> Contacts:
        """Return some of the pairs."""
        columns: tuple[Any, ...] = self
        return Contacts(*(values[rows] for values in columns))

    def and_also(self, other: Contacts) -> Contacts:
        """Return the pairs of both."""
        pairs: Iterable[tuple[Any, Any]] = zip(self, other, strict=True)
        return Contacts(*(np.concatenate(pair) for pair in pairs))

    def replaced(self, better: NDArray[np.bool_], other: Contacts) -> Contacts:
        """Return the pairs, those of the other where it is better."""
        return Contacts(
            *(
                np.where(better if ours.ndim == 1 else better[:, None], theirs, ours)
                for ours, theirs in zip(self, other, strict=True)
            )
        )


class Samples(NamedTuple):
    """Fine samples along a section.

    Attributes:
        parameter: Even, shape (F,), in [0, 1]; every `FINER`th is a coarse one.
        pose: Poses there, shape (F, 3).
        travelled: Chords up to there, shape (F,), [m].
    """

    parameter: Array
    pose: Array
    travelled: Array

    @classmethod
    def of(cls, parameter: Array, pose: Array) -> Samples:
        """Return the samples of poses (F, 3) at parameters (F,)."""
        step = np.diff(pose[:, :2], axis=0)
        chord = np.sqrt(step[:, 0] ** 2 + step[:, 1] ** 2)
        return cls(parameter, pose, np.concatenate([[0.0], np.cumsum(chord)]))


def samples_along(motion: Motion, parameter: Array) -> Samples:
    """Return the poses of a motion at fine samples (F,)."""
    return Samples.of(parameter, motion(parameter))


def contacts_along(
    body: BodyDistance, motion: Motion, samples: Samples, required: float
) -> Contacts | None:
    """Return where the body comes near the pieces, or None if nowhere.

    Of each piece within the horizon the least distances along the motion, narrowed down, and
    places along what is near, more of them where it is close to what is required.

    Args:
        body: The body and the pieces.
        motion: Poses (N, 3) at parameters (N,) in [0, 1], [m, m, rad].
        samples: Its fine samples.
        required: Clearance asked for [m].
    """
    found, index = _sampled(body, samples, required)
    if not len(index):
        return None
    is_least, spacing = _least(found, index)
    watched = found.distance[is_least] < max(required, float(found.distance.min())) + _WITHIN
    lowest = found.take(is_least[watched])
    lowest = _narrowed(body, motion, lowest, spacing[watched] * samples.parameter[1])
    along = _along(found, samples.travelled[index], required, is_least)
    return lowest.and_also(found.take(np.concatenate([is_least[~watched], along])))


def _sampled(
    body: BodyDistance, samples: Samples, required: float
) -> tuple[Contacts, NDArray[np.int64]]:
    """Return the pairs within the horizon, piece by piece in order, and their fine samples."""
    coarse = samples.pose[::FINER]
    piece, sample = _in_reach(body, coarse)
    first = body.measure(coarse[sample], piece, HORIZON)
    step = np.diff(coarse, axis=0)
    moved = np.hypot(step[:, 0], step[:, 1]) + body.radius * np.abs(step[:, 2])
    neighbours = np.flatnonzero((np.diff(sample) == 1) & (np.diff(piece) == 0))
    between = 0.5 * (first.distance[neighbours] + first.distance[neighbours + 1])
    near = neighbours[between - 0.5 * moved[sample[neighbours]] < required + WATCH.close]
    inner = np.arange(1, FINER)
    finer = (FINER * sample[near][:, None] + inner).ravel()
    finer_piece = np.repeat(piece[near], len(inner))
    second = body.measure(samples.pose[finer], finer_piece, HORIZON)
    index = np.concatenate([FINER * sample, finer])
    piece = np.concatenate([piece, finer_piece])
    both = first.and_also(second)
    order = np.argsort(piece * len(samples.parameter) + index)
    order = order[both.distance[order] < HORIZON]
    index, measured = index[order], both.take(order)
    found = Contacts.of(
        samples.parameter[index], samples.pose[index], piece[order], measured, is_least=False
    )
    return found, index


def _in_reach(body: BodyDistance, poses: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the pairs of piece and pose that their boxes do not rule out, piece by piece."""
    pieces, reach = body.pieces, body.radius + HORIZON
    places = poses[:, :2]
    close = pieces.near(places.min(axis=0), places.max(axis=0), reach)
    away = np.maximum(
        pieces.low[close][:, None] - places, places - pieces.high[close][:, None]
    )  # (P, N, 2)
    np.maximum(away, 0.0, out=away)
    piece, sample = np.nonzero(np.hypot(away[..., 0], away[..., 1]) < reach)
    return close[piece], sample


def _least(
    found: Contacts, index: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the rows of local minima, and how many fine samples off their neighbours are."""
    count = len(index)
    same = (np.diff(found.piece) == 0) & (np.diff(index) <= FINER)
    gap = np.where(same, np.diff(index), 1)
    before, after = np.full(count, np.inf), np.full(count, np.inf)
    before[1:] = np.where(same, found.distance[:-1], np.inf)
    after[:-1] = np.where(same, found.distance[1:], np.inf)
    rows = np.flatnonzero((found.distance <= before) & (found.distance < after))
    wide = np.concatenate([[1], gap, [1]])
    return rows, np.maximum(wide[rows], wide[rows + 1])


def _narrowed(body: BodyDistance, motion: Motion, contacts: Contacts, width: Array) -> Contacts:
    """Return local minima moved to the least distance within a width (N,) on either side.

    The least of a few places, then the lowest points of parabolas through it and its neighbours:
    an axis from corner to corner turns so fast that it must be taken just there.
    """
    best, rows = contacts, np.arange(len(contacts.piece))
    count = len(_OFFSETS)
    tried = contacts.parameter[:, None] + width[:, None] * _OFFSETS
    other = _at(body, motion, tried.ravel(), np.repeat(contacts.piece, count))
    distance = np.insert(other.distance.reshape(-1, count), count // 2, best.distance, axis=1)
    least = distance[:, 1:-1].argmin(axis=1) + 1
    chosen = other.take(rows * count + least - (least > count // 2))
    best = best.replaced(chosen.distance < best.distance, chosen)
    middle = np.insert(tried, count // 2, contacts.parameter, axis=1)
    place = np.stack([middle[rows, least + k] for k in (-1, 0, 1)], axis=1)
    value = np.stack([distance[rows, least + k] for k in (-1, 0, 1)], axis=1)
    for _ in range(_PARABOLAS):
        lowest = _lowest(place, value)
        other = _at(body, motion, lowest, contacts.piece)
        best = best.replaced(other.distance < best.distance, other)
        _shrink(place, value, lowest, other.distance)
    inside = (best.parameter > 0.0) & (best.parameter < 1.0)
    return best._replace(is_least=inside)


def _at(body: BodyDistance, motion: Motion, parameter: Array, piece: NDArray[np.int64]) -> Contacts:
    """Return the contacts with pieces (N,) at parameters (N,)."""
    inside = np.minimum(np.maximum(parameter, 0.0), 1.0)
    pose = motion(inside)
    measured = body.measure(pose, piece, HORIZON)
    return Contacts.of(inside, pose, piece, measured, is_least=True)


def _lowest(place: Array, value: Array) -> Array:
    """Return the lowest place of the parabola through three, or between the lower two, (N,)."""
    left, right = place[:, 1] - place[:, 0], place[:, 2] - place[:, 1]
    fall, rise = value[:, 0] - value[:, 1], value[:, 2] - value[:, 1]
    scale = left * rise + right * fall
    with np.errstate(divide="ignore", invalid="ignore"):
        move = 0.5 * (right**2 * fall - left**2 * rise) / scale
    is_flat = ~(scale > 0.0)
    move[is_flat] = 0.25 * (right - left)[is_flat]
    move = np.minimum(np.maximum(move, -0.9 * left), 0.9 * right)
    still = np.abs(move) < 1e-3 * (left + right)
    aside = 0.02 * np.where(left > right, -left, right)
    return np.asarray(place[:, 1] + np.where(still, aside, move))


def _shrink(place: Array, value: Array, tried: Array, found: Array) -> None:
    """Put a tried place among three, the lowest in the middle."""
    after, better = tried > place[:, 1], found < value[:, 1]
    for columns, new in ((place, tried), (value, found)):
        left, middle, right = columns.T.copy()
        columns[:, 0] = np.where(better, np.where(after, middle, left), np.where(after, left, new))
        columns[:, 1] = np.where(better, new, middle)
        columns[:, 2] = np.where(
            better, np.where(after, right, middle), np.where(after, new, right)
        )


def _along(
    found: Contacts, travelled: Array, required: float, is_least: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the first row of each stride along what is near, without the least ones."""
    close = found.distance < required + WATCH.close
    stride = np.where(close, WATCH.close_stride, WATCH.stride)
    mark = np.floor(travelled / stride) + 1e6 * close
    kept = np.ones(len(mark), dtype=bool)
    kept[1:] = (np.diff(mark) != 0.0) | (np.diff(found.piece) != 0)
    kept &= found.distance < WATCH.near
    kept[is_least] = False
    return np.flatnonzero(kept)
