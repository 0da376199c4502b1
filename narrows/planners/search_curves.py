"""Shortest connections of two poses that ignore obstacles: arc, line, arc; turn, line, turn."""

from __future__ import annotations

import math

from ..se2 import Array
from .compiled import compiled

LONGEST_TURN = 1.4 * math.pi
"""Arcs that turn further only make loops [rad]."""


@compiled
def turn_between(side: int, first: float, last: float) -> float:
    """Return the angle turned to one side (+1 left) from a heading to another, in [0, 2 pi)."""
    turned = (side * (last - first)) % (2.0 * math.pi)
    return 0.0 if turned > 2.0 * math.pi - 1e-7 else turned


@compiled
def arc_line_arc(
    x: float,
    y: float,
    heading: float,
    goal: Array,
    v: float,
    radius: float,
    word: int,
    drives: Array,
) -> float:
    """Write the drive arc, line, arc between two poses; return its length or infinity.

    The arcs' circles have the given radius and lie on the sides that `word` says; the line
    touches both: Dubins' CSC words; in reverse, those of the chair facing backwards.

    Args:
        x: Position at the start [m].
        y: The same.
        heading: Heading at the start [rad].
        goal: x, y, heading at the end, shape (3,) or longer.
        v: +1 forward, -1 in reverse.
        radius: Radius of the arcs [m]; 0: turns on the spot.
        word: 0..3 for left-left, right-right, left-right, right-left.
        drives: Written: rows v, heading rate, length of the three parts, shape (3, 3).
    """
    first = 1 if word == 0 or word == 2 else -1
    last = 1 if word == 0 or word == 3 else -1
    back = 0.0 if v > 0 else math.pi
    begin, end = heading + back, goal[2] + back
    dx = goal[0] - x - radius * (last * math.sin(end) - first * math.sin(begin))
    dy = goal[1] - y + radius * (last * math.cos(end) - first * math.cos(begin))
    line = math.sqrt(dx * dx + dy * dy)
    course = math.atan2(dy, dx) if line > 1e-9 else begin
    if first != last:
        squared = line * line - 4.0 * radius * radius
        if squared < 0.0:
            return math.inf
        line = math.sqrt(squared)
        course += first * math.atan2(2.0 * radius, line)
    before = turn_between(first, begin, course)
    after = turn_between(last, course, end)
    if before > LONGEST_TURN or after > LONGEST_TURN:
        return math.inf
    on_spot = radius == 0.0
    drives[0, 0] = drives[2, 0] = 0.0 if on_spot else v
    drives[0, 1], drives[2, 1] = first, last
    drives[0, 2], drives[2, 2] = before, after
    if not on_spot:
        for k in (0, 2):
            drives[k, 1] /= radius
            drives[k, 2] *= radius
    drives[1, 0], drives[1, 1], drives[1, 2] = v, 0.0, line
    return float(drives[0, 2] + drives[1, 2] + drives[2, 2])
