"""A driver who wants to hit something: at full stick towards walls and people, all the time."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..se2 import Array
from .driver_hand import Hand
from .driver_sight import Sight
from .driver_traits import Traits

_THINKS = 0.1  # s
_WHIMS = ("nearest", "somewhere", "astern", "spin", "jerk")
_SHARES = (0.4, 0.25, 0.15, 0.1, 0.1)


class HostileDriver:
    """Somebody who pushes at walls and people, forward, backward and turning, without end.

    Every few seconds another whim: at the nearest thing seen, at anything seen, backward, round
    and round, or jerking the stick about; at full deflection always.
    """

    def __init__(
        self, sight: Sight, rng: np.random.Generator, *, traits: Traits | None = None
    ) -> None:
        """Seat the driver.

        Args:
            sight: Their eyes.
            rng: Source of their whims.
            traits: Of the hand; default a quick one that hardly trembles.
        """
        self._sight, self._rng = sight, rng
        self._hand = Hand(traits or Traits(reaction_time=0.1, tremor=0.02), rng)
        self._whim, self._until = "nearest", -math.inf
        self._aim = 0.0
        self._thought = -math.inf
        self._begun = math.nan
        self._now = 0.0

    @property
    def finished(self) -> bool:
        """Never."""
        return False

    @property
    def progress(self) -> float:
        """How long they have been at it [s]."""
        return 0.0 if math.isnan(self._begun) else self._now - self._begun

    def step(self, time: float, pose: ArrayLike, motion: ArrayLike) -> Array:
        """See `Driver`."""
        self._begun = time if math.isnan(self._begun) else self._begun
        self._now = time
        if time >= self._thought + _THINKS - 1e-9:
            self._thought = time
            self._hand.mean(time, self._push(time, pose))
        return self._hand.move(time)

    def _push(self, time: float, pose: ArrayLike) -> tuple[float, float]:
        """Return where the stick shall be, [forward, left]."""
        points = self._sight.look(time, pose)
        if time >= self._until:
            self._whim = str(self._rng.choice(_WHIMS, p=_SHARES))
            self._until = time + self._rng.uniform(1.0, 6.0)
            self._aim = float(self._rng.uniform(-1.0, 1.0))
        if self._whim == "nearest" and len(points):
            nearest = points[np.argmin(np.hypot(points[:, 0], points[:, 1]))]
            return self._towards(math.atan2(nearest[1], nearest[0]))
        if self._whim == "somewhere" or not len(points):
            return 1.0, 0.6 * self._aim
        if self._whim == "astern":
            return -1.0, 0.6 * self._aim
        if self._whim == "spin":
            return 0.0, math.copysign(1.0, self._aim)
        if self._whim == "jerk":
            forward, left = self._rng.choice([-1.0, 0.0, 1.0], size=2)
            return float(forward), float(left)
        return 1.0, 0.0

    def _towards(self, direction: float) -> tuple[float, float]:
        """Return the stick that drives at something: straight if ahead, else turning to it."""
        if abs(direction) > 0.6 * math.pi:  # behind: the back of the chair hits as well
            return -1.0, -0.5 * math.copysign(math.pi - abs(direction), direction)
        return 1.0, max(-1.0, min(1.0, 1.5 * direction))
