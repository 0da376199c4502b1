"""From the poses and moves of a search to a path of constant twists."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from ..path import Path
from ..se2 import Array
from ..twist_section import TwistSection

_LONGEST_TURN = 0.5 * math.pi  # a piece's twist is read off its ends: no half turns


def path_of(poses: Array, drives: Array, start: Array, *, at_rest: bool = False) -> Path:
    """Return the path through poses; moves that continue each other become one piece.

    Args:
        poses: In driving order, shape (N, 3); the first is the start but for whole turns.
        drives: v, heading rate and length of the move to each pose but the first, (N - 1, 3).
        start: The start, shape (3,); headings are counted from it.
        at_rest: End a section wherever the curvature changes, so that the chair stops there: a
            chair in motion cannot change its heading rate in no time.
    """
    poses = poses + np.array(
        [0.0, 0.0, 2.0 * math.pi * round((start[2] - poses[0, 2]) / (2 * math.pi))]
    )
    keep: list[int] = [0]
    marks: list[tuple[float, float]] = []
    turned = 0.0
    for k, (v, omega, length) in enumerate(drives):
        turned += abs(omega * length)
        mark = (v, round(omega, 9))
        if marks and marks[-1] == mark and turned <= _LONGEST_TURN:
            keep[-1] = k + 1
        else:
            keep.append(k + 1)
            marks.append(mark)
            turned = abs(omega * length)
    ends = [0]
    for k, (before, after) in enumerate(pairwise(marks), start=1):
        if before[0] != after[0] or (before != after and (at_rest or after[0] == 0.0)):
            ends.append(k)
    ends.append(len(marks))
    kept = poses[keep]
    return Path(tuple(TwistSection(kept[a : b + 1]) for a, b in pairwise(ends)))
