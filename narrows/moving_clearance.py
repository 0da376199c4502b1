"""Clearance of a timed motion against a solid that moves."""

from __future__ import annotations

import math

import numpy as np

from .geometry import separation
from .motion_intervals import Intervals, support_bound
from .se2 import Array, transform
from .trajectory import Trajectory
from .world import MovingSolid

_FIRST_STEP = 0.1  # s
_ROUNDS = 20  # 0.1 s / 2^20 is 0.1 us
_FINEST = 1e-5  # m: contact and clearance below this are not told apart


def clearance_of_moving(
    solid: MovingSolid, body: Array, motion: Trajectory, tolerance: float
) -> tuple[float, float, float]:
    """Return a proven and an attained clearance of a body against a moving cylinder.

    Branch and bound over time as in `narrows.clearance`. Between two times the cylinder's centre
    lies on a segment of its path (intervals are cut at its rows), the body in its enclosure.

    Args:
        solid: The moving cylinder.
        body: Corners of a convex body in its own frame, shape (K, 2), [m].
        motion: The timed motion of the body origin.
        tolerance: Largest gap between the two figures [m].

    Returns:
        Proven lower bound [m], attained clearance [m], time of the latter [s].
    """
    start, end = _first_steps(solid, motion)
    least, when, proven = math.inf, 0.0, math.inf
    for _ in range(_ROUNDS):
        middle = 0.5 * (start + end)
        center = solid.position(middle)
        corners = transform(motion(middle), body)
        distance, axis = separation(corners, np.repeat(center[:, None], 2, axis=1))
        distance = distance - solid.radius
        if distance.min() < least:
            least, when = float(distance.min()), float(middle[distance.argmin()])
        ends = np.stack([solid.position(start), solid.position(end)], axis=1)
        support = np.einsum("nkd,nd->nk", ends, axis).min(axis=1) - solid.radius
        lower = support - _reach(motion, body, start, end, axis)
        allowed = tolerance if least <= 0.0 else max(min(tolerance, 0.5 * least), _FINEST)
        undecided = lower < least - allowed
        proven = min(proven, float(lower[~undecided].min(initial=math.inf)))
        if not undecided.any():
            return min(proven, least), least, when
        start, end, middle = start[undecided], end[undecided], middle[undecided]
        start, end = np.concatenate([start, middle]), np.concatenate([middle, end])
    return min(proven, float(lower[undecided].min())), least, when


def _first_steps(solid: MovingSolid, motion: Trajectory) -> tuple[Array, Array]:
    """Return time intervals cut where the solid turns or the motion's pieces end."""
    path = motion.path
    joints = [
        begin + section.progress_at(np.arange(section.pieces), np.ones(section.pieces))
        for begin, section in zip(path.section_bounds[:-1], path.sections, strict=True)
    ]
    cuts = np.concatenate(
        [
            np.arange(0.0, motion.duration, _FIRST_STEP),
            motion.profile.time_at(np.concatenate(joints)),
            motion.profile.breaks,
            solid.path[:, 0],
            [0.0, motion.duration],
        ]
    )
    cuts = np.unique(np.clip(cuts, 0.0, motion.duration))
    return cuts[:-1], cuts[1:]


def _reach(motion: Trajectory, body: Array, start: Array, end: Array, axis: Array) -> Array:
    """Return how far the body swept between two times reaches along an axis, (N,), [m]."""
    path = motion.path
    low, high = motion.progress(start), motion.progress(end)
    section = np.asarray(path.section_index(0.5 * (low + high)))
    piece = np.zeros(len(low), dtype=np.int64)
    parameters = np.zeros((2, len(low)))
    for k in np.unique(section):
        rows = np.flatnonzero(section == k)
        begin, part = path.section_bounds[k], path.sections[k]
        piece[rows], _ = part.locate(0.5 * (low[rows] + high[rows]) - begin)
        for side, progress in enumerate((low[rows], high[rows])):
            found, parameter = part.locate(progress - begin)
            parameter = np.where(found < piece[rows], 0.0, parameter)
            parameters[side, rows] = np.where(found > piece[rows], 1.0, parameter)
    intervals = Intervals(section, piece, parameters[0], parameters[1])
    enclosure = intervals.enclose(path.sections)
    return support_bound(body, enclosure, np.arange(len(low)), axis)
