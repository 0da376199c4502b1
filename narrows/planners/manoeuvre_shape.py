"""A manoeuvre as control points, and as the unknowns of its program."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from narrows.bezier_section import BezierSection
from narrows.errors import ShapeError
from narrows.path import Path
from narrows.se2 import Array

from .body_program import Layout
from .spline import Spline

SHORTEST_LEG = 1e-3
"""Shortest leg at a node [m]; keeps the heading there defined."""


@dataclass(frozen=True, eq=False)
class Manoeuvre:
    """Sections of spline control points, driven one way each.

    Attributes:
        directions: +1 or -1 for each section, shape (K,).
        nodes: Poses where sections meet, shape (K + 1, 3), headings continuous, [m, m, rad].
        controls: Control points of each section's spline, shape (K, count, 2), [m].
    """

    directions: NDArray[np.int64]
    nodes: Array
    controls: Array


class ManoeuvreShape:
    """From unknowns to control points, with derivatives, for one start and sequence of directions.

    Attributes:
        layout: Where the unknowns stand.
        directions: +1 or -1 for each section, shape (K,).
        start: The first node, shape (3,), [m, m, rad].
        spline: The sections' basis.
    """

    def __init__(self, layout: Layout, directions: NDArray[np.int64], start: Array) -> None:
        """Keep what stays the same."""
        self.layout, self.directions, self.start = layout, directions, start
        self.spline = Spline(layout.segments)

    def unknowns(self, manoeuvre: Manoeuvre) -> Array:
        """Return the unknowns of a manoeuvre, slacks zero, shape (size,).

        Raises:
            ShapeError: If its control points do not fit the layout.
        """
        expected = (len(self.directions), self.spline.count, 2)
        if manoeuvre.controls.shape != expected:
            raise ShapeError(f"controls must be {expected}, got {manoeuvre.controls.shape}")
        x = np.zeros(self.layout.size)
        for k, control in enumerate(manoeuvre.controls):
            x[3 * k : 3 * k + 3] = manoeuvre.nodes[k + 1]
            legs = np.linalg.norm([control[1] - control[0], control[-1] - control[-2]], axis=1)
            legs = np.maximum(legs, SHORTEST_LEG)
            x[self.layout.section(k)] = [*legs, *control[2:-2].ravel()]
        return x

    def controls(self, x: Array) -> list[Array]:
        """Return the control points of every section, each (count, 2)."""
        controls, first = [], self.start
        for k, direction in enumerate(self.directions):
            last, own = x[3 * k : 3 * k + 3], x[self.layout.section(k)]
            ends = [
                first[:2],
                first[:2] + own[0] * direction * _ahead(first[2]),
                last[:2] - own[1] * direction * _ahead(last[2]),
                last[:2],
            ]
            controls.append(np.vstack([ends[:2], own[2:].reshape(-1, 2), ends[2:]]))
            first = last
        return controls

    def path(self, x: Array) -> Path:
        """Return the path of the unknowns."""
        return Path(
            tuple(
                BezierSection(self.spline.to_bezier(control), int(direction))
                for control, direction in zip(self.controls(x), self.directions, strict=True)
            )
        )

    def derivative(self, x: Array, k: int) -> Array:
        """Return the derivative of a section's control points, shape (2 count, size)."""
        count, own = self.spline.count, self.layout.section(k).start
        direction = self.directions[k]
        result = np.zeros((2 * count, self.layout.size))
        free = np.arange(4, 2 * count - 4)
        result[free, own + 2 + free - 4] = 1.0
        for leg, side, rows in ((0, 1.0, (0, 2)), (1, -1.0, (2 * count - 2, 2 * count - 4))):
            node = 3 * (k - 1 + leg)
            heading = x[node + 2] if node >= 0 else self.start[2]
            ahead = side * direction * _ahead(heading)
            tip = slice(rows[1], rows[1] + 2)
            result[tip, own + leg] = ahead
            if node >= 0:
                for row in rows:
                    result[row, node] = result[row + 1, node + 1] = 1.0
                result[tip, node + 2] = x[own + leg] * np.array([-ahead[1], ahead[0]])
        return result

    def carried(self, jacobian: Array, x: Array, k: int) -> Array:
        """Return derivatives (N, 2 count) by a section's control points as those by the unknowns.

        As `jacobian @ derivative(x, k)`, without the zeros.
        """
        count, own = self.spline.count, self.layout.section(k).start
        result = np.zeros((len(jacobian), self.layout.size))
        result[:, own + 2 : own + 2 + 2 * (count - 4)] = jacobian[:, 4:-4]
        direction, last = self.directions[k], 2 * count - 2
        for leg, side, end, tip in ((0, 1.0, 0, 2), (1, -1.0, last, last - 2)):
            node = 3 * (k - 1 + leg)
            ahead = side * direction * _ahead(x[node + 2] if node >= 0 else self.start[2])
            along_x, along_y = jacobian[:, tip], jacobian[:, tip + 1]
            result[:, own + leg] = along_x * ahead[0] + along_y * ahead[1]
            if node >= 0:
                result[:, node] = jacobian[:, end] + along_x
                result[:, node + 1] = jacobian[:, end + 1] + along_y
                across = along_y * ahead[0] - along_x * ahead[1]
                result[:, node + 2] = x[own + leg] * across
        return result

    def bending(self, x: Array, k: int, gradient: Array) -> Array:
        """Return sum_j gradient_j d^2 C_j, shape (size, size), for a gradient (2 count,) by C."""
        own, size = self.layout.section(k).start, self.layout.size
        direction, result = self.directions[k], np.zeros((size, size))
        for leg, side, tip in ((0, 1.0, slice(2, 4)), (1, -1.0, slice(-4, -2))):
            node = 3 * (k - 1 + leg)
            if node < 0:
                continue
            ahead = side * direction * _ahead(x[node + 2])
            across = float(gradient[tip] @ np.array([-ahead[1], ahead[0]]))
            result[own + leg, node + 2] += across
            result[node + 2, own + leg] += across
            result[node + 2, node + 2] -= x[own + leg] * float(gradient[tip] @ ahead)
        return result


def _ahead(heading: float) -> Array:
    return np.array([np.cos(heading), np.sin(heading)])
