"""Where along a leg to be when: a clock for every leg that waits for a chair left behind."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..path import Path
from ..se2 import Array
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from .legs import Leg
from .pace import LONGEST_WAIT, LimitedPace

_TABLE_STEP = 0.005  # s
_PACE_STEP = 0.02  # s: period at which a path without times is driven to find its times
_CLOSE = 2e-4  # m or rad: the pace only creeps nearer to a leg's end


class Schedule:
    """Progress along each leg by its own clock, which starts when the leg does.

    Attributes:
        durations: Duration of each leg [s].
    """

    def __init__(self, tables: Sequence[Array], ends: Sequence[float]) -> None:
        """Take progress every `_TABLE_STEP` of each leg's time, and the legs' ends."""
        self._tables = [np.append(table, end) for table, end in zip(tables, ends, strict=True)]
        self._times = [_TABLE_STEP * np.arange(len(table)) for table in self._tables]
        self.durations = tuple(float(times[-1]) for times in self._times)

    @classmethod
    def of(
        cls, motion: Path | Trajectory, legs: Sequence[Leg], vehicle: Vehicle, *, speed: float
    ) -> Schedule:
        """Return a motion's schedule: its own times, or a cruising speed within the limits.

        Args:
            motion: The motion.
            legs: Its legs.
            vehicle: Its limits are kept where the motion has no times.
            speed: Cruising speed there [m/s].
        """
        if isinstance(motion, Trajectory):
            tables = _own_times(motion, legs)
        else:
            tables = _paced(legs, vehicle, speed)
        return cls(tables, [leg.end for leg in legs])

    def progress(self, leg: int, clock: Array) -> Array:
        """Return the progress at times of a leg's clock, shape (N,); its end afterwards."""
        return np.asarray(np.interp(clock, self._times[leg], self._tables[leg]))

    def advanced(self, leg: int, clock: float, progress: float, period: float) -> float:
        """Return a leg's clock after a period, unless the chair is far behind: then it waits."""
        behind = float(np.interp(clock, self._times[leg], self._tables[leg])) - progress
        return clock + period if behind < LONGEST_WAIT else clock


def _own_times(trajectory: Trajectory, legs: Sequence[Leg]) -> list[Array]:
    starts = [float(trajectory.profile.time_at(leg.start)) for leg in legs]
    ends = [*starts[1:], trajectory.duration]
    return [
        np.clip(trajectory.progress(_rows(start, end)), leg.start, leg.end)
        for leg, start, end in zip(legs, starts, ends, strict=True)
    ]


def _rows(start: float, end: float) -> Array:
    count = max(1, math.ceil((end - start) / _TABLE_STEP))
    return np.asarray(start + _TABLE_STEP * np.arange(count))


def _paced(legs: Sequence[Leg], vehicle: Vehicle, speed: float) -> list[Array]:
    pace = LimitedPace(legs, vehicle, speed=speed)
    tables: list[Array] = []
    for index, leg in enumerate(legs):
        places = [leg.start]
        while places[-1] < leg.end - _CLOSE:
            rate = pace.rate(index, places[-1], _PACE_STEP)
            places.append(min(places[-1] + rate * _PACE_STEP, leg.end))
        coarse = _PACE_STEP * np.arange(len(places))
        tables.append(np.interp(_rows(0.0, max(coarse[-1], _TABLE_STEP)), coarse, places))
    return tables
