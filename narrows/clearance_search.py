"""Branch and bound for the least clearance of a body swept over a path.

The motion is cut into intervals. On an interval the positions lie in the convex hull of known
points P_j and the heading in a known range (`narrows.section.Enclosure`), so along any unit axis n
the gap between a body with corners v_i and a convex solid of support h is at least

    h - max_j n.P_j - max_i max_theta |v_i| cos(theta + angle(v_i) - angle(n)),

whichever n is taken. The axis that separates body and solid at the interval's middle makes the
bound exact as the interval shrinks; the distance there bounds the clearance from above. Where the
bound comes within the tolerance of the least distance seen the interval is done; else it is cut.
Negative distance is the depth of an overlap.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .geometry import separation
from .motion_intervals import Intervals, support_bound
from .path import Path
from .se2 import Array, transform
from .section import Enclosure
from .world import ConvexPieces

BOUNDS_SLACK = 1e-4
"""How far a body may stand beyond the bounds [m]: they are a box drawn by a person, not a wall."""

BLOCK = 50_000
"""Pairs of interval and piece looked at together: a few MB."""

STRETCH = 16
"""But at least so many intervals, 0.8 m: each stretch costs a look at all pieces."""

_FINEST = 1e-5  # m: contact and clearance below this are not told apart
_PARTS = 4  # parts an undecided interval is cut into
_ROUNDS = 14  # 0.05 m / 4^14 is below rounding


class MotionSearch:
    """Branch and bound over intervals of a path and convex pieces of solids.

    Attributes:
        path: The path.
        tolerance: Largest gap between the proven and the attained clearance [m].
        least: Least distance seen [m].
        proven: Least bound of all pairs that are done [m].
        progress: Where `least` was seen [m or rad].
        solid: And against which solid, -1: none.
    """

    def __init__(self, path: Path, tolerance: float) -> None:
        """Start with nothing seen."""
        self.path = path
        self.tolerance = tolerance
        self.least = math.inf
        self.proven = math.inf
        self.progress = 0.0
        self.solid = -1

    def allowed(self) -> float:
        """Return how far below `least` a bound may stay: less where contact must be excluded."""
        if self.least <= 0.0:
            return self.tolerance
        return max(min(self.tolerance, 0.5 * self.least), _FINEST)

    def against(self, body: Array, pieces: ConvexPieces) -> None:
        """Lower `least` and `proven` by what one convex body meets along the path."""
        if not len(pieces):
            return
        intervals = Intervals.of(self.path)
        enclosure = intervals.enclose(self.path.sections)
        row, piece = self._near(body, pieces, intervals, enclosure)
        for _ in range(_ROUNDS):
            lower = self._examine(body, pieces, intervals, enclosure, row, piece)
            undecided = lower < self.least - self.allowed()
            self.proven = min(self.proven, float(lower[~undecided].min(initial=math.inf)))
            if not undecided.any():
                return
            kept, index = np.unique(row[undecided], return_inverse=True)
            intervals = intervals.cut(kept, _PARTS)
            enclosure = intervals.enclose(self.path.sections)
            row = (index[:, None] * _PARTS + np.arange(_PARTS)).ravel()
            piece = np.repeat(piece[undecided], _PARTS)
        self.proven = min(self.proven, float(lower[undecided].min()))

    def _near(
        self, body: Array, pieces: ConvexPieces, intervals: Intervals, enclosure: Enclosure
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the pairs of interval and piece that their boxes do not rule out.

        Stretch by stretch: what is further from the whole stretch than the least distance seen so
        far is left out at once, which is most of a large map.
        """
        reach = np.linalg.norm(enclosure.hull - enclosure.middle[:, None, :2], axis=2).max(axis=1)
        reach += float(np.linalg.norm(body, axis=1).max())
        none = np.zeros(0, dtype=np.int64)
        found = [(none, none, np.zeros(0))]
        length = max(STRETCH, BLOCK // len(pieces))
        for begin in range(0, len(reach), length):
            every = np.arange(begin, min(begin + length, len(reach)))
            middle = enclosure.middle[every, :2]
            limit = self.least + float(reach[every].max())
            close = pieces.near(middle.min(axis=0), middle.max(axis=0), limit)
            if not len(close):
                continue
            box = box_distance(middle, pieces.low[close], pieces.high[close])
            bound = box - reach[every, None]
            self._examine(body, pieces, intervals, enclosure, every, close[bound.argmin(axis=1)])
            row, piece = np.nonzero(bound < self.least)
            found.append((every[row], close[piece], bound[row, piece]))
        row, piece, bound = (np.concatenate(part) for part in zip(*found, strict=True))
        near = bound < self.least
        return row[near], piece[near]

    def _examine(
        self,
        body: Array,
        pieces: ConvexPieces,
        intervals: Intervals,
        enclosure: Enclosure,
        row: NDArray[np.int64],
        piece: NDArray[np.int64],
    ) -> Array:
        """Return a lower bound for each pair; keep the least distance seen at the middles."""
        solid = pieces.corners[piece]
        distance, axis = separation(transform(enclosure.middle, body)[row], solid)
        distance = distance - pieces.radius[piece]
        if len(distance) and distance.min() < self.least:
            best = int(distance.argmin())
            self.least = float(distance[best])
            self.solid = int(pieces.owner[piece[best]])
            k = int(row[best])
            section = int(intervals.section[k])
            middle = np.array([0.5 * (intervals.low[k] + intervals.high[k])])
            within = self.path.sections[section].progress_at(intervals.piece[k : k + 1], middle)
            self.progress = float(self.path.section_bounds[section] + within[0])
        support = np.einsum("nkd,nd->nk", solid, axis).min(axis=1) - pieces.radius[piece]
        return np.asarray(support - support_bound(body, enclosure, row, axis))


def box_distance(points: Array, low: Array, high: Array) -> Array:
    """Return the distance from points (N, 2) to boxes (P, 2), shape (N, P), [m].

    Inside a box it is minus the way to its nearest side: a body deep in a solid can be deeper
    than its own radius.
    """
    offset = np.maximum(low - points[:, None], points[:, None] - high)
    outside = np.maximum(offset, 0.0)
    inside = np.minimum(offset.max(axis=2), 0.0)
    return np.asarray(np.hypot(outside[..., 0], outside[..., 1]) + inside)


def inside_bounds(
    path: Path, body: Array, bounds: tuple[float, float, float, float] | None
) -> float:
    """Return a lower bound on the distance of the swept body to the bounds [m].

    Intervals are cut until they are proven inside (to a tenth of a millimetre) or seen outside.
    """
    if bounds is None:
        return math.inf
    normals = np.array([[-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    offsets = np.array([-bounds[0], -bounds[1], bounds[2], bounds[3]])
    intervals = Intervals.of(path)
    proven = math.inf
    for _ in range(_ROUNDS):
        enclosure = intervals.enclose(path.sections)
        rows = np.repeat(np.arange(len(intervals.low)), 4)
        axis = np.tile(normals, (len(intervals.low), 1))
        reach = support_bound(body, enclosure, rows, axis).reshape(-1, 4)
        lower = (offsets - reach).min(axis=1)
        corners = transform(enclosure.middle, body)  # (N, K, 2)
        seen = (offsets - (corners @ normals.T).max(axis=1)).min()
        undecided = (lower < -BOUNDS_SLACK) & (seen >= -BOUNDS_SLACK)
        proven = min(proven, float(lower[~undecided].min(initial=math.inf)))
        if not undecided.any():
            return min(proven, float(seen)) if seen < -BOUNDS_SLACK else proven
        intervals = intervals.cut(np.flatnonzero(undecided), _PARTS)
    return min(proven, float(lower[undecided].min()))
