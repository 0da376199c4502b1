"""Zero-order Sugeno inference on a rule table: memberships, rules, weighted mean."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..se2 import Array
from .fuzzy_table import RuleTable


def memberships(value: ArrayLike, peaks: Array) -> Array:
    """Return the degree to which a value belongs to each set, shape (..., K), summing to 1.

    Args:
        value: Values, shape (...).
        peaks: Peaks of the sets, shape (K,), increasing.
    """
    held: Array = np.clip(np.asarray(value, dtype=float), peaks[0], peaks[-1])
    upper = np.clip(np.searchsorted(peaks, held, side="right"), 1, len(peaks) - 1)
    share: Array = (held - peaks[upper - 1]) / (peaks[upper] - peaks[upper - 1])
    index = np.arange(len(peaks))
    rising: Array = np.where(index == upper[..., None], share[..., None], 0.0)
    return rising + np.where(index == upper[..., None] - 1, 1.0 - share[..., None], 0.0)


def outputs(table: RuleTable, distance: ArrayLike, angle: ArrayLike) -> Array:
    """Return the defuzzified outputs [left, right], shares of the top speed, shape (..., 2)."""
    near = memberships(distance, table.distances)  # (..., D)
    aside = memberships(angle, table.angles)  # (..., A)
    weights = aside[..., :, None] * near[..., None, :]  # (..., A, D), sums to 1
    return np.stack(
        [(weights * table.left).sum((-2, -1)), (weights * table.right).sum((-2, -1))], axis=-1
    )
