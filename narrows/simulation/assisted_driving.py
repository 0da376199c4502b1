"""A chair with somebody in it: driver, stick, and an assistant or none, as one controller."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from ..interfaces import Percept
from ..reactive.assistant import Assistant
from ..reactive.smooth_motion import SmoothMotion
from ..se2 import Array
from .assisted_driving_doors import DoorSense
from .driver_sticks import Stick
from .drivers import Driver
from .senses import Senses

_NOTHING = np.zeros((0, 3))


class Seat:
    """Where the driver sits: they see and feel the truth, the chair's sensors what they can.

    Given to `simulate` as the senses of a drive; hands on what the chair's own perceive.

    Attributes:
        pose: True pose at the last step, shape (3,), [m, m, rad].
        motion: True motion [v, omega] since the step before, shape (2,), [m/s, rad/s].
    """

    def __init__(self, senses: Senses | None = None) -> None:
        """Put a seat on a chair.

        Args:
            senses: The chair's; None: it perceives nothing, as a chair without assistant may.
        """
        self._senses = senses
        self._odometer = Odometer(1)
        self.pose = np.zeros(3)
        self.motion = np.zeros(2)

    def perceive(self, time: float, true_pose: Array, believed_pose: Array) -> Percept:
        """See `Senses`."""
        self.pose = np.array(true_pose, dtype=float)
        self.motion = self._odometer.motion(time, self.pose)
        if self._senses is None:
            return Percept(-math.inf, _NOTHING)
        return self._senses.perceive(time, true_pose, believed_pose)


class UnknownIsFree:
    """Senses that take for free what nothing is known of, as [DrivingAssistant]'s map does.

    Two scanners see little of what is beside the chair before it has driven past; an assistant
    that drives into no unknown place keeps further from what may be there.
    """

    def __init__(self, senses: Senses) -> None:
        """Put them before other senses."""
        self._senses = senses

    def perceive(self, time: float, true_pose: Array, believed_pose: Array) -> Percept:
        """See `Senses`."""
        seen = self._senses.perceive(time, true_pose, believed_pose)
        return Percept(seen.time, seen.points, seen.spread)


class Odometer:
    """How a chair moves, from how its pose changes over some periods."""

    def __init__(self, periods: int) -> None:
        """Begin at rest.

        Args:
            periods: Over how many steps; more are smoother and later.
        """
        self._periods = periods
        self._rows: list[tuple[float, float, float, float]] = []

    def motion(self, time: float, pose: ArrayLike) -> Array:
        """Return [v, omega], the mean since `periods` steps ago, shape (2,), [m/s, rad/s]."""
        x, y, heading = (float(value) for value in np.asarray(pose, dtype=float))
        self._rows = [*self._rows[-self._periods :], (time, x, y, heading)]
        before, x0, y0, heading0 = self._rows[0]
        dt = time - before
        if dt <= 0.0:
            return np.zeros(2)
        turned = math.remainder(heading - heading0, 2.0 * math.pi)
        middle = heading0 + 0.5 * turned
        half = 0.5 * turned
        chord = (x - x0) * math.cos(middle) + (y - y0) * math.sin(middle)
        travel = chord * (half / math.sin(half) if abs(half) > 1e-9 else 1.0)
        return np.array([travel / dt, turned / dt])


class AssistedDriving:
    """A driver's chair, with assistance or without; a `Controller`.

    Without an assistant the stick's commands go through the same limits of motion that the
    assistant keeps: "this module limited maximum speeds and accelerations to a common base"
    [DrivingAssistant, Section V-B].
    """

    def __init__(
        self,
        driver: Driver,
        stick: Stick,
        seat: Seat,
        mover: Assistant | SmoothMotion,
        *,
        doors: DoorSense | None = None,
    ) -> None:
        """Join them.

        Args:
            driver: Who drives.
            stick: What they hold or wear.
            seat: Where they sit; also the `senses` of the drive.
            mover: Turns what is indicated into commands: an assistant, or the limits alone; made
                for the control period of the drive.
            doors: Tells an assistant that helps through doors of the door ahead.
        """
        self._driver, self._stick, self._seat, self._mover = driver, stick, seat, mover
        self._doors = doors
        self._odometer = Odometer(2)
        self._signals: dict[str, float] = {}

    @property
    def progress(self) -> float:
        """The driver's."""
        return self._driver.progress

    @property
    def finished(self) -> bool:
        """Whether the driver is where they wanted to be."""
        return self._driver.finished

    @property
    def signals(self) -> Mapping[str, float]:
        """`v_indicated`, `omega_indicated`, and with an assistant its own."""
        return self._signals

    def step(self, time: float, pose: ArrayLike, percept: Percept) -> Array:
        """See `Controller`; the pose is odometry's, from which the chair knows how it moves."""
        position = self._driver.step(time, self._seat.pose, self._seat.motion)
        indicated = self._stick.command(position)
        if self._driver.finished:
            indicated = np.zeros(2)
        self._signals = {
            "v_indicated": float(indicated[0]),
            "omega_indicated": float(indicated[1]),
        }
        motion = self._odometer.motion(time, pose)
        if isinstance(self._mover, SmoothMotion):
            return self._mover.step(indicated)
        door = None if self._doors is None else self._doors.ahead(time, pose)
        command = self._mover.step(time, indicated, motion, percept, door=door)
        self._signals |= self._mover.signals
        return command
