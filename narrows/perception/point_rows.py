"""What the stages of a cloud accept: rows of finite points in single precision."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import ShapeError
from .depth_image import Points


def point_rows(points: Any) -> Points:
    """Return points as contiguous rows in single precision; not copied if they are that already.

    Raises:
        ShapeError: If they are not (N, 3), or one of them is not finite.
    """
    rows = np.ascontiguousarray(points, dtype=np.float32)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ShapeError(f"points must be (N, 3), got {rows.shape}")
    # NaN passes through a minimum, infinity is one.
    if len(rows) and not (np.isfinite(rows.min()) and np.isfinite(rows.max())):
        raise ShapeError("points must be finite; drop what is no return first")
    return rows
