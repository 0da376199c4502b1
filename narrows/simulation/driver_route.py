"""The way a person has in mind: through this door, then along there, then through that one."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..se2 import Array

_STEP = 0.02  # m between the points of a route
_BEHIND, _AHEAD = 1.0, 1.5  # m of the route around the last place that are looked at for the next


class Route:
    """A line through places, its corners rounded, known as somebody knows their way.

    Attributes:
        points: Points 2 cm apart, shape (N, 2), [m].
        length: Length of the line [m].
    """

    def __init__(self, places: ArrayLike, rounding: float | Sequence[float] = 0.7) -> None:
        """Lay a route through places.

        Args:
            places: The way's corners in order, first and last included, shape (M, 2), [m].
            rounding: Radius of the arcs at all corners, or at each between the ends [m]; less
                where a leg is too short for it.

        Raises:
            ShapeError: If there are fewer than two places, two in a row are the same, or there
                are not as many radii as corners.
        """
        corners = np.array(places, dtype=float)
        if corners.ndim != 2 or corners.shape[1:] != (2,) or len(corners) < 2:
            raise ShapeError(f"a route needs at least two places [x, y], got {corners.shape}")
        if (np.hypot(*np.diff(corners, axis=0).T) < 1e-6).any():
            raise ShapeError("two places of a route in a row are the same")
        radii = [rounding] * (len(corners) - 2) if isinstance(rounding, float) else [*rounding]
        if len(radii) != len(corners) - 2:
            raise ShapeError(f"{len(corners) - 2} corners need as many radii, got {len(radii)}")
        line = _rounded(corners, radii)
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
        self.length = float(along[-1])
        places_along = np.linspace(0.0, self.length, max(2, round(self.length / _STEP) + 1))
        self.points = np.column_stack([np.interp(places_along, along, line[:, k]) for k in (0, 1)])
        self._spacing = self.length / (len(self.points) - 1)
        self._rows = self.points.tolist()

    def at(self, progress: float) -> tuple[float, float]:
        """Return the place at a progress [m]; beyond the ends the line goes straight on."""
        place = progress / self._spacing
        index = min(max(int(place), 0), len(self._rows) - 2)
        share = place - index
        (x0, y0), (x1, y1) = self._rows[index], self._rows[index + 1]
        return x0 + share * (x1 - x0), y0 + share * (y1 - y0)

    def heading(self, progress: float) -> float:
        """Return the direction of the way at a progress [rad]."""
        (x0, y0), (x1, y1) = self.at(progress - self._spacing), self.at(progress + self._spacing)
        return math.atan2(y1 - y0, x1 - x0)

    def bend(self, progress: float, reach: float) -> float:
        """Return the mean curvature between a progress and `reach` further on [1/m]."""
        turned = self.heading(progress + reach) - self.heading(progress)
        return math.remainder(turned, 2.0 * math.pi) / reach

    def progress_of(self, x: float, y: float, near: float) -> float:
        """Return the progress of the nearest place around a progress [m]."""
        first = max(int((near - _BEHIND) / self._spacing), 0)
        last = min(int((near + _AHEAD) / self._spacing) + 2, len(self.points))
        part = self.points[first:last]
        gap = (part[:, 0] - x) ** 2 + (part[:, 1] - y) ** 2
        return (first + int(gap.argmin())) * self._spacing


def _rounded(corners: Array, radii: list[float]) -> Array:
    """Return the line with an arc at every corner that both its legs have room for."""
    rows = [corners[0]]
    for before, corner, after, rounding in zip(
        corners, corners[1:], corners[2:], radii, strict=False
    ):
        back, forth = before - corner, after - corner
        shorter = 0.5 * min(math.hypot(*back), math.hypot(*forth))
        back, forth = back / math.hypot(*back), forth / math.hypot(*forth)
        inner = math.acos(max(-1.0, min(1.0, float(back @ forth))))
        if inner > math.radians(178.0):
            rows.append(corner)
            continue
        cut = min(rounding / math.tan(0.5 * inner), shorter)
        radius = cut * math.tan(0.5 * inner)
        bisector = (back + forth) / math.hypot(*(back + forth))
        centre = corner + bisector * math.hypot(cut, radius)
        first, last = corner + cut * back - centre, corner + cut * forth - centre
        begin = math.atan2(first[1], first[0])
        turn = math.remainder(math.atan2(last[1], last[0]) - begin, 2.0 * math.pi)
        angles = begin + np.linspace(0.0, turn, 16)
        rows.extend(centre + radius * np.column_stack([np.cos(angles), np.sin(angles)]))
    return np.array([*rows, corners[-1]])
