"""The orientation the user had before an obstacle was avoided, and the way back to it."""

from __future__ import annotations

import math

from .assistant_options import AssistantOptions
from .smooth_motion import MotionLimits


class Orientation:
    """Remembers where the user's own way would be heading since an avoidance began.

    [DrivingAssistant, Sec. III-C]: "the Driving Assistant remembers the driving direction when the
    avoidance maneuver begins. If the user does not react ... the system will return to the
    original path". The heading is what is restored, as in Fig. 4; a bend the user keeps indicating
    is counted in by the way driven.
    """

    def __init__(self, options: AssistantOptions, limits: MotionLimits) -> None:
        """Begin with nothing to restore."""
        self._options = options
        self._limits = limits
        self._hand = (0.0, 0.0)
        self._since = 0.0
        self.error = 0.0
        self.is_kept = False

    def keep(self, v: float, omega: float) -> None:
        """Begin to remember, the user commanding [v, omega]."""
        self._hand = (v, omega)
        self.error, self._since, self.is_kept = 0.0, 0.0, True

    def forget(self) -> None:
        """Give up what was remembered."""
        self.error, self.is_kept = 0.0, False

    def moved(self, travel: float, turn: float) -> None:
        """Count in how the chair has moved: way along its heading [m] and heading [rad]."""
        if self.is_kept and self._hand[0] != 0.0:
            self.error += travel * self._hand[1] / self._hand[0] - turn

    def is_untouched(self, v: float, omega: float) -> bool:
        """Return whether the user's command still is the one it was."""
        tolerance, limits = self._options.hand_tolerance, self._limits
        return (
            abs(v - self._hand[0]) <= tolerance * limits.speed
            and abs(omega - self._hand[1]) <= tolerance * limits.yaw_rate
            and (v > 0.0) == (self._hand[0] > 0.0)
        )

    def is_due(self) -> bool:
        """Return whether there is still something to restore."""
        options = self._options
        return (
            self.is_kept
            and options.restores
            and abs(self.error) > options.restore_tolerance
            and abs(self.error) < 0.5 * math.pi
            and self._since < options.restore_time
        )

    def correction(self) -> float:
        """Return the heading rate to add to the user's [rad/s], and count the time."""
        self._since += self._options.period
        most = 0.5 * self._limits.yaw_rate
        return min(max(self._options.restore_gain * self.error, -most), most)
