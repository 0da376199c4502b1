"""Where the chair will be, and how it will move, when the next command takes effect."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from ..se2 import Array

_FINEST = 0.02  # s: longest step of the prediction


class Prediction:
    """Carries the chair ahead by the commands that are on their way to the wheels.

    "... their expected change due to the commands previously sent to the wheelchair"
    [DrivingAssistant, Sec. III-B]. The wheels answer with a first-order lag.
    """

    def __init__(self, latency: float, lag: float) -> None:
        """Begin at rest.

        Args:
            latency: Time from a command to its taking effect [s].
            lag: Time constant of the wheels [s].
        """
        self._latency = latency
        self._lag = lag
        self._sent: deque[tuple[float, float, float]] = deque()
        self._acting = (0.0, 0.0)

    def send(self, time: float, v: float, omega: float) -> None:
        """Note a command sent."""
        if self._latency > 0.0:
            self._sent.append((time + self._latency, v, omega))

    def ahead(self, time: float, v: float, omega: float) -> tuple[Array, float, float]:
        """Return pose (3,) in the body frame now, v and omega after the latency.

        Args:
            time: Now [s].
            v: Speed now [m/s].
            omega: Heading rate now [rad/s].
        """
        pose = np.zeros(3)
        if self._latency == 0.0:
            return pose, v, omega
        while self._sent and self._sent[0][0] <= time + 1e-9:
            _, *acting = self._sent.popleft()
            self._acting = (acting[0], acting[1])
        coming = list(self._sent)
        x, y, heading = 0.0, 0.0, 0.0
        steps = math.ceil(self._latency / _FINEST - 1e-9)
        dt = self._latency / steps
        share = 1.0 - math.exp(-dt / self._lag) if self._lag > 0.0 else 1.0
        target = self._acting
        for k in range(steps):
            while coming and coming[0][0] <= time + k * dt + 1e-9:
                _, *sent = coming.pop(0)
                target = (sent[0], sent[1])
            before_v, before_omega = v, omega
            v += share * (target[0] - v)
            omega += share * (target[1] - omega)
            travel, turn = 0.5 * (v + before_v) * dt, 0.5 * (omega + before_omega) * dt
            x += travel * math.cos(heading + 0.5 * turn)
            y += travel * math.sin(heading + 0.5 * turn)
            heading += turn
        return np.array([x, y, heading]), v, omega
