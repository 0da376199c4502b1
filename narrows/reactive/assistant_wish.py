"""Where the chair is to go: the way the user indicates, or past what is in it."""

from __future__ import annotations

import math

import numpy as np

from .assistant_braking import ComfortBraking
from .assistant_look import Look
from .assistant_options import AssistantOptions, AssistantState
from .assistant_restoring import Orientation
from .avoidance import indicated_side, sides_to_try, way_past
from .safety_regions import SafetyRegions
from .side_tables import side_table
from .smooth_motion import MotionLimits

STILL = 1e-3
"""Speed norm below which nothing moves [m/s]."""

_SPIN = 0.2  # |v| below this share of the rim speed: a turn on the spot, with no side to avoid to


class Wish:
    """Chooses the target of each step, and the state that goes with it [DrivingAssistant, Fig. 4].

    Attributes:
        state: State after the last step.
        deviation: From the indicated direction to the target's [rad].
    """

    def __init__(
        self,
        regions: SafetyRegions,
        options: AssistantOptions,
        limits: MotionLimits,
        braking: ComfortBraking,
        look: Look,
        top: float,
    ) -> None:
        """Begin with the user in full control.

        Args:
            regions: The chair's.
            options: Of the assistant.
            limits: Of motion.
            braking: Turns hard limits into comfortable ones.
            look: Obstacles, shown anew before each step.
            top: Greatest speed norm of the chair [m/s].
        """
        self._regions, self._options, self._limits = regions, options, limits
        self._braking, self._look, self._top = braking, look, top
        self._orientation = Orientation(options, limits)
        self._table = side_table(options.sides)
        self.state = AssistantState.FULL_USER_CONTROL
        self.deviation = 0.0

    def moved(self, travel: float, turn: float) -> None:
        """Count in how the chair has moved: way along its heading [m] and heading [rad]."""
        self._orientation.moved(travel, turn)

    def target(
        self, asked: tuple[float, float], trust: float, *, is_helped: bool
    ) -> tuple[tuple[float, float], float]:
        """Return where the command is to go to, and the limit in the indicated direction.

        Args:
            asked: What the user indicates, [v, omega], helped through a door or not.
            trust: In what is perceived, 0 to 1.
            is_helped: Whether a path through a door is followed: no other way is looked for then.
        """
        phi, norm = self._regions.polar(*asked)
        wanted = min(norm, trust * self._top)
        if wanted < STILL:
            self.state = (
                AssistantState.FULL_USER_CONTROL if norm < STILL else AssistantState.BRAKING
            )
            self._orientation.forget()
            self.deviation = 0.0
            return (0.0, 0.0), 0.0
        limit = self._braking.comfortable(self._look.limit(phi))
        if limit >= wanted:
            return self._unhindered(asked, phi, norm, wanted), limit
        self.deviation = 0.0 if is_helped else self._detour(asked, phi, norm, limit)
        if self.deviation == 0.0:
            self.state = AssistantState.BRAKING
            return bounded(self._regions, self._limits, phi, min(limit, wanted), asked), limit
        if self.state is not AssistantState.OBSTACLE_AVOIDANCE:
            if not self._orientation.is_kept or not self._orientation.is_untouched(*asked):
                self._orientation.keep(*asked)
            self.state = AssistantState.OBSTACLE_AVOIDANCE
        phi += self.deviation
        limit = self._braking.comfortable(self._look.limit(phi))
        return bounded(self._regions, self._limits, phi, min(limit, wanted), asked), limit

    def _unhindered(
        self, asked: tuple[float, float], phi: float, norm: float, wanted: float
    ) -> tuple[float, float]:
        """Return the target where nothing is in the way the user indicates."""
        self.deviation = 0.0
        orientation = self._orientation
        if orientation.is_kept and orientation.is_untouched(*asked) and orientation.is_due():
            v, omega = asked[0], asked[1] + orientation.correction()
            back, _ = self._regions.polar(*self._limits.clipped(v, omega))
            limit = self._braking.comfortable(self._look.limit(back))
            if limit >= self._options.close * wanted:
                self.state = AssistantState.RESTORING_ORIENTATION
                self.deviation = math.remainder(back - phi, 2.0 * math.pi)
                return bounded(self._regions, self._limits, back, min(limit, wanted), asked)
            # What was avoided is still beside the chair: go on, and try again.
            self.state = AssistantState.RESTORING_ORIENTATION
        else:
            orientation.forget()
            self.state = AssistantState.FULL_USER_CONTROL
        scale = wanted / norm
        return asked if scale >= 1.0 else (scale * asked[0], scale * asked[1])

    def _detour(self, asked: tuple[float, float], phi: float, norm: float, limit: float) -> float:
        """Return by how much to deviate from the indicated direction [rad]; 0: only brake."""
        options = self._options
        forward = asked[0] > 0.0
        is_spin = abs(asked[0]) < _SPIN * 0.5 * norm
        is_close = limit < options.close * norm
        is_avoiding = self.state is AssistantState.OBSTACLE_AVOIDANCE
        if not options.steers or is_spin or not (is_close or is_avoiding):
            return 0.0
        part_limits = np.array([self._braking.comfortable(x) for x in self._look.part_limits(phi)])
        indicated = indicated_side(phi, forward, options.avoidance.straight_band)
        sides = sides_to_try(part_limits, norm, indicated, self._table, forward)
        if not any(sides):
            return 0.0
        return way_past(
            self._look, self._braking, phi, norm, forward, sides, self.deviation, options.avoidance
        )


def bounded(
    regions: SafetyRegions,
    limits: MotionLimits,
    phi: float,
    norm: float,
    asked: tuple[float, float],
) -> tuple[float, float]:
    """Return the motion of a direction and a speed norm, no faster than asked for."""
    v, omega = regions.motion(phi, norm)
    if v * asked[0] <= 0.0:
        return 0.0, omega
    scale = min(1.0, asked[0] / v)
    sideways = abs(v * omega)
    if sideways > limits.lateral_acceleration:
        scale = min(scale, math.sqrt(limits.lateral_acceleration / sideways))
    return scale * v, scale * omega
