"""Rough manoeuvres to start the optimiser from."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from narrows.bezier_section import BezierSection
from narrows.errors import ShapeError
from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import Array, wrap
from narrows.section import Section
from narrows.world import Door

from .manoeuvre_shape import Manoeuvre
from .spline import Spline

_LEG = 0.45  # of the distance between two poses: a cubic's leg that bends gently
_SAMPLES = 161
_SHIFT = 0.1  # share of a section's length by which its end may be moved aside
_SHORTEST = 0.05  # m: shortest leg a guess begins with


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
    on.
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
    from .arcs import arc_guess

    arc = arc_guess(scene)
    if arc is not None:
        guesses.append(("one arc", arc))
    return [*guesses, ("straight on", curve_through([scene.start, scene.goal.pose]))]


def fitted(path: Path, scene: Scene, segments: int) -> Manoeuvre:
    """Return the splines nearest to a path's driven sections, in the least-squares sense.

    The nodes are the scene's start, the ends of the path's sections, and the scene's goal (where
    the last section is short, the path's own end if that will do); legs and control points
    between are fitted at parameters equal in arc length.

    Args:
        path: A path without turns on the spot, from the start to near the goal.
        scene: The scene; its start and goal replace the path's ends.
        segments: Cubic pieces of each section.

    Raises:
        ShapeError: If the path turns on the spot.
    """
    directions = path.directions
    if (directions == 0).any():
        raise ShapeError("a path that turns on the spot is not one of splines")
    nodes = path(path.section_bounds)
    off = float(np.linalg.norm(nodes[-1, :2] - scene.goal.pose[:2]))
    is_moved = off <= _SHIFT * path.sections[-1].span or off > scene.goal.position_tolerance
    if is_moved:
        nodes[-1, :2] = scene.goal.pose[:2]
    nodes[:, 2] += 2.0 * np.pi * np.rint((scene.start[2] - path.start[2]) / (2.0 * np.pi))
    nodes[0] = scene.start
    if is_moved:
        nodes[-1, 2] += wrap(scene.goal.pose[2] - nodes[-1, 2])
    spline = Spline(segments)
    controls = [
        _fit(_positions(section), nodes[k], nodes[k + 1], int(directions[k]), spline)
        for k, section in enumerate(path.sections)
    ]
    return Manoeuvre(np.asarray(directions, dtype=np.int64), nodes, np.array(controls))


def _positions(section: Section) -> Array:
    """Return positions along a section, equal in arc length, shape (N, 2), [m]."""
    return section.evaluate(np.linspace(0.0, section.span, _SAMPLES))[:, :2]


def _fit(points: Array, first: Array, last: Array, direction: int, spline: Spline) -> Array:
    """Return the spline's control points nearest to points, ends and end tangents held."""
    basis = spline.basis(np.linspace(0.0, 1.0, len(points)))
    ahead, back = direction * direction_of(first[2]), direction * direction_of(last[2])
    free = spline.count - 4
    matrix = np.zeros((2 * len(points), 2 + 2 * free))
    for axis in (0, 1):
        matrix[axis::2, 0] = basis[:, 1] * ahead[axis]
        matrix[axis::2, 1] = -basis[:, -2] * back[axis]
        for j in range(free):
            matrix[axis::2, 2 + 2 * j + axis] = basis[:, 2 + j]
    held = (basis[:, 0] + basis[:, 1])[:, None] * first[:2]
    held = held + (basis[:, -1] + basis[:, -2])[:, None] * last[:2]
    solution = np.linalg.lstsq(matrix, (points - held).ravel(), rcond=None)[0]
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    even = length / (3.0 * spline.segments)  # the legs of an even parametrisation
    legs = np.maximum(solution[:2], min(_SHORTEST, 0.5 * even))
    between = solution[2:].reshape(-1, 2)
    ends = [first[:2], first[:2] + legs[0] * ahead, last[:2] - legs[1] * back, last[:2]]
    return np.vstack([ends[:2], between, ends[2:]])
