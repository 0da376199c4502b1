"""The splines nearest to a rough path."""

from __future__ import annotations

import numpy as np

from narrows.errors import ShapeError
from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import Array, wrap
from narrows.section import Section

from .manoeuvre_shape import Manoeuvre
from .spline import Spline

_SAMPLES = 161
_SHORTEST = 0.05  # m: shortest leg a guess begins with, less where the section is short
_RIDGE = 1e-13  # keeps curves that double back on themselves solvable
_SHIFT = 0.1  # share of a section's length by which its end may be moved aside


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
    ahead, back = direction * _ahead(first[2]), direction * _ahead(last[2])
    free = spline.count - 4
    matrix = np.zeros((2 * len(points), 2 + 2 * free))
    for axis in (0, 1):
        matrix[axis::2, 0] = basis[:, 1] * ahead[axis]
        matrix[axis::2, 1] = -basis[:, -2] * back[axis]
        for j in range(free):
            matrix[axis::2, 2 + 2 * j + axis] = basis[:, 2 + j]
    held = (basis[:, 0] + basis[:, 1])[:, None] * first[:2]
    held = held + (basis[:, -1] + basis[:, -2])[:, None] * last[:2]
    # Normal equations, x and y in turn: larger products and `lstsq` wake threads that only wait.
    gram = matrix[0::2].T @ matrix[0::2] + matrix[1::2].T @ matrix[1::2]
    gram = gram + _RIDGE * np.trace(gram) * np.eye(len(gram))
    solution = np.linalg.solve(gram, matrix.T @ (points - held).ravel())
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    even = length / (3.0 * spline.segments)  # the legs of an even parametrisation
    legs = np.maximum(solution[:2], min(_SHORTEST, 0.5 * even))
    between = solution[2:].reshape(-1, 2)
    ends = [first[:2], first[:2] + legs[0] * ahead, last[:2] - legs[1] * back, last[:2]]
    return np.vstack([ends[:2], between, ends[2:]])


def _ahead(heading: float) -> Array:
    return np.array([np.cos(heading), np.sin(heading)])
