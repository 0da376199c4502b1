"""The compiled loop that makes of exact inverse depths what a structured-light camera returns."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..perception.compiled import compiled
from ..se2 import Array


@compiled
def sensor_image(
    inverse: Array,
    noise: NDArray[np.float32],
    deviation: float,
    lens: Array,
    limits: Array,
    step: float,
    millimetres: NDArray[np.uint16],
) -> None:
    """Turn exact inverse depths into what the sensor returns [mm]; 0: no return.

    Args:
        inverse: Exact inverse depths, shape (height, width), [1/m].
        noise: Standard normal numbers, the same shape; shape (0, 0): none. NaN: a return lost.
        deviation: What they are multiplied by, then added to the inverse depths [1/m].
        lens: fx, fy, cx, cy [px].
        limits: Inverse depths of the furthest and the nearest return [1/m], greatest step in
            slope of an inverse depth between neighbours, as a share of it, cosine of the greatest
            incidence, the projector's distance to the right of the camera [m]; shape (5,).
        step: Step of the quantisation [1/m].
        millimetres: Overwritten with the image.
    """
    height, width = inverse.shape
    noisy = noise.shape[0] > 0
    disparity = lens[0] * limits[4]
    for v in range(height):
        y = (v - lens[3]) / lens[1]
        leftmost = np.inf  # column the projector sees furthest left so far, from the right
        for u in range(width - 1, -1, -1):
            w = inverse[v, u]
            millimetres[v, u] = 0
            projected = u - disparity * w
            shadowed = projected >= leftmost
            leftmost = min(leftmost, projected)
            if shadowed or not (w >= limits[0] and w <= limits[1]):
                continue
            before, after = inverse[v, max(u - 1, 0)], inverse[v, min(u + 1, width - 1)]
            above, below = inverse[max(v - 1, 0), u], inverse[min(v + 1, height - 1), u]
            if u > 0 and u + 1 < width and abs(before + after - 2.0 * w) > limits[2] * w:
                continue
            if v > 0 and v + 1 < height and abs(above + below - 2.0 * w) > limits[2] * w:
                continue
            x = (u - lens[2]) / lens[0]
            a = lens[0] * _gentler(before, w, after, u > 0, u + 1 < width)
            b = lens[1] * _gentler(above, w, below, v > 0, v + 1 < height)
            c = w - a * x - b * y
            grazing = limits[3] * limits[3] * (a * a + b * b + c * c) * (x * x + y * y + 1.0)
            if w * w < grazing:
                continue
            seen = w + deviation * noise[v, u] if noisy else w
            level = np.rint(seen / step)
            if level > 0.0:  # not for NaN
                millimetres[v, u] = np.uint16(min(np.rint(1e3 / (step * level)), 65535.0))


@compiled
def _gentler(before: float, here: float, after: float, has_before: bool, has_after: bool) -> float:
    """Return the smaller slope to a neighbour: that along the surface, not across its edge."""
    back, ahead = here - before, after - here
    if not has_before:
        return ahead if has_after else 0.0
    if not has_after:
        return back
    return back if abs(back) < abs(ahead) else ahead
