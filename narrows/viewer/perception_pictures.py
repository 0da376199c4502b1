"""The picture of a depth frame: the chain's stages, and what the fast route knows."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from narrows.perception.camera import Mounting
from narrows.perception.cloud import CloudStages
from narrows.perception.depth_image import DepthFrame, Points
from narrows.perception.surroundings import Surroundings
from narrows.se2 import Array

from . import palette

_STYLE: dict[Any, Any] = {
    "font.family": ["DejaVu Sans"],
    "font.size": 10,
    "svg.hashsalt": "narrows",
}
_COLOURS = (palette.BLUE, palette.ORANGE, palette.GREEN, palette.PINK, palette.SKY, palette.RED)
_UNKNOWN = "#EDEDED"
_FREE = "#A8DCC8"
_VIEW = (0.0, 3.2, -1.6, 1.6)  # x and y shown from above [m]


def frame_figure(
    title: str, frame: DepthFrame, stages: CloudStages, plane_is_floor: bool, seen: Surroundings
) -> Figure:
    """Return the picture of a frame: depth, the chain's stages, and the cells of the floor.

    Args:
        title: The frame's name.
        frame: The depth image.
        stages: What the chain makes of it.
        plane_is_floor: Whether the plane it removes can be the floor.
        seen: What the fast route makes of it; its floor places the cloud.
    """
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(12.0, 8.2), dpi=100, layout="constrained")
        FigureCanvasAgg(figure)
        panels = figure.subplots(2, 3).ravel()
        mounting = seen.floor.mounting if seen.floor is not None else Mounting(1.0)
        _draw_depth(figure, panels[0], frame)
        _draw_cloud(figure, panels[1], _body(stages.voxels, mounting), len(stages.voxels))
        _draw_side(panels[2], stages, mounting, plane_is_floor)
        _draw_plane(panels[3], stages, mounting, plane_is_floor)
        _draw_clusters(panels[4], stages, mounting)
        _draw_cells(panels[5], seen)
        figure.suptitle(title, fontsize=13)
    return figure


def _body(points: Points, mounting: Mounting) -> Array:
    return mounting.to_body(points) if len(points) else np.empty((0, 3))


def _draw_depth(figure: Figure, axes: Axes, frame: DepthFrame) -> None:
    metres = np.ma.masked_equal(frame.metres, 0.0)
    image = axes.imshow(metres, cmap="viridis_r", vmin=0.4, vmax=4.0, interpolation="nearest")
    axes.set_facecolor("black")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_title("depth [m]; black: no return")
    figure.colorbar(image, ax=axes, shrink=0.7, extend="max")


def _from_above(axes: Axes, title: str) -> None:
    axes.set_aspect("equal")
    axes.set_xlim(_VIEW[3], _VIEW[2])  # left of the chair is left in the picture
    axes.set_ylim(_VIEW[0], _VIEW[1])
    axes.set_xlabel("y [m] (left of the chair)")
    axes.set_ylabel("x [m] (ahead)")
    axes.set_title(title, fontsize=11)


def _scatter(axes: Axes, across: Array, along: Array, colour: Any, **more: Any) -> Any:
    return axes.scatter(across, along, s=0.6, c=colour, linewidths=0, rasterized=True, **more)


def _draw_cloud(figure: Figure, axes: Axes, body: Array, count: int) -> None:
    order = np.argsort(body[:, 2])
    drawn = body[order]
    heights = drawn[:, 2]
    dots = _scatter(axes, drawn[:, 1], drawn[:, 0], heights, cmap="cividis", vmin=-0.1, vmax=1.2)
    _from_above(axes, f"{count} voxels, from above; height [m]")
    figure.colorbar(dots, ax=axes, shrink=0.7, extend="both")


def _split(stages: CloudStages, mounting: Mounting) -> tuple[Array, Array]:
    """Return the points on the plane and the rest, in the body frame."""
    if stages.plane is None:
        return np.empty((0, 3)), _body(stages.rest, mounting)
    on_plane = stages.near[stages.plane.is_on_plane]
    return _body(on_plane, mounting), _body(stages.rest, mounting)


def _draw_side(axes: Axes, stages: CloudStages, mounting: Mounting, is_floor: bool) -> None:
    plane, rest = _split(stages, mounting)
    _scatter(axes, rest[:, 0], rest[:, 2], palette.INK)
    _scatter(axes, plane[:, 0], plane[:, 2], palette.GREEN if is_floor else palette.RED)
    axes.plot(0.0, mounting.height, "s", color=palette.BLUE, markersize=6)
    axes.annotate("camera", (0.0, mounting.height), (8, 4), textcoords="offset points")
    axes.axhline(0.0, color=palette.OUTLINE, linewidth=0.8, zorder=0)
    axes.set_xlim(-0.1, _VIEW[1])
    axes.set_ylim(-0.7, 2.1)
    axes.set_aspect("equal")
    axes.set_xlabel("x [m] (ahead)")
    axes.set_ylabel("height [m]")
    axes.set_title(f"{len(stages.near)} within reach, from the side")


def _draw_plane(axes: Axes, stages: CloudStages, mounting: Mounting, is_floor: bool) -> None:
    plane, rest = _split(stages, mounting)
    _scatter(axes, rest[:, 1], rest[:, 0], palette.INK)
    _scatter(axes, plane[:, 1], plane[:, 0], palette.GREEN if is_floor else palette.RED)
    found = "green: the floor" if is_floor else "red: NOT a floor"
    _from_above(axes, f"largest plane, taken away\n({found})")


def _draw_clusters(axes: Axes, stages: CloudStages, mounting: Mounting) -> None:
    rest = _body(stages.rest, mounting)
    _scatter(axes, rest[:, 1], rest[:, 0], palette.PALE)
    for number, rows in enumerate(stages.clusters):
        _scatter(axes, rest[rows, 1], rest[rows, 0], _COLOURS[number % len(_COLOURS)])
    sizes = ", ".join(str(len(rows)) for rows in stages.clusters[:6])
    more = ", ..." if len(stages.clusters) > 6 else ""
    _from_above(axes, f"the rest: {len(stages.clusters)} clusters of\n{sizes or 'nothing'}{more}")


def _draw_cells(axes: Axes, seen: Surroundings) -> None:
    grid = seen.grid
    colours = ListedColormap([_UNKNOWN, _FREE, palette.INK, palette.RED])
    edges = (grid.y_from, grid.y_to, grid.x_from, grid.x_to)
    axes.imshow(
        seen.cells,
        cmap=colours,
        norm=BoundaryNorm([-0.5, 0.5, 1.5, 2.5, 3.5], 4),
        extent=edges,
        origin="lower",
        interpolation="nearest",
    )
    for found, colour in ((seen.obstacles, palette.ORANGE), (seen.drop_offs, palette.RED)):
        for one in found:
            low, size = one.low[:2], (one.high - one.low)[:2]
            box = Rectangle((low[1], low[0]), size[1], size[0], fill=False)
            box.set(edgecolor=colour, linewidth=1.6)
            axes.add_patch(box)
            axes.plot(one.nearest[1], one.nearest[0], ".", color=colour, markersize=7)
    _from_above(axes, f"fast route: {seen.sight.value.split(':')[0]}")
    names = ("unknown", "free", "obstacle", "drop-off")
    handles = [Rectangle((0, 0), 1, 1, color=colours(k)) for k in range(4)]
    axes.legend(handles, names, loc="lower left", fontsize=9, framealpha=0.9)
