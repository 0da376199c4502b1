"""The picture of a chair's safety regions: where it gets to while braking, and on which part."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from narrows.reactive.avoidance import indicated_side
from narrows.reactive.safety_regions import SafetyRegions
from narrows.reactive.side_tables import Side, side_table

from . import palette

_STYLE: dict[Any, Any] = {
    "font.family": ["DejaVu Sans"],
    "font.size": 10,
    "svg.hashsalt": "narrows",
}
_MOTIONS = ((0.8, 0.0), (0.6, 0.6), (0.0, 1.0), (-0.4, 0.0), (0.4, -0.8))
_SIDE_COLOURS = {
    Side.NONE: palette.PALE,
    Side.STRAIGHT: palette.INK,
    Side.LEFT: palette.SKY,
    Side.RIGHT: palette.ORANGE,
    Side.BOTH: palette.GREEN,
}


def regions_picture(
    regions: SafetyRegions,
    motions: Sequence[tuple[float, float]] = _MOTIONS,
    *,
    sides: tuple[float, float] = (0.6, -0.3),
) -> Figure:
    """Return the picture of the regions of some motions, and of the sides of one.

    As Figs. 2 and 3 of [DrivingAssistant]: each cell shows the least rim speed that reaches it; the
    last panel shows to which side an obstacle in a region is avoided.

    Args:
        regions: A chair's regions.
        motions: [v, omega] of each panel [m/s, rad/s].
        sides: Motion of the panel of sides.
    """
    with matplotlib.rc_context(_STYLE):
        count = len(motions) + 1
        columns = min(3, count)
        rows = math.ceil(count / columns)
        figure = Figure(figsize=(3.9 * columns, 3.0 * rows), dpi=100, layout="constrained")
        FigureCanvasAgg(figure)
        panels = np.atleast_1d(figure.subplots(rows, columns)).ravel()
        shades = None
        for panel, (v, omega) in zip(panels, motions, strict=False):
            shades = _draw_region(panel, regions, v, omega)
        _draw_sides(panels[count - 1], regions, *sides)
        for panel in panels[count:]:
            panel.set_axis_off()
        if shades is not None:
            figure.colorbar(shades, ax=list(panels), label="least rim speed that reaches it [m/s]")
    return figure


def _extent(regions: SafetyRegions) -> tuple[float, float, float, float]:
    """Return the grid's edges for an image whose x axis is ahead."""
    _, rows, columns = regions.levels.shape
    low, cell = regions.lower, regions.options.cell
    return low[0], low[0] + rows * cell, low[1], low[1] + columns * cell


def _draw_region(axes: Axes, regions: SafetyRegions, v: float, omega: float) -> Any:
    phi, norm = regions.polar(v, omega)
    levels = regions.levels[regions.index(phi)].astype(int)
    least = 0.5 * regions.norms[np.minimum(np.maximum(levels - 1, 0), len(regions.norms) - 1)]
    shown = np.where(levels <= regions.level(norm), least, np.nan)
    image = axes.imshow(
        shown.T, origin="lower", extent=_extent(regions), cmap="viridis_r", vmin=0.0, vmax=0.8
    )
    _finish(axes, regions, f"{v:.1f} m/s, {omega:.1f} rad/s: $\\varphi$ {math.degrees(phi):.0f}°")
    return image


def _draw_sides(axes: Axes, regions: SafetyRegions, v: float, omega: float) -> None:
    phi, norm = regions.polar(v, omega)
    k = regions.index(phi)
    table = side_table("corrected")
    indicated = indicated_side(phi, v > 0.0, math.radians(2.0))
    sides = table[0 if v > 0.0 else 1, regions.parts[k], indicated].astype(float)
    sides[regions.levels[k] > regions.level(norm)] = np.nan
    colours = ListedColormap([_SIDE_COLOURS[side] for side in Side])
    axes.imshow(sides.T, origin="lower", extent=_extent(regions), cmap=colours, vmin=-0.5, vmax=4.5)
    _finish(axes, regions, f"avoid to: {v:.1f} m/s, {omega:.1f} rad/s")
    for side in (Side.LEFT, Side.RIGHT, Side.NONE):
        axes.plot([], [], "s", color=_SIDE_COLOURS[side], label=side.name.lower())
    axes.legend(loc="lower right", fontsize=8)


def _finish(axes: Axes, regions: SafetyRegions, title: str) -> None:
    axes.add_patch(Polygon(regions.outline, closed=True, fill=False, color=palette.RED, lw=1.5))
    axes.plot([0.0], [0.0], "+", color=palette.RED)
    low_x, high_x, low_y, high_y = _extent(regions)
    axes.set_xlim(max(low_x, -1.3), min(high_x, 2.0))
    axes.set_ylim(max(low_y, -1.4), min(high_y, 1.4))
    axes.set_title(title, fontsize=10)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.grid(color=palette.PALE, lw=0.4)
