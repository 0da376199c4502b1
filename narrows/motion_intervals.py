"""A motion cut into intervals, with proven bounds on the body swept over each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .path import Path
from .se2 import Array, wrap
from .section import Enclosure, Section

FIRST_CUT = 0.05
"""Longest first interval [m or rad]: near a body's tenth, where the search was fastest."""


@dataclass(frozen=True, eq=False)
class Intervals:
    """Intervals of a path: the section, the piece in it, and local parameters, each (N,)."""

    section: NDArray[np.int64]
    piece: NDArray[np.int64]
    low: Array
    high: Array

    @classmethod
    def of(cls, path: Path) -> Intervals:
        """Return intervals that cover a path, none longer than `FIRST_CUT`."""
        section, piece, low, high = [], [], [], []
        for k, part in enumerate(path.sections):
            every = np.arange(part.pieces)
            span = np.diff(part.progress_at(every, np.ones(part.pieces)), prepend=0.0)
            count = np.maximum(1, np.ceil(span / FIRST_CUT)).astype(np.int64)
            owner = np.repeat(every, count)
            index = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
            section.append(np.full(len(owner), k))
            piece.append(owner)
            low.append(index / count[owner])
            high.append((index + 1) / count[owner])
        return cls(*(np.concatenate(rows) for rows in (section, piece, low, high)))

    def cut(self, rows: NDArray[np.int64], parts: int) -> Intervals:
        """Return some of the intervals, each cut into equal parts that follow each other."""
        owner = np.repeat(rows, parts)
        index = np.tile(np.arange(parts), len(rows))
        step = (self.high[owner] - self.low[owner]) / parts
        low = self.low[owner] + index * step
        return Intervals(self.section[owner], self.piece[owner], low, low + step)

    def enclose(self, sections: tuple[Section, ...]) -> Enclosure:
        """Return the bounds on the poses of all intervals."""
        count = len(self.section)
        hull, middle = np.empty((count, 4, 2)), np.empty((count, 3))
        heading_low, heading_high = np.empty(count), np.empty(count)
        for k in np.unique(self.section):
            rows = np.flatnonzero(self.section == k)
            part = sections[k].enclose(self.piece[rows], self.low[rows], self.high[rows])
            hull[rows], middle[rows] = part.hull, part.middle
            heading_low[rows], heading_high[rows] = part.heading_low, part.heading_high
        return Enclosure(hull, middle, heading_low, heading_high)


def support_bound(body: Array, enclosure: Enclosure, rows: NDArray[np.int64], axis: Array) -> Array:
    """Return an upper bound on how far the swept body reaches along an axis.

    max_j n.P_j + max_i max_theta |v_i| cos(theta + angle(v_i) - angle(n)) over the enclosure's
    positions P_j and headings theta.

    Args:
        body: Corners v_i in the body frame, shape (K, 2), [m].
        enclosure: Bounds on the poses of intervals.
        rows: Which interval each axis belongs to, shape (N,).
        axis: Unit vectors n, shape (N, 2).

    Returns:
        Bounds, shape (N,), [m].
    """
    along = np.einsum("nhk,nk->nh", enclosure.hull[rows], axis).max(axis=1)
    radius = np.linalg.norm(body, axis=1)
    angle = np.arctan2(body[:, 1], body[:, 0])
    direction = np.arctan2(axis[:, 1], axis[:, 0])
    low, high = enclosure.heading_low[rows], enclosure.heading_high[rows]
    off = np.abs(wrap((0.5 * (low + high) - direction)[:, None] + angle))  # (N, K)
    nearest = np.maximum(off - 0.5 * (high - low)[:, None], 0.0)
    return np.asarray(along + (radius * np.cos(nearest)).max(axis=1))
