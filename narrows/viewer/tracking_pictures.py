"""The figures of the tracking study: errors along plans, deviations under disturbances, drives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import Array, transform

from . import palette
from .study_axes import draw_room, new_figure, study_style
from .view_box import ViewBox

_STYLE = study_style(11)
# Told apart by shape and dashes too, for eyes and printers without colour.
_LOOKS: tuple[tuple[str, str, Any], ...] = (
    (palette.BLUE, "o", "-"),
    (palette.ORANGE, "s", (0, (6, 2))),
    (palette.GREEN, "^", (0, (3, 1.5, 1, 1.5))),
    (palette.PINK, "D", (0, (1.5, 1.2))),
    (palette.INK, "v", (0, (8, 2, 2, 2))),
)


@dataclass(frozen=True, eq=False)
class DrawnDrive:
    """A drive of a plan.

    Attributes:
        tracker: Who drove.
        poses: True poses, shape (N, 3), [m, m, rad].
        progress: Progress claimed, shape (N,).
        cross_track: Distance from the path, shape (N,), [m].
    """

    tracker: str
    poses: Array
    progress: Array
    cross_track: Array


@dataclass(frozen=True)
class Spread:
    """How far the body got from the plan under a disturbance, over plans and seeds.

    Attributes:
        tracker: Who drove.
        mean: Mean of the drives' greatest deviations [mm].
        low: Lower end of its interval [mm].
        high: Upper end [mm].
        worst: Greatest of all [mm].
    """

    tracker: str
    mean: float
    low: float
    high: float
    worst: float


def errors_figure(drives: Mapping[str, Sequence[DrawnDrive]]) -> Figure:
    """Return cross-track errors along plans, a panel each, nominal chair."""
    with matplotlib.rc_context(_STYLE):
        rows = -(-len(drives) // 2)
        figure = new_figure(11.0, 3.0 * rows + 0.6)
        panels = figure.subplots(rows, 2, squeeze=False).ravel()
        for axes, (plan, driven) in zip(panels, drives.items(), strict=False):
            for (colour, _, dashes), one in zip(_LOOKS, driven, strict=False):
                axes.plot(
                    one.progress,
                    1e3 * one.cross_track,
                    color=colour,
                    linestyle=dashes,
                    linewidth=1.4,
                    label=one.tracker,
                )
            _finish(axes, plan, "progress [m or rad]", "cross-track error [mm]")
        for axes in panels[len(drives) :]:
            axes.set_axis_off()
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def spreads_figure(spreads: Mapping[str, Sequence[Spread]]) -> Figure:
    """Return the deviations under every disturbance: mean with its interval, and the worst."""
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(11.0, 0.62 * len(spreads) + 1.6)
        axes = figure.subplots()
        for row, several in enumerate(spreads.values()):
            places = row + np.linspace(-0.28, 0.28, max(len(several), 2))
            for place, (colour, marker, _), one in zip(places, _LOOKS, several, strict=False):
                error = [[one.mean - one.low], [one.high - one.mean]]
                axes.errorbar(
                    [one.mean],
                    [place],
                    xerr=error,
                    color=colour,
                    marker=marker,
                    markersize=6,
                    linewidth=1.6,
                    capsize=2.5,
                    label=one.tracker if row == 0 else None,
                )
                axes.plot([one.worst], [place], color=colour, marker="|", markersize=11)
            if row % 2:
                axes.axhspan(row - 0.5, row + 0.5, color=palette.PALE, alpha=0.25, linewidth=0)
        axes.set_xscale("log")
        axes.set_yticks(range(len(spreads)), list(spreads))
        axes.invert_yaxis()
        title = "mean over plans and seeds with its 95 % interval; bar: the worst drive"
        _finish(axes, title, "greatest deviation of a corner of the body [mm]", "")
        figure.legend(loc="outside upper center", ncols=len(_LOOKS))
    return figure


def drives_figure(
    drives: Mapping[str, tuple[Scene, Path, Sequence[DrawnDrive]]], title: str
) -> Figure:
    """Return plans between their solids, the body along them, and how they were driven."""
    with matplotlib.rc_context(_STYLE):
        rows = -(-len(drives) // 2)
        figure = new_figure(11.0, 5.0 * rows)
        panels = figure.subplots(rows, 2, squeeze=False).ravel()
        for axes, (plan, (scene, path, driven)) in zip(panels, drives.items(), strict=False):
            _draw_scene(axes, scene, path)
            for (colour, _, dashes), one in zip(_LOOKS, driven, strict=False):
                axes.plot(
                    *one.poses[:, :2].T,
                    color=colour,
                    linestyle=dashes,
                    linewidth=1.6,
                    label=one.tracker,
                    zorder=4,
                )
            axes.set_title(plan, fontsize=11)
        for axes in panels[len(drives) :]:
            axes.set_axis_off()
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), title=title)
    return figure


def _draw_scene(axes: Axes, scene: Scene, path: Path) -> None:
    corners = transform(path(np.linspace(0.0, path.span, 60)), scene.vehicle.outline)
    low, high = corners.min(axis=(0, 1)) - 0.35, corners.max(axis=(0, 1)) + 0.35
    view: ViewBox = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    draw_room(axes, scene.world, view)
    for body in corners[::6]:
        closed = np.concatenate([body, body[:1]])
        axes.plot(*closed.T, color=palette.OUTLINE, linewidth=0.7, alpha=0.6, zorder=2)


def _finish(axes: Axes, title: str, abscissa: str, ordinate: str) -> None:
    axes.set_title(title, fontsize=11)
    axes.set_xlabel(abscissa)
    axes.set_ylabel(ordinate)
    axes.grid(visible=True, color=palette.PALE, linewidth=0.6)
