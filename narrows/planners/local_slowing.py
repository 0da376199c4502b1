"""The speed along a leg that bends: slow where it must be, and only there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from narrows.profile import Profile
from narrows.se2 import Array

from .averaging import Accelerated, Averaged
from .legs import MARGIN, Excess, Leg

_ROUNDS = 16
_SLACK = 1.0015  # of limits already reduced by MARGIN: within the true ones
_BENDING_SHARE = 0.9  # of the yaw acceleration that bending may take before speed is taken back


def varied_motion(leg: Leg, strongest: float) -> Profile:
    """Return jerk-limited progress whose speed follows the cap of each place.

    The fastest acceleration-limited motion under the cap is averaged over a window
    T = acceleration / jerk (see `averaging`). An average may exceed a cap that has a sharp
    minimum, and swings between speeding up and braking ask for up to twice the jerk: where
    that is so, and only there, cap or acceleration are lowered by what is in excess, and the
    motion is made again. What is left after a few rounds is for the caller to measure.

    Args:
        leg: The leg.
        strongest: Greatest acceleration to use, at most the leg's own.
    """
    jerk = MARGIN * leg.jerk
    window = strongest / jerk
    cap, pull = leg.cap.copy(), np.full(len(leg.cap) - 1, strongest)
    motion = Accelerated.fastest(leg.progress, cap, pull)
    for _ in range(_ROUNDS):
        average = Averaged.of(motion, window)
        excess = leg.excess(average.progress, average.speed, average.acceleration)
        swing = np.abs(average.jerk) / jerk
        if max(excess.speed.max(), excess.yaw.max(), swing.max()) <= _SLACK:
            break
        cap /= _at_nodes(leg, average, _too_fast(excess))
        pull *= _eased(motion, average, _too_strong(excess, swing), window)
        motion = Accelerated.fastest(leg.progress, cap, pull)
    return Averaged.of(motion.merged(), window).profile()


def _too_fast(excess: Excess) -> Array:
    """Return by what to divide the cap at the samples, shape (N,)."""
    over = np.where(excess.yaw > 1.0, excess.bending / _BENDING_SHARE, 1.0)
    return np.asarray(np.fmax(np.fmax(excess.speed, np.sqrt(over)), 1.0))


def _too_strong(excess: Excess, swing: Array) -> Array:
    """Return by what to multiply the acceleration at the samples, at most 1, shape (N,)."""
    bending = np.minimum(excess.bending, _BENDING_SHARE)
    wanted = (1.0 - bending) / np.maximum(excess.yaw - bending, 1e-9)
    factor = np.where(excess.yaw > 1.0, np.minimum(wanted, 1.0), 1.0)
    gentle = 1.0 / np.maximum(swing, 1.0)
    factor[:-1] = np.minimum(factor[:-1], gentle)
    factor[1:] = np.minimum(factor[1:], gentle)
    return np.maximum(factor, 0.2)


def _at_nodes(leg: Leg, average: Averaged, factor: Array) -> Array:
    """Return the greatest factor of the samples next to each node of the leg, shape (N + 1,)."""
    cells = len(leg.progress) - 1
    cell = np.clip((average.progress / leg.span * cells).astype(np.int64), 0, cells - 1)
    greatest = np.ones(cells)
    np.maximum.at(greatest, cell, factor)
    return np.asarray(np.maximum(np.append(greatest, 1.0), np.insert(greatest, 0, 1.0)))


def _eased(motion: Accelerated, average: Averaged, factor: Array, window: float) -> Array:
    """Return the least factor of the samples that average over each cell, shape (N,).

    What is driven at t enters the averages from t to t + window.
    """
    first = np.searchsorted(average.times, motion.times[:-1], side="left")
    end = np.searchsorted(average.times, motion.times[1:] + window, side="right")
    return least_in_ranges(factor, first, end)


def least_in_ranges(values: Array, first: NDArray[np.int64], end: NDArray[np.int64]) -> Array:
    """Return the least of values[first:end] for each of N ranges, none empty, shape (N,).

    From the least of all runs of 1, 2, 4, ... values: two such runs cover a range.
    """
    runs = [values]
    while 2 ** len(runs) <= len(values):
        half = 2 ** (len(runs) - 1)
        least = runs[-1].copy()
        least[:-half] = np.minimum(least[:-half], runs[-1][half:])
        runs.append(least)
    level = np.frexp(end - first)[1] - 1  # the greatest power of two within
    table = np.stack(runs)
    return np.asarray(np.minimum(table[level, first], table[level, end - 2**level]))
