"""The compiled loop from a depth image to points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .compiled import compiled

Image = NDArray[np.uint16] | NDArray[np.float32]


@compiled
def lift(image: Image, per_metre: np.float32, lens: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the valid pixels as points (N, 3); lens = [fx, fy, cx, cy] in pixels."""
    height, width = image.shape
    fx, fy, cx, cy = lens[0], lens[1], lens[2], lens[3]
    points = np.empty((height * width, 3), dtype=np.float32)
    xs, ys, zs = np.empty((3, width), dtype=np.float32)
    count = 0
    for row in range(height):
        v = np.float32(row)
        for column in range(width):
            z = np.float32(image[row, column]) / per_metre
            xs[column] = (np.float32(column) * z - cx * z) / fx
            ys[column] = (v * z - cy * z) / fy
            zs[column] = z
        for column in range(width):
            # Written whatever it is, kept if it is a return: no branch to guess wrong.
            points[count, 0], points[count, 1] = xs[column], ys[column]
            points[count, 2] = zs[column]
            count += int(zs[column] > 0.0)
    return points[:count]
