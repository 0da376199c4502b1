"""What a driver holds or wears: where it must be for a command, and what command it then gives.

Positions are [forward, left], each -1 to 1: shares of the stick's way, or of the angle from which
on a head commands all there is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..reactive.joystick import HeadJoystick, Joystick
from ..reactive.smooth_motion import MotionLimits
from ..se2 import Array


class Stick(Protocol):
    """Any input device, as its driver knows it."""

    def command(self, position: ArrayLike) -> Array:
        """Return the command [v, omega] of a position, shape (2,), [m/s, rad/s]."""
        ...

    def reach(self, v: float, omega: float) -> tuple[float, float]:
        """Return the position [forward, left] that a trained driver puts it to for a command."""
        ...


@dataclass(frozen=True)
class HandStick:
    """A proportional joystick.

    Attributes:
        joystick: Its dead zones and what full deflection commands.
    """

    joystick: Joystick

    def command(self, position: ArrayLike) -> Array:
        """See `Stick`."""
        return self.joystick.command(position)

    def reach(self, v: float, omega: float) -> tuple[float, float]:
        """See `Stick`."""
        forward, left = self.joystick.deflection([v, omega]).tolist()
        return forward, left


@dataclass(frozen=True)
class HeadStick:
    """A head joystick: forward is nodding, left is tilting to the left shoulder.

    Attributes:
        joystick: Its dead zones and what they command.
    """

    joystick: HeadJoystick

    def command(self, position: ArrayLike) -> Array:
        """See `Stick`."""
        return self.joystick.command(np.asarray(position, dtype=float) * self._full)

    def reach(self, v: float, omega: float) -> tuple[float, float]:
        """See `Stick`."""
        forward, left = (self.joystick.posture([v, omega]) / self._full).tolist()
        return forward, left

    @property
    def _full(self) -> Array:
        return np.array([self.joystick.pitch.full, -self.joystick.roll.full])


def make_stick(device: str, limits: MotionLimits) -> Stick:
    """Return an input device by its name: `joystick` or `head-joystick`.

    Raises:
        InputError: If there is no such device.
    """
    if device == "joystick":
        return HandStick(Joystick(limits))
    if device == "head-joystick":
        return HeadStick(HeadJoystick(limits))
    raise InputError("no such input device", value=device, allowed="joystick or head-joystick")
