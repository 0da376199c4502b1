"""The figures of the driving-assistant study: tracks over the map, doors by where one starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from narrows.se2 import Array

from . import palette
from .study_axes import new_figure, study_style

_STYLE = study_style(11)
# Told apart by dashes too, for eyes and printers without colour.
_LINES: tuple[tuple[str, Any], ...] = (
    (palette.BLUE, "-"),
    (palette.ORANGE, "-"),
    (palette.GREEN, "-"),
    (palette.PINK, "-"),
    (palette.SKY, (0, (5, 1.5))),
    (palette.RED, (0, (5, 1.5))),
    (palette.INK, (0, (2, 1.2))),
    (palette.OUTLINE, (0, (6, 1.5, 1.5, 1.5))),
)


@dataclass(frozen=True, eq=False)
class DrawnMap:
    """A grid map to draw tracks over.

    Attributes:
        occupied: Whether a cell is, shape (columns along x, rows along y).
        bounds: x_min, y_min, x_max, y_max [m].
    """

    occupied: NDArray[np.bool_]
    bounds: tuple[float, float, float, float]


def tracks_figure(grid: DrawnMap, panels: Mapping[str, Mapping[str, Array]]) -> Figure:
    """Return where chairs were, over the learned map; a panel for each test run.

    Args:
        grid: The map.
        panels: By the panel's title, tracks (N, 2) or (N, 3) by the driver's name.
    """
    x_min, y_min, x_max, y_max = grid.bounds
    with matplotlib.rc_context(_STYLE):
        rows = -(-len(panels) // 2)
        figure = new_figure(13.0, 3.9 * rows + 0.7)
        places = figure.subplots(rows, 2, squeeze=False).ravel()
        for axes, (title, tracks) in zip(places, panels.items(), strict=False):
            axes.imshow(
                grid.occupied.T,
                origin="lower",
                extent=(x_min, x_max, y_min, y_max),
                cmap=LinearSegmentedColormap.from_list("walls", ["white", palette.WALL]),
                interpolation="nearest",
                zorder=1,
            )
            for (colour, dashes), (name, track) in zip(_LINES, tracks.items(), strict=False):
                axes.plot(
                    *track[:, :2].T,
                    color=colour,
                    linestyle=dashes,
                    linewidth=1.3,
                    label=name,
                    zorder=3,
                )
            axes.set_title(title, fontsize=11)
            axes.set_xlabel("x [m]")
            axes.set_ylabel("y [m]")
        for axes in places[len(panels) :]:
            axes.set_axis_off()
        handles, labels = places[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


@dataclass(frozen=True, eq=False)
class DoorShares:
    """What came of drives through a door, by where they began.

    Attributes:
        title: How they were driven.
        success: Share of drives that arrived and touched nothing, shape (angles, offsets).
        time: Mean time of those [s], the same shape; NaN where there is none.
    """

    title: str
    success: Array
    time: Array


def doors_figure(
    panels: Sequence[DoorShares], offsets: Sequence[float], angles_deg: Sequence[float]
) -> Figure:
    """Return the share of successes and the mean time, by offset and approach angle.

    Args:
        panels: One for each way of driving.
        offsets: Beside the door's middle, to the left [m].
        angles_deg: From straight on, to the left [deg].
    """
    shades = LinearSegmentedColormap.from_list("success", [palette.ORANGE, "white", palette.SKY])
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(4.1 * len(panels) + 0.8, 4.3)
        for axes, panel in zip(
            figure.subplots(1, len(panels), squeeze=False).ravel(), panels, strict=True
        ):
            image = axes.imshow(panel.success, origin="lower", cmap=shades, vmin=0.0, vmax=1.0)
            for row in range(len(angles_deg)):
                for column in range(len(offsets)):
                    seconds = panel.time[row, column]
                    text = f"{panel.success[row, column]:.0%}"
                    text += f"\n{seconds:.0f} s" if np.isfinite(seconds) else ""
                    axes.text(column, row, text, ha="center", va="center", fontsize=9)
            axes.set_xticks(range(len(offsets)), [f"{value:g}" for value in offsets])
            axes.set_yticks(range(len(angles_deg)), [f"{value:g}" for value in angles_deg])
            axes.set_title(panel.title, fontsize=11)
            axes.set_xlabel("offset to the left [m]")
            axes.set_ylabel("heading to the left [deg]")
        figure.colorbar(image, ax=figure.axes, label="through without touching", shrink=0.8)
    return figure
