"""The hand on the stick: it moves after the reaction time, not at once, and trembles."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from ..se2 import Array
from .driver_traits import Traits
from .noise import GaussMarkov

LAG = 0.12
"""Time constant of a hand [s]."""

_TREMOR_MEMORY = 0.1  # s: trembling at a few hertz


class Hand:
    """A hand that follows what its owner means."""

    def __init__(self, traits: Traits, rng: np.random.Generator) -> None:
        """Lay a hand on the stick.

        Args:
            traits: Of its owner.
            rng: Source of the tremor.
        """
        self._reaction = traits.reaction_time
        self._tremor = [GaussMarkov(traits.tremor, _TREMOR_MEMORY, rng) for _ in range(2)]
        self._waiting: deque[tuple[float, float, float]] = deque()
        self._meant = (0.0, 0.0)
        self._at = np.zeros(2)
        self._last = math.nan

    def mean(self, time: float, stick: tuple[float, float]) -> None:
        """Decide where it shall go; it begins to after the reaction time."""
        self._waiting.append((time + self._reaction, *stick))

    def move(self, time: float) -> Array:
        """Return where it is, [forward, left], each -1 to 1, shape (2,); time goes on."""
        dt = 0.0 if math.isnan(self._last) else time - self._last
        self._last = time
        while self._waiting and self._waiting[0][0] <= time + 1e-9:
            self._meant = self._waiting.popleft()[1:]
        self._at += (1.0 - math.exp(-dt / LAG)) * (np.array(self._meant) - self._at)
        shaking = np.array([tremor.step(dt) for tremor in self._tremor])
        return np.asarray(np.clip(self._at + shaking, -1.0, 1.0))
