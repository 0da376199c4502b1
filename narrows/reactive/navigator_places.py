"""How long the places about the chair have been occupied: by that furniture is told from people."""

from __future__ import annotations

import math

import numpy as np

from ..se2 import Array

_CELL = 0.1  # m
_RING = 128  # cells: 12.8 m across
_GONE = 0.5  # s: a place that was not seen for longer is empty


class Places:
    """A ring of cells over the floor that remembers since when each has been occupied."""

    def __init__(self) -> None:
        """Begin with nothing seen."""
        self._watched, self._watched_at = 0.0, -math.inf  # s of seeing; when it was seen last
        self._index = np.full((_RING, _RING, 2), np.iinfo(np.int64).min, dtype=np.int64)
        self._since = np.zeros((_RING, _RING))
        self._seen = np.full((_RING, _RING), -math.inf)

    def ages(self, time: float, places: Array, *, long: float, gap: float) -> Array:
        """Return how long each place has been occupied, shape (N,), [s].

        Time in which nothing was seen makes nobody furniture, and furniture nobody.

        Args:
            time: Now [s].
            places: What is seen occupied now, over the floor in the world, shape (N, 2), [m].
            long: Who has been there for longer is known well enough [s].
            gap: Longer than this between two looks nothing was seen [s].
        """
        from .navigator_places_kernels import watch_cells

        self._watched += min(time - self._watched_at, gap)
        self._watched_at, now = time, self._watched
        since = watch_cells(
            np.ascontiguousarray(places),
            now,
            _CELL,
            _GONE,
            long,
            self._index,
            self._since,
            self._seen,
        )
        return np.asarray(now - since)
