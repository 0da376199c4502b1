"""The control clock: how long ago the last step was."""

from __future__ import annotations

import math

from ..errors import ShapeError

PERIOD = 0.02
"""Control period assumed at the first step [s]; later ones are measured."""


class Clock:
    """Measures control periods from the times of the steps.

    >>> clock = Clock()
    >>> clock.tick(3.0), clock.tick(3.5)
    (0.02, 0.5)
    """

    def __init__(self, first: float = PERIOD) -> None:
        """Choose the period that the first step is taken to have [s]."""
        self._first = first
        self._time = -math.inf

    def tick(self, time: float) -> float:
        """Return the time since the last step [s], and remember this one.

        Raises:
            ShapeError: If time does not increase.
        """
        period = time - self._time if math.isfinite(self._time) else self._first
        if not period > 0.0:
            raise ShapeError(f"time must increase from step to step, got {time} s")
        self._time = time
        return period
