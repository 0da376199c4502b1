"""The fuzzy goal controller of [FuzzyDVZ]: wheel speeds from the target's distance and bearing.

A zero-order Sugeno system. The membership functions are triangles between neighbouring peaks, with
shoulders at the ends, so they sum to one; with the product for AND, the weighted mean of the rules'
outputs is the bilinear interpolation of the rule table.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..se2 import Array
from .fuzzy_inference import outputs
from .fuzzy_orbits import Orbit, check_orbits
from .fuzzy_table import DERIVED, RuleTable, read_rule_table


def polar_error(pose: ArrayLike, target: ArrayLike) -> tuple[float, float]:
    """Return the target's distance and its bearing from the chair's heading.

    d = sqrt((x_T - x_R)^2 + (y_T - y_R)^2), phi = atan2(y_T - y_R, x_T - x_R) - alpha_R wrapped to
    (-pi, pi]. [FuzzyDVZ, Eqs. (3)-(5)] with the sign under the root, atan2 for atan, and the wrap
    restored. At the target the bearing is 0.

    >>> polar_error([0.0, 0.0, 0.0], [-1.0, 0.0])
    (1.0, 3.141592653589793)

    Args:
        pose: Pose of the chair, shape (3,), [m, m, rad].
        target: The target, shape (2,), [m].
    """
    x, y, heading = (float(value) for value in np.asarray(pose, dtype=float))
    along, across = (float(value) for value in np.asarray(target, dtype=float))
    along, across = along - x, across - y
    distance = math.hypot(along, across)
    if distance == 0.0:
        return 0.0, 0.0
    angle = math.remainder(math.atan2(across, along) - heading, 2.0 * math.pi)
    return distance, (angle if angle > -math.pi else math.pi)


class FuzzyGoalController:
    """Drives to a point; the heading there is whatever comes out. Never reverses.

    Attributes:
        table: The rules.
        track: Distance between the drive wheels [m].
        speed: Rim speed of the output 1 [m/s].
        orbits: The circles about the target; all of them repel.
    """

    def __init__(
        self, table: RuleTable | Path | str = DERIVED, *, track: float = 0.6, speed: float = 0.8
    ) -> None:
        """Read the rules if need be, and check that no orbit about the target holds the chair.

        Args:
            table: The rules, or the file they are in.
            track: Distance between the drive wheels [m].
            speed: Rim speed of the output 1 [m/s].

        Raises:
            InputError: If a number is out of range, the file cannot be read, or a chair driven by
                the rules can circle its target for ever or stand still before it; says where.
        """
        for name, value in (("track", track), ("speed", speed)):
            if not 0.0 < value < math.inf:
                raise InputError("must be a positive number", field=name, value=value)
        self.table = table if isinstance(table, RuleTable) else read_rule_table(table)
        self.track, self.speed = float(track), float(speed)
        self.orbits: tuple[Orbit, ...] = check_orbits(self.table, self.track)

    def wheel_speeds(self, distance: ArrayLike, angle: ArrayLike) -> Array:
        """Return the rim speeds [v_left, v_right], shape (..., 2), [m/s].

        Args:
            distance: Distance of the target, shape (...), >= 0, [m].
            angle: Its bearing from the heading, shape (...), within -pi..pi, [rad].
        """
        return self.speed * outputs(self.table, distance, angle)

    def command(self, pose: ArrayLike, target: ArrayLike) -> Array:
        """Return the command [v, omega] towards a target, shape (2,), [m/s, rad/s].

        v = (V_R + V_L) / 2, omega = (V_R - V_L) / L, [FuzzyDVZ, Eq. (1)].

        Args:
            pose: Pose of the chair, shape (3,), [m, m, rad].
            target: The target, shape (2,), [m].
        """
        left, right = self.wheel_speeds(*polar_error(pose, target)).tolist()
        return np.array([0.5 * (left + right), (right - left) / self.track])
