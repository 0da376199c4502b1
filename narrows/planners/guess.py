"""Rough manoeuvres to start the optimiser from."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from narrows.bezier_section import BezierSection
from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import Array
from narrows.world import Door

from .planning_clock import clock

_LEG = 0.45  # of the distance between two poses: a cubic's leg that bends gently
_SHORTEST = 0.05  # m: shortest leg a guess begins with
_ONE_PLACE = 0.01  # m: what is nearer is no curve but a turn, and left to the search


def direction_of(heading: float) -> Array:
    """Return the unit vector of a heading, shape (2,)."""
    return np.array([np.cos(heading), np.sin(heading)])


def curve_through(poses: ArrayLike) -> Path:
    """Return a forward path of one cubic between each two successive poses.

    Args:
        poses: Poses, shape (N, 3), N >= 2, [m, m, rad].
    """
    rows = np.asarray(poses, dtype=float)
    curves = []
    for first, last in pairwise(rows):
        leg = max(_LEG * float(np.linalg.norm(last[:2] - first[:2])), _SHORTEST)
        start, end = leg * direction_of(first[2]), leg * direction_of(last[2])
        curves.append([first[:2], first[:2] + start, last[:2] - end, last[:2]])
    return Path((BezierSection(np.array(curves)),))


def doors_between(scene: Scene) -> list[tuple[Door, float]]:
    """Return the doors whose plane parts start and goal, nearest first, with the heading through.

    A door counts when start and goal lie on different sides of it and the straight lines to its
    centre do not make more of a detour than twice the direct way.
    """
    start, goal = scene.start[:2], scene.goal.pose[:2]
    found = []
    for door in scene.world.doors:
        center = np.array(door.center)
        across = direction_of(door.heading)
        before, after = float((start - center) @ across), float((goal - center) @ across)
        way = float(np.linalg.norm(start - center) + np.linalg.norm(goal - center))
        if before * after < 0.0 and way <= 2.0 * float(np.linalg.norm(goal - start)):
            heading = door.heading if before < 0.0 else door.heading + np.pi
            found.append((way, door, heading))
    found.sort(key=lambda item: item[0])
    return [(door, heading) for _, door, heading in found]


def forward_guesses(scene: Scene) -> list[tuple[str, Path]]:
    """Return forward curves worth trying before any search.

    Through known doors; where there are none, one arc round a corner (`arc_guess`), and straight
    on, unless start and goal are one place.
    """
    guesses = [
        (
            "through the door",
            curve_through(np.stack([scene.start, [*door.center, heading], scene.goal.pose])),
        )
        for door, heading in doors_between(scene)[:2]
    ]
    if guesses:
        return guesses
    with clock.loading():
        from .arcs import arc_guess

    arc = arc_guess(scene)
    if arc is not None:
        guesses.append(("one arc", arc))
    if math.dist(scene.start[:2], scene.goal.pose[:2]) > _ONE_PLACE:
        guesses.append(("straight on", curve_through([scene.start, scene.goal.pose])))
    return guesses
