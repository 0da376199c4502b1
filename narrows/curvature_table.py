"""How a path bends: its curvature and the curvature's rate on a fine grid of progress."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import bezier
from .bezier_section import BezierSection
from .errors import ShapeError
from .se2 import Array
from .section import Section
from .twist_section import TwistSection

_CELLS = 128  # cells per cubic curve to begin with
_MOST_CELLS = 512
_PRECISION = (1e-3, 5e-3)  # error wanted of kappa and its rate, relative to their greatest values


@dataclass(frozen=True, eq=False)
class CurvatureTable:
    """d heading / d progress and its derivative, linear between nodes.

    Where the curvature jumps, two nodes have the same progress. On turns on the spot progress is
    the angle turned, and the value is +1 or -1.

    Attributes:
        progress: Progress at the nodes, not decreasing, shape (M,), [m] or [rad].
        kappa: d heading / d progress at the nodes, shape (M,), [1/m].
        rate: d kappa / d progress at the nodes, shape (M,), [1/m^2].
        kappa_error: Most the interpolated kappa is off from each node to the next, shape (M,),
            [1/m].
        rate_error: The same of the rate, shape (M,), [1/m^2].
        greatest: Greatest absolute curvature while travelling, turns on the spot left out [1/m].
    """

    progress: Array
    kappa: Array
    rate: Array
    kappa_error: Array
    rate_error: Array
    greatest: float

    @classmethod
    def of(cls, sections: Sequence[Section]) -> CurvatureTable:
        """Return the table of sections driven one after the other."""
        parts, begin = [], 0.0
        for section in sections:
            part = _section_table(section)
            parts.append((part, begin))
            begin += section.span
        return cls(
            np.concatenate([part.progress + begin for part, begin in parts]),
            np.concatenate([part.kappa for part, _ in parts]),
            np.concatenate([part.rate for part, _ in parts]),
            np.concatenate([part.kappa_error for part, _ in parts]),
            np.concatenate([part.rate_error for part, _ in parts]),
            max(part.greatest for part, _ in parts),
        )

    def __call__(self, progress: ArrayLike) -> tuple[Array, Array]:
        """Return kappa and its rate at progress (N,), each shape (N,).

        Where kappa jumps, the value before the jump.
        """
        cell, share = self._locate(progress)
        return self._between(self.kappa, cell, share), self._between(self.rate, cell, share)

    def with_errors(self, progress: ArrayLike) -> tuple[Array, Array, Array, Array]:
        """Return kappa, its rate, and the most each is off, at progress (N,), each (N,)."""
        cell, share = self._locate(progress)
        kappa, rate = (self._between(values, cell, share) for values in (self.kappa, self.rate))
        return kappa, rate, self.kappa_error[cell], self.rate_error[cell]

    def _locate(self, progress: ArrayLike) -> tuple[NDArray[np.int64], Array]:
        """Return the cell and the share of it that lies before progress, each shape (N,)."""
        s = np.asarray(progress, dtype=float)
        last = len(self.progress) - 2
        cell = np.clip(np.searchsorted(self.progress, s, side="left") - 1, 0, last)
        share = (s - self.progress[cell]) / self._widths[cell]
        return cell, np.clip(share, 0.0, 1.0)

    @staticmethod
    def _between(values: Array, cell: NDArray[np.int64], share: Array) -> Array:
        start = values[cell]
        return np.asarray(start + share * (values[cell + 1] - start))

    @property
    def _widths(self) -> Array:
        width = np.diff(self.progress)
        return np.where(width > 0.0, width, 1.0)

    def jumps(self) -> tuple[Array, Array]:
        """Return where kappa jumps and by how much, each shape (K,), [m], [1/m]."""
        step = np.diff(self.kappa)
        same = np.flatnonzero((np.diff(self.progress) <= 1e-12) & (np.abs(step) > 1e-6))
        return self.progress[same], step[same]


def _section_table(section: Section) -> CurvatureTable:
    if isinstance(section, TwistSection):
        return _twist_table(section)
    if isinstance(section, BezierSection):
        return _bezier_table(section)
    raise ShapeError(f"the curvature of a {type(section).__name__} is not known")


def _twist_table(section: TwistSection) -> CurvatureTable:
    """Return the table of constant twists: constant between poses, jumps at them."""
    pieces = np.arange(section.pieces)
    ends = section.progress_at(pieces, np.ones(section.pieces))
    turned = section.twists[:, 2]
    if section.direction == 0:
        kappa = np.sign(turned)
    else:
        kappa = turned / np.hypot(section.twists[:, 0], section.twists[:, 1])
    progress = np.column_stack([np.concatenate([[0.0], ends[:-1]]), ends]).ravel()
    greatest = 0.0 if section.direction == 0 else float(np.abs(kappa).max())
    both = np.repeat(kappa, 2)
    none = np.zeros_like(both)
    return CurvatureTable(progress, both, none, none, none, greatest)


def _bezier_table(section: BezierSection) -> CurvatureTable:
    """Return the table of cubic curves, its cells halved until the interpolation is precise."""
    cells = _CELLS
    while True:
        parameter = np.linspace(0.0, 1.0, cells + 1)
        progress, kappa, rate = _bends(section, parameter)
        errors = [_interpolation_error(progress, values) for values in (kappa, rate)]
        greatest = [max(float(np.abs(values).max()), 0.01) for values in (kappa, rate)]
        precise = all(
            e.max() <= p * g for e, p, g in zip(errors, _PRECISION, greatest, strict=True)
        )
        if precise or cells >= _MOST_CELLS:
            break
        cells *= 2
    return CurvatureTable(
        progress.ravel(),
        kappa.ravel(),
        rate.ravel(),
        errors[0].ravel(),
        errors[1].ravel(),
        _greatest(section, parameter, kappa),
    )


def _greatest(section: BezierSection, parameter: Array, kappa: Array) -> float:
    """Return the greatest absolute curvature, closing in on it from the greatest at nodes."""
    curve, node = np.unravel_index(np.abs(kappa).argmax(), kappa.shape)
    greatest, middle, reach = float(np.abs(kappa).max()), parameter[node], parameter[1]
    for _ in range(3):
        near = np.clip(middle + reach * np.linspace(-1.0, 1.0, 33), 0.0, 1.0)
        values = np.abs(bezier.curvature(section.control[curve], near))
        greatest = max(greatest, float(values.max()))
        middle, reach = near[values.argmax()], reach / 16.0
    return greatest


def _bends(section: BezierSection, parameter: Array) -> tuple[Array, Array, Array]:
    """Return progress, curvature and its rate at parameters (U,) of all curves, each (K, U)."""
    control = section.control[:, None]
    speed = np.linalg.norm(bezier.evaluate(control, parameter, 1), axis=-1)
    shape = (section.pieces, len(parameter))
    curve = np.repeat(np.arange(section.pieces), len(parameter))
    progress = section.progress_at(curve, np.tile(parameter, section.pieces)).reshape(shape)
    kappa = bezier.curvature(control, parameter)
    return progress, kappa, bezier.curvature_rate(control, parameter) / speed


def _interpolation_error(progress: Array, values: Array) -> Array:
    """Return the most that linear interpolation is off from each node to the next, (K, U).

    Every other of the U nodes, U odd, is compared with the line between its neighbours. With all
    nodes the error is a quarter of that (it falls with the square of the width); a half is on
    the safe side, and the greatest of three pairs of cells, where the error changes its sign.
    """
    left, right = values[:, :-2:2], values[:, 2::2]
    width = progress[:, 2::2] - progress[:, :-2:2]
    share = (progress[:, 1::2] - progress[:, :-2:2]) / width
    pair = 0.5 * np.abs(values[:, 1::2] - (left + share * (right - left)))
    near = pair.copy()
    near[:, 1:] = np.maximum(near[:, 1:], pair[:, :-1])
    near[:, :-1] = np.maximum(near[:, :-1], pair[:, 1:])
    cells = np.repeat(near, 2, axis=1)
    return np.concatenate([cells, cells[:, -1:]], axis=1)
