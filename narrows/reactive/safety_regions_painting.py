"""Paints safety regions: direction by direction, over errors, speeds, castors and time."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..geometry import offset_polygon
from ..se2 import Array
from .braking_kernels import braking_poses
from .part_kernels import paint_parts
from .safety_regions import RegionOptions, protected
from .safety_regions_kernels import NEVER, paint_direction

_NEIGHBOURHOODS = (0.4, 0.15, 0.05, 0.02, 0.0)
"""How far from where the nominal body passes a cell still gets its part [m], widest first."""


def painted(
    outline: Array,
    track: float,
    norms: Array,
    options: RegionOptions,
    report: Callable[[float], None] | None,
) -> tuple[Array, NDArray[np.uint8], NDArray[np.uint8]]:
    """Return the grid's lower corner, levels and parts as in `SafetyRegions`.

    Args:
        outline: The chair's outline, shape (K, 2), [m].
        track: Its track [m].
        norms: Speed norms of the levels, shape (L,), [m/s].
        options: What the regions allow for.
        report: Called with the share done.
    """
    body = np.ascontiguousarray(protected(outline, options))
    faster = 1.0 + 2.0 * options.speed_error
    rim = 0.5 * float(norms[-1]) * faster
    stop = rim * options.latency + rim * rim / (2.0 * options.deceleration)
    reach = float(np.linalg.norm(body, axis=1).max()) + stop
    half = math.ceil(reach / options.cell) + 2
    lower = np.full(2, -half * options.cell)
    shape = (options.directions, 2 * half, 2 * half)
    levels, parts = np.full(shape, NEVER, dtype=np.uint8), np.zeros(shape, dtype=np.uint8)
    bodies = [np.ascontiguousarray(offset_polygon(body, grown)) for grown in _NEIGHBOURHOODS]
    poses = np.empty((4 * options.pose_samples, 3))
    scratch = np.empty_like(body)
    for k in range(options.directions):
        motions, timing = motions_of(k, track, options)
        paint_direction(
            levels[k], motions, norms, timing, body, lower, options.cell,
            options.castor_samples, options.pose_samples,
        )  # fmt: skip
        v, omega = motions[1] * norms[-1]
        duration = 0.5 * float(norms[-1]) / timing[1]
        braking_poses(v, omega, duration, options.latency, 1.0, poses)
        for grown in bodies:
            paint_parts(parts[k], poses, grown, lower, options.cell, scratch)
        if report is not None and (k % 16 == 0 or k == options.directions - 1):
            report((k + 1) / options.directions)
    return _cropped(lower, levels, parts, options.cell)


def motions_of(index: int, track: float, options: RegionOptions) -> tuple[Array, Array]:
    """Return what a direction's region allows for: motions, and the timing of their braking.

    An error of each wheel of a share e of the faster one's speed m turns the direction by at most
    e max(c, s) (c + s) <= 1.21 e, c and s being |cos phi| and |sin phi|, and raises the norm by at
    most 2 e m. A region also serves the directions half a step to both sides.

    Returns:
        [v, omega] per unit of speed norm, at one end of the errors, without, and at the other,
        shape (3, 2), and latency [s] and deceleration for the nominal norm [m/s^2], shape (2,).
    """
    step = 2.0 * math.pi / options.directions
    centre = index * step
    c, s = abs(math.cos(centre)), abs(math.sin(centre))
    turned = options.speed_error * 0.5 * (1.0 + math.sqrt(2.0)) + 0.5 * step
    faster = 1.0 + 2.0 * options.speed_error * (max(c, s) + step) / (c + s)
    phi = centre + np.array([-turned, 0.0, turned])
    left, right = np.cos(phi), np.sin(phi)
    scale = faster / (np.abs(left) + np.abs(right))
    motions = np.stack([0.5 * scale * (left + right), scale * (right - left) / track], axis=-1)
    return motions, np.array([options.latency, options.deceleration / faster])


def _cropped(
    lower: Array, levels: NDArray[np.uint8], parts: NDArray[np.uint8], cell: float
) -> tuple[Array, NDArray[np.uint8], NDArray[np.uint8]]:
    """Return the tables without the rows and columns no region reaches."""
    reached = (levels != NEVER).any(axis=0)
    rows, columns = np.flatnonzero(reached.any(axis=1)), np.flatnonzero(reached.any(axis=0))
    part = np.s_[:, rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    corner = lower + cell * np.array([rows[0], columns[0]])
    return corner, levels[part].copy(), parts[part].copy()
