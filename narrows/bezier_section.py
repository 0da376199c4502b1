"""A section of composite cubic Bezier curves, by arc length."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import bezier
from .errors import ShapeError
from .se2 import Array, wrap
from .section import Enclosure

JOINT_TOLERANCE = 1e-6
"""Largest gap [m] or bend [rad] at a joint: rounding and solver tolerance, 1 um at 1 m."""

_TABLE = 32  # arc-length table entries per curve; Newton's method does the rest
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)


@dataclass(frozen=True, eq=False)
class BezierSection:
    """Cubic curves joined end to end, tangents continuous, driven one way.

    The heading is the direction of the tangent, plus pi in reverse.

    Attributes:
        control: Control points of each curve, shape (K, 4, 2), [m].
        direction: +1 forward, -1 reverse.
    """

    control: Array
    direction: int = 1

    def __post_init__(self) -> None:
        """Check the joints; keep a read-only copy."""
        control = np.array(self.control, dtype=float)
        if control.ndim != 3 or control.shape[1:] != (4, 2) or not len(control):
            raise ShapeError(f"control must be (K >= 1, 4, 2), got {control.shape}")
        if not np.isfinite(control).all():
            raise ShapeError("control points must be finite numbers")
        if self.direction not in (1, -1):
            raise ShapeError(f"direction must be +1 or -1, got {self.direction}")
        gap = np.abs(control[1:, 0] - control[:-1, 3])
        if len(gap) and gap.max() > JOINT_TOLERANCE:
            raise ShapeError(f"curves do not join: gap of {gap.max():.3g} m")
        control.setflags(write=False)
        object.__setattr__(self, "control", control)
        speed = np.linalg.norm(self._table_velocity, axis=-1)
        if speed.min() <= 1e-6 * max(float(speed.max()), 1e-9):
            raise ShapeError("a curve stands still: its heading is undefined there")
        bend = np.abs(wrap(np.diff(self._joint_angles, axis=0)))
        if bend.size and bend.max() > JOINT_TOLERANCE:
            raise ShapeError(f"curves join with a bend of {bend.max():.3g} rad")

    @cached_property
    def _table_parameter(self) -> Array:
        return np.linspace(0.0, 1.0, _TABLE + 1)

    @cached_property
    def _table_velocity(self) -> Array:
        """Derivative by the parameter at the table's entries, (K, T + 1, 2)."""
        return bezier.evaluate(self.control[:, None], self._table_parameter, 1)

    @cached_property
    def _joint_angles(self) -> Array:
        """Tangent angles where successive curves meet, (2, K - 1)."""
        velocity = self._table_velocity
        ends = np.stack([velocity[:-1, -1], velocity[1:, 0]])
        return np.arctan2(ends[..., 1], ends[..., 0])

    def _length_between(self, curve: NDArray[np.int64], start: Array, end: Array) -> Array:
        """Return the arc length between two parameters by Gauss-Legendre quadrature, (N,)."""
        half = 0.5 * (end - start)
        u = start[:, None] + half[:, None] * (1.0 + _NODES)
        velocity = bezier.evaluate(self.control[curve][:, None], u, 1)
        return np.asarray(half * (np.linalg.norm(velocity, axis=-1) @ _WEIGHTS))

    @cached_property
    def _table_length(self) -> Array:
        """Arc length at the table's entries from the section's start, (K, T + 1)."""
        count = len(self.control)
        curve = np.repeat(np.arange(count), _TABLE)
        start = np.tile(self._table_parameter[:-1], count)
        end = np.tile(self._table_parameter[1:], count)
        total = np.cumsum(self._length_between(curve, start, end)).reshape(count, _TABLE)
        first = np.concatenate([[0.0], total[:-1, -1]])
        return np.concatenate([first[:, None], total], axis=1)

    @cached_property
    def _table_tangent(self) -> Array:
        """Tangent angle at the table's entries, unwrapped along the section, (K, T + 1)."""
        angle = np.arctan2(self._table_velocity[..., 1], self._table_velocity[..., 0])
        return np.unwrap(angle.ravel()).reshape(angle.shape)

    @property
    def span(self) -> float:
        """Arc length [m]."""
        return float(self._table_length[-1, -1])

    @property
    def pieces(self) -> int:
        """Number of cubic curves."""
        return len(self.control)

    def locate(self, progress: Array) -> tuple[NDArray[np.int64], Array]:
        """Return the curve and its parameter at arc lengths (N,), by Newton's method."""
        s = np.clip(progress, 0.0, self.span)
        ends = self._table_length[:, -1]
        curve = np.minimum(np.searchsorted(ends, s, side="left"), len(ends) - 1)
        table = self._table_length[curve]
        entry = np.clip((table[:, 1:] < s[:, None]).sum(axis=1), 0, _TABLE - 1)
        rows = np.arange(len(s))
        s0, s1 = table[rows, entry], table[rows, entry + 1]
        u0 = self._table_parameter[entry]
        u = u0 + (s - s0) / np.where(s1 > s0, s1 - s0, 1.0) / _TABLE
        for _ in range(3):
            velocity = bezier.evaluate(self.control[curve], u, 1)
            error = s0 + self._length_between(curve, u0, u) - s
            u = np.clip(u - error / np.linalg.norm(velocity, axis=-1), 0.0, 1.0)
        return curve, u

    def _heading(self, curve: NDArray[np.int64], parameter: Array) -> Array:
        velocity = bezier.evaluate(self.control[curve], parameter, 1)
        angle = np.arctan2(velocity[:, 1], velocity[:, 0])
        entry = np.clip(np.rint(parameter * _TABLE).astype(np.int64), 0, _TABLE)
        near = self._table_tangent[curve, entry]
        unwrapped = near + wrap(angle - near)
        return np.asarray(unwrapped if self.direction > 0 else unwrapped + np.pi)

    def evaluate(self, progress: ArrayLike, order: int = 0) -> Array:
        """Return the pose or its derivative by arc length; see `narrows.section.Section`.

        Order 1 is (cos phi, sin phi, kappa) with phi the tangent's angle, order 2 is
        (-kappa sin phi, kappa cos phi, d kappa / ds).
        """
        s = np.asarray(progress, dtype=float)
        curve, u = self.locate(s.ravel())
        control = self.control[curve]
        velocity = bezier.evaluate(control, u, 1)
        speed = np.linalg.norm(velocity, axis=-1)
        tangent = velocity / speed[:, None]
        if order == 0:
            position = bezier.evaluate(control, u)
            result = np.column_stack([position, self._heading(curve, u)])
        elif order == 1:
            result = np.column_stack([tangent, bezier.curvature(control, u)])
        elif order == 2:
            kappa = bezier.curvature(control, u)
            normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
            rate = bezier.curvature_rate(control, u) / speed
            result = np.column_stack([kappa[:, None] * normal, rate])
        else:
            raise ShapeError(f"the order of a section's derivative is 0, 1 or 2, got {order}")
        return result.reshape(*s.shape, 3)

    def progress_at(self, piece: NDArray[np.int64], parameter: Array) -> Array:
        """Return the arc length at parameters of curves, shape (N,), [m]."""
        entry = np.minimum((parameter * _TABLE).astype(np.int64), _TABLE - 1)
        start = self._table_parameter[entry]
        partial = self._length_between(piece, start, parameter)
        return np.asarray(self._table_length[piece, entry] + partial)

    def enclose(self, piece: NDArray[np.int64], low: Array, high: Array) -> Enclosure:
        """Return bounds on poses: hulls of the control points and of the hodograph's.

        A curve lies in the hull of its control points; its tangent is a positive combination of
        the hodograph's control vectors, so its angle lies between theirs while they span less
        than a half turn. Where they span more, the heading is unknown (a full turn).
        """
        part = bezier.segment(self.control[piece], low, high)  # (N, 4, 2)
        legs = _hodograph_between(self.control[piece], low, high)  # (N, 3, 2)
        middle = 0.5 * (low + high)
        position = bezier.evaluate(self.control[piece], middle)
        heading = self._heading(piece, middle)
        tangent = heading if self.direction > 0 else heading - np.pi
        angle = wrap(np.arctan2(legs[..., 1], legs[..., 0]) - tangent[:, None])
        wide = (np.abs(angle) >= 0.5 * np.pi).any(axis=1) | (
            np.linalg.norm(legs, axis=-1) == 0.0
        ).any(axis=1)
        least = np.where(wide, -np.pi, np.minimum(angle.min(axis=1), 0.0))
        most = np.where(wide, np.pi, np.maximum(angle.max(axis=1), 0.0))
        return Enclosure(
            part, np.column_stack([position, heading]), heading + least, heading + most
        )


def _hodograph_between(control: Array, low: Array, high: Array) -> Array:
    """Return the control points of the tangent between two parameters, shape (N, 3, 2).

    The blossom of the derivative: unlike differences of a short part's own control points, it
    keeps its digits however near the two parameters are, and is the tangent where they are equal.
    """
    first, second, third = np.moveaxis(bezier.derivative(control), 1, 0)  # (N, 2) each

    def blossom(s: Array, t: Array) -> Array:
        s, t = s[:, None], t[:, None]
        mixed = s * (1.0 - t) + t * (1.0 - s)
        return np.asarray((1.0 - s) * (1.0 - t) * first + mixed * second + s * t * third)

    return np.stack([blossom(low, low), blossom(low, high), blossom(high, high)], axis=1)
