"""The figures of the [NarrowArcs] study: turns, radii, doors against corridors, drives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch

from narrows.path import Path
from narrows.se2 import Array
from narrows.vehicle import Vehicle
from narrows.world import World

from . import palette
from .motion_drawing import swept_area
from .scene_drawing import outline_of
from .study_axes import draw_body, draw_room, new_figure, study_style
from .view_box import ViewBox

_STYLE = study_style(12)
# Told apart by dashes too, for eyes and printers without colour.
_LINES: tuple[tuple[str, Any], ...] = (
    (palette.RED, (0, (6, 2))),
    (palette.BLUE, "-"),
    (palette.GREEN, (0, (3, 1.5, 1, 1.5))),
)


@dataclass(frozen=True, eq=False)
class DrawnTurn:
    """A turn with its swept body.

    Attributes:
        title: Its name.
        text: What is to be said of it, under the title.
        path: Line - arc - line.
        turn_start: Pose where the arc begins, shape (3,).
        touching: Point nearest to a wall, shape (2,), [m], or None.
    """

    title: str
    text: str
    path: Path
    turn_start: Array
    touching: Array | None = None


@dataclass(frozen=True, eq=False)
class DrawnCurve:
    """A curve with one point marked.

    Attributes:
        label: Its name.
        x: Abscissae, shape (N,).
        y: Ordinates, shape (N,).
        mark: The marked point, or None.
        text: What is said at it.
        offset: Of the text from the point, in points.
    """

    label: str
    x: Array
    y: Array
    mark: tuple[float, float] | None = None
    text: str = ""
    offset: tuple[float, float] = (10.0, 10.0)


def _draw_start(axes: Axes, pose: Array, vehicle: Vehicle, colour: str) -> None:
    draw_body(axes, pose, vehicle, colour)
    axes.plot(pose[0], pose[1], "o", color=colour, markersize=5, zorder=6)


def turns_figure(world: World, vehicle: Vehicle, turns: Sequence[DrawnTurn]) -> Figure:
    """Return the swept bodies of turns round one corner, side by side."""
    view: ViewBox = (-2.1, -0.15, 1.5, 3.4)
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(12.0, 5.0)
        panels = figure.subplots(1, len(turns), sharey=True, squeeze=False)[0]
        for axes, turn, (colour, style) in zip(panels, turns, _LINES, strict=False):
            draw_room(axes, world, view)
            patch = PathPatch(outline_of(swept_area(vehicle.outline, turn.path)))
            patch.set(facecolor=colour, alpha=0.22, edgecolor=colour, linewidth=1.0, zorder=0.8)
            axes.add_patch(patch)
            points = turn.path(np.linspace(0.0, turn.path.span, 300))
            axes.plot(points[:, 0], points[:, 1], color=colour, ls=style, linewidth=2.2, zorder=4)
            _draw_start(axes, turn.turn_start, vehicle, palette.INK)
            if turn.touching is not None:
                axes.plot(
                    *turn.touching, "o", color=palette.INK, ms=11, mfc="none", mew=1.8, zorder=7
                )
            axes.set_title(f"{turn.title}\n{turn.text}", fontsize=12)
        panels[0].set_ylabel("y [m]")
        title = "Round the corner of a 1.30 m corridor: swept body, body where it begins to turn"
        figure.suptitle(title, fontsize=13)
    return figure


def curves_figure(
    curves: Sequence[DrawnCurve], *, title: str, x: str, y: str, y_from: float, y_to: float
) -> Figure:
    """Return curves with their marks, the region below zero shaded where it is in view."""
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(12.0, 6.0)
        axes = figure.subplots()
        lines = (*_LINES, (palette.PINK, (0, (1.5, 1.2))), (palette.ORANGE, (0, (8, 2, 1, 2))))
        for curve, (colour, style) in zip(curves, lines, strict=False):
            axes.plot(curve.x, curve.y, color=colour, ls=style, linewidth=2.4, label=curve.label)
            if curve.mark is not None:
                axes.plot(*curve.mark, "o", color=colour, markersize=9, zorder=5)
                axes.annotate(
                    curve.text,
                    curve.mark,
                    curve.offset,
                    textcoords="offset points",
                    color=palette.INK,
                    fontsize=11,
                    zorder=6,
                    bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": colour},
                    arrowprops={"arrowstyle": "-", "color": colour},
                )
        axes.set_ylim(y_from, y_to)
        if y_from < 0.0:
            axes.axhspan(y_from, 0.0, color=palette.PALE, alpha=0.35, zorder=0)
            axes.axhline(0.0, color=palette.OUTLINE, linewidth=1.0)
        axes.margins(x=0.0)
        axes.grid(visible=True, color=palette.PALE, linewidth=0.6)
        axes.set_xlabel(x)
        axes.set_ylabel(y)
        axes.set_title(title, fontsize=13)
        axes.legend(loc="upper right", fontsize=11, framealpha=0.9)
    return figure


def executed_figure(
    world: World,
    vehicle: Vehicle,
    drives: Mapping[str, Sequence[Array]],
    clearances: Mapping[str, Array],
) -> Figure:
    """Return true drives after measuring, one panel for them and one for what they cleared.

    Args:
        world: The walls.
        vehicle: The chair.
        drives: True poses (N, 3) of some drives by the arc's name.
        clearances: Least clearance of all drives by the arc's name, shape (K,), [mm].
    """
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(12.0, 6.2)
        left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
        draw_room(left, world, (-2.1, -0.15, 1.5, 3.4))
        left.set_ylabel("y [m]")
        for (colour, style), (name, rows) in zip(_LINES, drives.items(), strict=False):
            for number, poses in enumerate(rows):
                label = name if number == 0 else None
                left.plot(poses[:, 0], poses[:, 1], color=colour, ls=style, lw=1.2, label=label)
            _draw_start(left, rows[0][0], vehicle, colour)
        left.legend(loc="upper left", fontsize=11, framealpha=0.95)
        left.set_title("drive axle, true; bodies where they measure", fontsize=12)
        everything = np.concatenate(list(clearances.values()))
        edges = np.arange(10.0 * np.floor(everything.min() / 10.0), everything.max() + 10.0, 5.0)
        for (colour, style), (name, values) in zip(_LINES, clearances.items(), strict=False):
            hits = int(np.count_nonzero(values <= 0.0))
            label = f"{name}: {hits} of {len(values)} touch"
            right.hist(values, edges, color=colour, alpha=0.35)
            right.hist(values, edges, histtype="step", color=colour, ls=style, lw=1.8, label=label)
        right.axvline(0.0, color=palette.INK, linewidth=1.2)
        right.axvspan(edges[0], 0.0, color=palette.PALE, alpha=0.35, zorder=0)
        right.set_xlim(edges[0], edges[-1])
        right.set_ylim(0.0, 1.35 * right.get_ylim()[1])  # room for the legend
        right.set_xlabel("least clearance of the true drive [mm]")
        right.set_ylabel("drives")
        right.legend(loc="upper right", fontsize=11, framealpha=0.95)
        right.set_title("what the drives cleared", fontsize=12)
    return figure
