"""What the stages of a cloud accept: rows of finite points in single precision."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ShapeError
from .compiled import compiled
from .depth_image import Points

_MAGNITUDE = 0x7FFFFFFF  # all bits of a float but its sign: they grow with it, NaN after infinity


def point_rows(points: Any) -> Points:
    """Return points as contiguous rows in single precision; not copied if they are that already.

    Raises:
        ShapeError: If they are not (N, 3), or one of them is not finite.
    """
    return rows_and_reach(points)[0]


def rows_and_reach(points: Any) -> tuple[Points, float]:
    """Return points as `point_rows`, and their greatest coordinate, either way [m]; 0 for none.

    Raises:
        ShapeError: If they are not (N, 3), or one of them is not finite.
    """
    with np.errstate(over="ignore"):  # what single precision cannot hold is not finite
        rows = np.ascontiguousarray(points, dtype=np.float32)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ShapeError(f"points must be (N, 3), got {rows.shape}")
    reach = float(np.uint32(_greatest(rows.reshape(-1).view(np.uint32))).view(np.float32))
    if not np.isfinite(reach):
        raise ShapeError("points must be finite; drop what is no return first")
    return rows, reach


@compiled
def _greatest(bits: NDArray[np.uint32]) -> np.uint32:
    greatest = np.uint32(0)
    for place in range(len(bits)):
        greatest = max(greatest, np.uint32(bits[place] & np.uint32(_MAGNITUDE)))
    return greatest
