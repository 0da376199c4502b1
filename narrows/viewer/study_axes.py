"""What the figures of studies share: their style, a figure, a room, a body."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch

from narrows.se2 import Array, transform
from narrows.vehicle import Vehicle
from narrows.world import World

from . import palette
from .scene_drawing import outline_of, solid_areas
from .view_box import ViewBox


def study_style(font_size: int = 11) -> dict[Any, Any]:
    """Return matplotlib's settings of a study's figure; files come out the same every time."""
    return {
        "font.family": ["DejaVu Sans"],
        "font.size": font_size,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "svg.hashsalt": "narrows",
    }


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of 100 dots an inch that needs no screen, [in]."""
    figure = Figure(figsize=(width, height), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def draw_room(axes: Axes, world: World, view: ViewBox) -> None:
    """Draw the solids that stand in a view to scale, and label both axes [m]."""
    patch = PathPatch(outline_of(solid_areas(world, view)))
    patch.set(facecolor=palette.WALL, edgecolor="black", linewidth=0.5, zorder=1)
    axes.add_patch(patch)
    axes.set_xlim(view[0], view[2])
    axes.set_ylim(view[1], view[3])
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")


def draw_body(
    axes: Axes, pose: Array, vehicle: Vehicle, colour: str, *, label: str | None = None
) -> None:
    """Draw the outline of a chair at a pose (3,)."""
    body = transform(pose, vehicle.outline)
    closed = np.concatenate([body, body[:1]])
    axes.plot(*closed.T, color=colour, linewidth=1.6, zorder=5, label=label)
