"""When each sensor last spoke: what is not heard of any more is silence, not free space."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ..errors import InputError


class LastWords:
    """Times at which sensors spoke last."""

    def __init__(self, sensors: Sequence[str]) -> None:
        """Begin with sensors that have not spoken.

        Args:
            sensors: Names of those that must speak; empty: those that have spoken.
        """
        self._named = tuple(sensors)
        self._heard: dict[str, float] = dict.fromkeys(sensors, -math.inf)

    @property
    def times(self) -> Mapping[str, float]:
        """When each spoke last [s]; -inf: never."""
        return dict(self._heard)

    @property
    def oldest(self) -> float:
        """When the one silent longest spoke last [s]; -inf: one never has, or there is none."""
        return min(self._heard.values(), default=-math.inf)

    def hear(self, sensor: str, time: float) -> None:
        """Note that a sensor speaks; a late answer is no step back.

        Raises:
            InputError: If the time is not finite, or nobody named the sensor.
        """
        if not math.isfinite(time):
            raise InputError("not a time", field="time", value=time)
        if self._named and sensor not in self._named:
            allowed = ", ".join(self._named)
            raise InputError("no such sensor", field="sensor", value=sensor, allowed=allowed)
        self._heard[sensor] = max(time, self._heard.get(sensor, -math.inf))
