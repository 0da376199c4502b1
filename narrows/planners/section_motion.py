"""Poses along one section's spline."""

from __future__ import annotations

import numpy as np

from narrows.se2 import Array

from .spline import Spline


class SectionMotion:
    """The motion of a section: poses at parameters in [0, 1].

    Attributes:
        spline: The basis.
        control: Control points, shape (count, 2), [m].
        direction: +1 or -1.
    """

    def __init__(self, spline: Spline, control: Array, direction: int) -> None:
        """Keep the curve."""
        self.spline, self.control, self.direction = spline, control, direction

    def __call__(self, parameter: Array) -> Array:
        """Return the poses at parameters (N,), shape (N, 3), [m, m, rad]."""
        return self.placed(self.spline.basis(parameter), self.spline.basis(parameter, 1))

    def placed(self, basis: Array, slopes: Array) -> Array:
        """Return the poses where the weights and their derivatives are these, each (N, count)."""
        slope = self.direction * (slopes @ self.control)
        pose = np.empty((len(basis), 3))
        pose[:, :2] = basis @ self.control
        pose[:, 2] = np.arctan2(slope[:, 1], slope[:, 0])
        return pose

    @property
    def powers(self) -> Array:
        """Coefficients of x and y by powers of the parameter in each piece, (segments, 4, 2)."""
        return self.spline.powers(self.control)
