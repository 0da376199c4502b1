"""Random disturbances with a memory."""

from __future__ import annotations

import math

import numpy as np


class GaussMarkov:
    """A first-order Gauss-Markov process: normal at every moment, forgetting exponentially.

    x(t + dt) = a x(t) + sigma sqrt(1 - a^2) n with a = exp(-dt / memory) and n standard normal:
    its standard deviation is sigma at every step length. Memory 0 is white noise.
    """

    def __init__(self, sigma: float, memory: float, rng: np.random.Generator) -> None:
        """Draw the first value.

        Args:
            sigma: Standard deviation, any unit; 0 draws nothing and stays 0.
            memory: Time constant [s].
            rng: Source of the draws.
        """
        self._sigma = sigma
        self._memory = memory
        self._rng = rng
        self._value = sigma * rng.standard_normal() if sigma > 0.0 else 0.0

    def step(self, dt: float) -> float:
        """Return the value now and let `dt` seconds pass."""
        if self._sigma == 0.0:
            return 0.0
        now = self._value
        keep = math.exp(-dt / self._memory) if self._memory > 0.0 else 0.0
        fresh = math.sqrt(1.0 - keep * keep) * self._sigma
        self._value = keep * now + fresh * self._rng.standard_normal()
        return now
