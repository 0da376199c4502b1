"""How the chair moves by the commands it was sent: their latency, the lag of its motors."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from ..se2 import Array

_SAME = 1e-9  # s: times of control steps are sums of periods


class CommandedMotion:
    """Dead reckoning of the chair's twist.

    A command takes effect `latency` after it was sent; the motors follow it as a first-order lag.

    Attributes:
        command: [v, omega] sent last, shape (2,), [m/s, rad/s].
        twist: [v, omega] the chair has by now, shape (2,), [m/s, rad/s].
    """

    def __init__(self, latency: float, lag: float) -> None:
        """Begin with a chair that stands.

        Args:
            latency: Time from a command to its taking effect [s].
            lag: Time constant of the motors [s].
        """
        self.command, self.twist = np.zeros(2), np.zeros(2)
        self._latency, self._lag = latency, lag
        self._target = np.zeros(2)  # in effect now
        self._sent: deque[tuple[float, float, float]] = deque()  # taking effect at, v, omega
        self._time = -math.inf

    def send(self, time: float, command: Array) -> Array:
        """Note a command sent at a time [s], and return a copy of it, shape (2,)."""
        self.command = np.array(command)
        v, omega = self.command.tolist()
        self._sent.append((time + self._latency, v, omega))
        return self.command.copy()

    def advance(self, time: float) -> None:
        """Reckon the twist up to a time [s]."""
        now = self._time if math.isfinite(self._time) else time
        self._time = time
        while now < time - _SAME or (self._sent and self._sent[0][0] <= time + _SAME):
            until = min(time, self._sent[0][0]) if self._sent else time
            decay = math.exp(-max(until - now, 0.0) / self._lag) if self._lag > 0.0 else 0.0
            self.twist = self._target + (self.twist - self._target) * decay
            now = max(until, now)
            if self._sent and self._sent[0][0] <= now + _SAME:
                _, v, omega = self._sent.popleft()
                self._target = np.array([v, omega])

    def pending(self) -> Array:
        """Return commands not yet in effect as rows [duration, v, omega], shape (Q, 3)."""
        rows, begin, current = [], self._time, self._target.tolist()
        for start, v, omega in self._sent:
            rows.append((max(start - begin, 0.0), *current))
            begin, current = max(start, begin), [v, omega]
        left = self._time + self._latency - begin
        if left > _SAME:
            rows.append((left, *current))
        return np.array(rows).reshape(-1, 3)
