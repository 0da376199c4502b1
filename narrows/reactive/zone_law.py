"""The control laws of [FuzzyDVZ], Eqs. (21) and (22): what a deformed zone asks of the chair."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import ShapeError
from .deformable_zone import Deformation


@dataclass(frozen=True)
class ZoneGains:
    """Gains and limits of the zone's law.

    The defaults suit the default grid and a zone squashed to 0.3: an obstacle of 0.6 m width spans
    0.4 rad of latitude at 1 m, so that I, j and J_alpha are about 0.4 of those of a flat zone.

    Attributes:
        speed: K_V [m^2/s^3].
        turning: K_r1 [rad/s].
        braking: Greatest rate at which the law takes speed away [m/s^2].
        speeding: Greatest rate at which it gives speed [m/s^2].
        slow: Speed below which F_obs / (j V) is held [m/s]: it has no limit at V = 0.
    """

    speed: float = 3.0
    turning: float = 30.0
    braking: float = 1.0
    speeding: float = 0.5
    slow: float = 0.1

    def __post_init__(self) -> None:
        """Check that all are positive."""
        for name, value in self.__dict__.items():
            if not 0.0 < value < math.inf:
                raise ShapeError(f"zone gain {name} must be a positive number, got {value}")


def zone_law(deformation: Deformation, speed: float, gains: ZoneGains) -> tuple[float, float]:
    """Return V' and omega of [FuzzyDVZ, Eqs. (21), (22)] as corrected, [m/s^2, rad/s].

    V' = -K_V J_V I - (F_rob / J_V) V - F_obs / J_V with J_V = j V: the second term is -F_rob / j,
    finite at V = 0; the third is divided by j max(V, `slow`). V' is limited, and never negative
    at V = 0: the law does not reverse. omega = -K_r1 J_alpha I. F_obs is (22); where nothing is
    known to move it is 0, (21).

    Args:
        deformation: Now; without an intruded ray the law asks for nothing.
        speed: V, >= 0, [m/s].
        gains: Gains and limits.
    """
    if deformation.rays == 0:
        return 0.0, 0.0
    j = deformation.by_speed
    change = -gains.speed * j * speed * deformation.intrusion
    if j > 0.0:
        change -= deformation.by_driving / j
        change -= deformation.by_others / (j * max(speed, gains.slow))
    change = min(max(change, -gains.braking), gains.speeding)
    if speed <= 0.0:
        change = max(change, 0.0)
    return change, -gains.turning * deformation.by_heading * deformation.intrusion
