"""The driving assistant: the user drives, obstacles limit the speed and bend the way."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..interfaces import Percept
from ..se2 import Array
from ..vehicle import Vehicle
from .assistant_braking import ComfortBraking
from .assistant_look import Look
from .assistant_options import AssistantOptions, AssistantState
from .assistant_prediction import Prediction
from .assistant_view import View
from .assistant_wish import STILL, Wish, bounded
from .door_ahead import DoorAhead
from .door_blend import DoorBlend
from .safety_regions import SafetyRegions, top_norm
from .smooth_motion import MotionLimits, Smooth, SmoothMotion


class Assistant:
    """Shared control by safety regions, [DrivingAssistant, Sec. III].

    Every step a target is chosen from the direction the *user* indicates, and the command taken is
    the next one towards it, within the limits of smooth motion, that a full braking could follow:
    the region of its motion holds no obstacle at its speed. If none can be taken, the last command
    is braked fully in its own direction, which the step before has found to be clear.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        regions: SafetyRegions,
        options: AssistantOptions | None = None,
        *,
        door_blend: DoorBlend | None = None,
    ) -> None:
        """Begin at rest, knowing nothing.

        Args:
            vehicle: The chair.
            regions: Its safety regions.
            options: Default `AssistantOptions()`.
            door_blend: Helps through doors that `step` is told of; None: nothing does.

        Raises:
            ShapeError: If the regions are another chair's, or allow for less than the options need.
        """
        self._options = options = AssistantOptions() if options is None else options
        _check_fit(vehicle, regions, options)
        self._regions = regions
        self._limits = MotionLimits.of(vehicle, yaw_jerk=options.yaw_jerk)
        self._smooth = SmoothMotion(self._limits, period=options.period)
        self._braking = ComfortBraking.of(regions.options, self._limits, options.comfort)
        into_unknown = self._braking.full(2.0 * options.unknown_speed)
        self._look = Look(vehicle, regions, unknown_norm=into_unknown)
        self._view = View(options.fresh, options.stale)
        self._prediction = Prediction(options.latency, options.motor_lag)
        self._wish = Wish(
            regions, options, self._limits, self._braking, self._look, top_norm(vehicle)
        )
        self._door_blend = door_blend
        self._last = (-math.inf, 0.0, 0.0)  # time and motion of the last step
        self._signals: dict[str, float] = {}

    @property
    def state(self) -> AssistantState:
        """State in Fig. 4 after the last step."""
        return self._wish.state

    @property
    def signals(self) -> Mapping[str, float]:
        """Figures of the last step; the same names at every step.

        `state`; `limit`, the rim speed obstacles comfortably allow in the indicated direction
        [m/s]; `deviation` from it [rad]; `trust` in the percept, 0 to 1; `full_braking`, 1 while
        the limits of smooth motion are broken to brake; `door_weight`, share of the steering that
        follows a path through a door.
        """
        return self._signals

    def step(
        self,
        time: float,
        command: ArrayLike,
        motion: ArrayLike,
        percept: Percept | None,
        *,
        door: DoorAhead | None = None,
    ) -> Array:
        """Return the command [v, omega] for the coming control period, shape (2,).

        Args:
            time: Time since the start [s].
            command: [v, omega] the user indicates, shape (2,), [m/s, rad/s]. What is not finite
                counts as zero.
            motion: [v, omega] the chair really has, shape (2,). If not finite, it is taken to be
                as commanded, and the chair brakes.
            percept: Obstacles around the chair, or None if there are none to be had.
            door: A door sensed ahead, or None; for an assistant with a `door_blend`.
        """
        asked = self._limits.clipped(*_pair(command, 0.0))
        v, omega = _pair(motion, math.nan)
        is_measured = math.isfinite(v) and math.isfinite(omega)
        if not is_measured:
            v, omega = self._smooth.command
        moved = self._moved(time, v, omega)
        self._view.update(time, percept, moved)
        helped, door_weight = asked, 0.0
        if self._door_blend is not None:
            helped = self._door_blend.steer(time, self._options.period, asked, moved, door)
            helped = self._limits.clipped(*helped)
            door_weight = self._door_blend.weight
        pose, v, omega = self._prediction.ahead(time, v, omega)
        self._look.show(self._view.points, self._view.unknown, self._view.spread, pose)
        trust = self._view.trust if is_measured else 0.0
        if not self._view.is_known:
            taken, is_full = self._smooth.force(0.0, 0.0), False
            limit = 0.0
        else:
            target, limit = self._wish.target(helped, trust, is_helped=door_weight > 0.0)
            target = self._slowed(target, v, omega)
            levelled = trust == 0.0 and self._smooth.level_off()
            taken, is_full = self._take(target, v, omega)
            is_full = is_full or levelled
        self._prediction.send(time, *taken)
        self._signals = {
            "state": float(self.state),
            "limit": 0.5 * limit,
            "deviation": self._wish.deviation,
            "trust": trust,
            "full_braking": float(is_full),
            "door_weight": door_weight,
        }
        return np.array(taken)

    def _moved(self, time: float, v: float, omega: float) -> Array:
        """Return how the chair has moved since the last step, pose (3,), and note the motion."""
        before, last_v, last_omega = self._last
        self._last = (time, v, omega)
        if not math.isfinite(before):
            return np.zeros(3)
        dt = min(max(time - before, 0.0), 1.0)
        travel, turn = 0.5 * (v + last_v) * dt, 0.5 * (omega + last_omega) * dt
        self._wish.moved(travel, turn)
        half = 0.5 * turn
        return np.array([travel * math.cos(half), travel * math.sin(half), turn])

    def _slowed(self, target: tuple[float, float], v: float, omega: float) -> tuple[float, float]:
        """Return a target no faster than the region of the actual motion allows."""
        phi, norm = self._regions.polar(v, omega)
        _, wanted = self._regions.polar(*target)
        if norm < 10.0 * STILL or wanted < STILL:
            return target
        accelerating = math.copysign(1.0, v) * self._smooth.rates[0]
        limit = self._braking.comfortable(self._look.limit(phi), accelerating)
        if wanted <= limit:
            return target
        return limit / wanted * target[0], limit / wanted * target[1]

    def _take(
        self, target: tuple[float, float], v: float, omega: float
    ) -> tuple[tuple[float, float], bool]:
        """Take the best next command that a full braking can follow; say if it is one itself."""
        smooth, regions = self._smooth, self._regions
        phi, norm = regions.polar(*smooth.command)
        actual_phi, actual = regions.polar(v, omega)
        runaway = actual > norm + 2.0 * self._options.disobedience and (
            actual > self._look.limit(actual_phi) + 2.0 * self._options.disobedience
        )
        if not runaway:
            for goal in (target, self._slower(target), (0.0, 0.0)):
                proposed = smooth.proposed(*goal)
                if self._may(*proposed):
                    return smooth.take(*proposed), False
        less = 2.0 * regions.options.deceleration * smooth.period
        braked = regions.motion(phi, max(0.0, norm - less))
        return smooth.force(*braked), norm > 0.0

    def _slower(self, target: tuple[float, float]) -> tuple[float, float]:
        """Return a goal in the direction of the last command that is no faster than the target."""
        last = self._smooth.command
        phi, norm = self._regions.polar(*last)
        _, wanted = self._regions.polar(*target)
        if norm < STILL or last[0] * target[0] <= 0.0:
            return 0.0, 0.0
        limit = self._braking.comfortable(self._look.limit(phi))
        return bounded(self._regions, self._limits, phi, min(limit, norm, wanted), target)

    def _may(self, v: Smooth, omega: Smooth) -> bool:
        """Return whether a full braking can follow a command."""
        phi, norm = self._regions.polar(v.value, omega.value)
        return norm < 1e-9 or norm <= self._look.limit(phi)


def _check_fit(vehicle: Vehicle, regions: SafetyRegions, options: AssistantOptions) -> None:
    """Check that regions are this chair's, and allow for the delay there is.

    Between a step and the next, which may brake, a period passes; then the motors lag.
    """
    difference = regions.difference(vehicle)
    if difference:
        raise ShapeError(
            f"these safety regions belong to another chair than {vehicle.name}: {difference}"
        )
    delay = options.period + options.motor_lag
    if regions.options.latency < delay - 1e-9:
        raise ShapeError(
            f"the safety regions allow for a latency of {regions.options.latency:.3g} s, period "
            f"and motor lag are {delay:.3g} s: compute them with RegionOptions(latency=...)"
        )


def _pair(values: ArrayLike, otherwise: float) -> tuple[float, float]:
    """Return two numbers, those that are not finite replaced."""
    first, second = (float(value) for value in np.asarray(values, dtype=float).reshape(2))
    return (
        first if math.isfinite(first) else otherwise,
        second if math.isfinite(second) else otherwise,
    )
