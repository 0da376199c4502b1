"""Joysticks for the hand and for the head: from a deflection to the command it indicates."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..se2 import Array
from .smooth_motion import MotionLimits


@dataclass(frozen=True)
class Axis:
    """One axis of an input device: nothing inside a dead zone, then in proportion, then full.

    Attributes:
        dead_zone: Deflection up to which nothing is commanded.
        full: Deflection from which on everything is; the same unit.
        exponent: 1: in proportion; above: finer near the dead zone.
    """

    dead_zone: float
    full: float
    exponent: float = 1.0

    def __post_init__(self) -> None:
        """Check the order."""
        if not 0.0 <= self.dead_zone < self.full < math.inf:
            raise ShapeError(
                f"an axis needs 0 <= dead zone < full, got {self.dead_zone} and {self.full}"
            )
        if not 0.2 <= self.exponent <= 5.0:
            raise ShapeError(f"exponent must lie between 0.2 and 5, got {self.exponent}")

    def share(self, deflection: float) -> float:
        """Return the share of the full command, -1 to 1; 0 for what is not finite.

        >>> axis = Axis(dead_zone=0.25, full=1.0)
        >>> axis.share(0.25), axis.share(-0.625), axis.share(3.0)
        (0.0, -0.5, 1.0)
        """
        if not math.isfinite(deflection):
            return 0.0
        beyond = (abs(deflection) - self.dead_zone) / (self.full - self.dead_zone)
        shaped = min(max(beyond, 0.0), 1.0) ** self.exponent
        return math.copysign(shaped, deflection) if shaped > 0.0 else 0.0

    def deflection(self, share: float) -> float:
        """Return the least deflection that commands a share, -1 to 1; 0 for none."""
        if share == 0.0:
            return 0.0
        beyond = min(abs(share), 1.0) ** (1.0 / self.exponent)
        return math.copysign(self.dead_zone + beyond * (self.full - self.dead_zone), share)


@dataclass(frozen=True)
class Joystick:
    """A proportional joystick: forward commands speed, sideways the heading rate.

    To the left always turns left, backwards too: a stick that turned the other way in reverse would
    jump where it passes from forward to backward.

    "The deflection of the joystick maps proportional onto the direction and the velocities of the
    wheelchair" [DrivingAssistant, Sec. IV].

    Attributes:
        limits: What full deflection commands.
        forward: Axis of speed, deflection 0 to 1.
        sideways: Axis of the heading rate.
    """

    limits: MotionLimits
    forward: Axis = field(default_factory=lambda: Axis(0.05, 1.0))
    sideways: Axis = field(default_factory=lambda: Axis(0.05, 1.0))

    def command(self, deflection: ArrayLike) -> Array:
        """Return the command [v, omega], shape (2,), [m/s, rad/s].

        Args:
            deflection: Forward and to the left, shape (2,); the stick moves in a disc of radius 1,
                and what lies outside counts as on its edge.
        """
        ahead, left = _two(deflection, "a deflection must be [forward, left]")
        length = math.hypot(ahead, left)
        if length > 1.0:
            ahead, left = ahead / length, left / length
        return _command(self.limits, self.forward.share(ahead), self.sideways.share(left))

    def deflection(self, command: ArrayLike) -> Array:
        """Return the deflection that indicates a command, as far as the stick goes, shape (2,)."""
        forward, left = _shares(self.limits, command)
        stick = np.array([self.forward.deflection(forward), self.sideways.deflection(left)])
        return stick / max(1.0, float(np.linalg.norm(stick)))


@dataclass(frozen=True)
class HeadJoystick:
    """A head joystick: nodding commands speed, tilting to a shoulder the heading rate.

    "Still able to observe the environment by turning the head around the free yaw-axis ... the
    user's head movements around the remaining two axes must exceed a so-called dead-zone"
    [DrivingAssistant, Sec. IV]. The angles are not printed; these are assumed.

    Attributes:
        limits: What full deflection commands.
        pitch: Axis of speed [rad].
        roll: Axis of the heading rate [rad].
        neutral_pitch: Pitch of a head at rest [rad].
    """

    limits: MotionLimits
    pitch: Axis = field(default_factory=lambda: Axis(math.radians(6.0), math.radians(25.0)))
    roll: Axis = field(default_factory=lambda: Axis(math.radians(6.0), math.radians(25.0)))
    neutral_pitch: float = 0.0

    def command(self, posture: ArrayLike) -> Array:
        """Return the command [v, omega], shape (2,), [m/s, rad/s].

        Args:
            posture: Pitch, positive with the face down, and roll, positive towards the right
                shoulder, shape (2,), [rad]. The yaw commands nothing.
        """
        pitch, roll = _two(posture, "a posture must be [pitch, roll]")
        return _command(
            self.limits, self.pitch.share(pitch - self.neutral_pitch), -self.roll.share(roll)
        )

    def posture(self, command: ArrayLike) -> Array:
        """Return the posture [pitch, roll] that indicates a command, shape (2,), [rad]."""
        forward, left = _shares(self.limits, command)
        pitch = self.neutral_pitch + self.pitch.deflection(forward)
        return np.array([pitch, -self.roll.deflection(left)])


def head_posture(head_to_chair: ArrayLike) -> Array:
    """Return pitch and roll of a head from its sensor's rotation, shape (2,), [rad].

    The rotation is Rz(yaw) Ry(pitch) Rx(roll): pitch and roll are what is left when the head is
    turned back by its yaw, so looking round commands nothing. Straight up or down, at a pitch of
    90 degrees, yaw and roll cannot be told apart and roll counts as zero.

    Args:
        head_to_chair: Rotation matrix, x to where the face looks, y left, z up, shape (3, 3).
    """
    rotation = np.asarray(head_to_chair, dtype=float)
    if rotation.shape != (3, 3):
        raise ShapeError(f"a rotation must have shape (3, 3), got {rotation.shape}")
    sine, cosine = -rotation[2, 0], math.hypot(rotation[2, 1], rotation[2, 2])
    roll = math.atan2(rotation[2, 1], rotation[2, 2]) if cosine > 1e-9 else 0.0
    return np.array([math.atan2(sine, cosine), roll])


def _two(values: ArrayLike, problem: str) -> tuple[float, float]:
    """Return two numbers, those that are not finite as zero."""
    pair = np.asarray(values, dtype=float)
    if pair.shape != (2,):
        raise ShapeError(f"{problem}, got shape {pair.shape}")
    first, second = (value if math.isfinite(value) else 0.0 for value in pair.tolist())
    return first, second


def _command(limits: MotionLimits, forward: float, left: float) -> Array:
    """Return the command of shares of the limits."""
    top = limits.speed if forward >= 0.0 else limits.reverse_speed
    return np.array(limits.clipped(forward * top, left * limits.yaw_rate))


def _shares(limits: MotionLimits, command: ArrayLike) -> tuple[float, float]:
    """Return shares of the limits, forward and to the left."""
    v, omega = _two(command, "a command must be [v, omega]")
    top = limits.speed if v >= 0.0 else limits.reverse_speed
    forward = v / top if top > 0.0 else 0.0
    return forward, omega / limits.yaw_rate
