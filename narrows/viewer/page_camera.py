"""Where a scene is seen from, on the page and in its replays."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from narrows.scene import Scene

from .view_box import view_box

CUT = 0.8
"""Height at which walls from floor to ceiling are cut, so that one sees behind them [m]."""

_FOV = math.radians(40.0)
_TILT = 62.0  # degrees the camera looks down


@dataclass(frozen=True)
class Camera:
    """Where a scene is seen from.

    Attributes:
        position: Of the eye [m].
        look_at: What is in the middle [m].
        fov: Angle from the lower to the upper edge [rad].
    """

    position: tuple[float, float, float]
    look_at: tuple[float, float, float]
    fov: float = _FOV


def camera(scene: Scene, aspect: float = 1.2) -> Camera:
    """Return the nearest camera that sees the whole scene, from above and the south.

    Args:
        scene: What is to be seen.
        aspect: Width of the picture by its height.
    """
    x0, y0, x1, y1 = view_box(scene, [])
    middle = np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0])
    corners = np.array([[x, y, z] for x in (x0, x1) for y in (y0, y1) for z in (0.0, CUT)])
    down = math.radians(_TILT)
    ahead = np.array([0.0, math.cos(down), -math.sin(down)])
    upward = np.array([0.0, math.sin(down), math.cos(down)])
    off = corners - middle
    tangent = math.tan(0.5 * _FOV)
    needed = [np.abs(off @ upward) / tangent, np.abs(off[:, 0]) / (tangent * aspect)]
    distance = 1.04 * float((np.max(needed, axis=0) - off @ ahead).max())
    x, y, z = (middle - distance * ahead).tolist()
    return Camera((x, y, z), (float(middle[0]), float(middle[1]), 0.0))
