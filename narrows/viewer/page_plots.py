"""Plots of a motion that follow its time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from viser import GuiApi, uplot

from narrows.se2 import Array

from . import palette
from .page_motion import Curve, Motion

_LINES = (palette.BLUE, palette.ORANGE, palette.GREEN, palette.PINK)


class Plots:
    """The curves of the motion that is played, each with an upright line at the time."""

    def __init__(self, gui: GuiApi) -> None:
        """Add the folder; nothing to plot yet."""
        self._gui = gui
        self._folder = gui.add_folder("Plots", visible=False)
        self._plots: list[Any] = []
        self._motion: Motion | None = None

    def load(self, motion: Motion | None) -> None:
        """Plot a motion; None: nothing."""
        for plot in self._plots:
            plot.remove()
        self._plots, self._motion = [], motion
        self._folder.visible = motion is not None
        if motion is not None:
            with self._folder:
                self._plots = [_plot(self._gui, motion, curve) for curve in motion.curves]

    def show(self, at: float) -> None:
        """Put the upright lines at a time [s]."""
        motion = self._motion
        if motion is not None:
            for plot, curve in zip(self._plots, motion.curves, strict=True):
                plot.data = curve_data(motion.times, curve.values, at, curve.most)


def curve_data(times: Array, values: Array, at: float, most: float = math.inf) -> tuple[Array, ...]:
    """Return times, the lines, and an upright line at a time, in arrays of one length.

    The upright line is two more rows at that time, where the lines themselves are interpolated.

    Args:
        times: Shape (N,), [s].
        values: Shape (N, L).
        at: Where the upright line stands [s].
        most: Where the upright line ends at the latest.
    """
    place = int(np.searchsorted(times, at))
    low, high = limits(values, most)
    here = np.array([np.interp(at, times, column) for column in values.T])
    lines = np.insert(values, [place, place], here, axis=0)
    upright = np.full(len(lines), np.nan)
    upright[place : place + 2] = low, high
    return (np.insert(times, [place, place], at), *np.ascontiguousarray(lines.T), upright)


def limits(values: Array, most: float = math.inf) -> tuple[float, float]:
    """Return the range a plot shows: all values up to `most`, and zero."""
    finite = values[np.isfinite(values)]
    low, high = min(0.0, finite.min(initial=0.0)), max(0.0, finite.max(initial=0.0))
    room = 0.05 * (high - low) or 1.0
    return float(low - room * (low < 0.0)), float(min(high + room, most))


def _plot(gui: GuiApi, motion: Motion, curve: Curve) -> Any:
    low, high = limits(curve.values, curve.most)
    series = [uplot.Series(label="t [s]")]
    for name, colour in zip(curve.names, _LINES, strict=False):
        series.append(
            uplot.Series(label=name, stroke=colour, width=2, points=uplot.Series_Points(show=False))
        )
    series.append(
        uplot.Series(
            label="now", stroke=palette.INK, width=2, points=uplot.Series_Points(show=False)
        )
    )
    return gui.add_uplot(
        data=curve_data(motion.times, curve.values, 0.0, curve.most),
        series=tuple(series),
        title=curve.title,
        scales={
            "x": uplot.Scale(time=False, auto=False, range=(0.0, motion.duration)),
            "y": uplot.Scale(range=(low, high)),
        },
        axes=(uplot.Axis(size=28), uplot.Axis(size=48)),
        legend=uplot.Legend(show=False),
        padding=(10, 10, 0, 0),
        height=125,
    )
