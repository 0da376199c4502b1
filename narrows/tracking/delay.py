"""Where the chair will be when a command sent now takes effect."""

from __future__ import annotations

import math
from collections import deque

from ..errors import ShapeError


class DelayPrediction:
    """Carries a pose over a known delay by the commands still on their way.

    A command sent at t is taken to drive the chair from t + delay on, so the commands of the last
    `delay` seconds are what happens next: the pose predicted is the pose now moved by each of them
    in turn, on exact arcs. A first-order lag of the motors counts as a delay of its time constant:
    it is that to first order, wrong by lag^2 times the acceleration (1.5 mm at 0.05 s and
    0.6 m/s^2) while the speed changes, and right once it is steady.

    Attributes:
        delay: Time from a command to its effect [s].
    """

    def __init__(self, delay: float) -> None:
        """Start with a chair at rest that has been sent nothing.

        Args:
            delay: Latency plus motor lag [s], 0 or more.
        """
        if not (0.0 <= delay < math.inf):
            raise ShapeError(f"delay must be a finite number >= 0 [s], got {delay}")
        self.delay = delay
        self._sent: deque[tuple[float, float, float]] = deque()

    def sent(self, time: float, v: float, omega: float) -> None:
        """Note a command [m/s, rad/s] sent at a time [s], valid until the next."""
        self._sent.append((time, v, omega))

    def predict(
        self, time: float, x: float, y: float, heading: float
    ) -> tuple[float, float, float]:
        """Return the pose at `time + delay` of a chair that stands at a pose at `time`.

        Args:
            time: Now [s]; later than every command noted.
            x: Position in the world frame [m].
            y: Likewise.
            heading: Heading in the world frame [rad].
        """
        oldest = time - self.delay
        while len(self._sent) > 1 and self._sent[1][0] <= oldest:
            self._sent.popleft()
        begins = [begin for begin, _, _ in self._sent]
        for (begin, v, omega), end in zip(self._sent, [*begins, time][1:], strict=True):
            duration = end - max(begin, oldest)
            if duration > 0.0:
                x, y, heading = moved(x, y, heading, v, omega, duration)
        return x, y, heading


def moved(
    x: float, y: float, heading: float, v: float, omega: float, duration: float
) -> tuple[float, float, float]:
    """Return a pose after a constant command: an exact arc.

    >>> moved(0.0, 0.0, 0.0, 1.0, 0.0, 2.0)
    (2.0, 0.0, 0.0)
    """
    half = 0.5 * omega * duration
    chord = v * duration * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
    direction = heading + half
    return (
        x + chord * math.cos(direction),
        y + chord * math.sin(direction),
        heading + omega * duration,
    )
