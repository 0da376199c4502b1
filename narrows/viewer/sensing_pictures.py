"""Pictures of sensing: what a depth camera returns and why not the rest; a map while it grows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Patch, PathPatch, Wedge
from numpy.typing import NDArray
from shapely import get_parts

from narrows.perception.camera import DepthCamera
from narrows.perception.surroundings import Cell
from narrows.scene import Scene
from narrows.se2 import Array, transform
from narrows.vehicle import Vehicle

from . import palette
from .scene_drawing import outline_of
from .study_axes import draw_body, new_figure, study_style
from .view_box import ViewBox

_UNKNOWN, _FREE = "#DADADA", "#FFFFFF"
_CAUSES = ("#FFFFFF", palette.INK, palette.PALE, palette.BLUE, palette.ORANGE, palette.RED)
_LASERS = (palette.BLUE, palette.RED)
_SHELVES = ((0.0, 0.2, "feet"), (0.2, 0.7, "knees"), (0.7, 0.8, "table tops"))
"""Bands of heights that are drawn by themselves: from, to [m], and what meets them."""


@dataclass(frozen=True, eq=False)
class MapView:
    """A map at a moment, and what is drawn with it.

    Attributes:
        title: Of its row.
        bands: Values of `Cell` for each band, shape (K, n, n), x first.
        edges: Heights between the bands, shape (K + 1,), [m].
        extent: x_min, x_max, y_min, y_max [m].
        pose: Of the chair, shape (3,).
        time: For moving solids [s].
        seen: Points the lasers saw last, one array (N, 2) for each, [m].
    """

    title: str
    bands: NDArray[np.uint8]
    edges: Array
    extent: tuple[float, float, float, float]
    pose: Array
    time: float = 0.0
    seen: tuple[Array, ...] = ()


def camera_figure(
    title: str,
    depth: Array,
    returned: NDArray[np.uint16],
    why: NDArray[np.uint8],
    causes: Sequence[str],
) -> Figure:
    """Return the picture of a depth frame: the truth, what comes back, why the rest does not.

    Args:
        title: Of the picture.
        depth: True depths, shape (height, width), [m]; infinite where there is nothing.
        returned: What the camera delivers, the same shape, [mm]; 0: no return.
        why: Which cause a pixel is missing for, the same shape; 0: it is not.
        causes: Their names, the first that of 0.
    """
    with matplotlib.rc_context(study_style(11)):
        figure = new_figure(14.0, 5.0)
        panels = figure.subplots(1, 3)
        names = ("what there is: depth [m]", "what comes back: depth [m]")
        for axes, image, name in zip(panels, (depth, returned / 1e3), names, strict=False):
            shown = np.ma.masked_where(~np.isfinite(image) | (image <= 0.0), image)
            axes.set_facecolor("black")
            drawn = axes.imshow(
                shown, cmap="viridis_r", vmin=0.4, vmax=4.0, interpolation="nearest"
            )
            axes.set_title(name)
            figure.colorbar(drawn, ax=axes, orientation="horizontal", extend="both", pad=0.02)
        colours = ListedColormap(_CAUSES[: len(causes)])
        norm = BoundaryNorm(np.arange(len(causes) + 1) - 0.5, len(causes))
        panels[2].imshow(why, cmap=colours, norm=norm, interpolation="nearest")
        panels[2].set_title("why the rest does not")
        shares = [100.0 * float((why == k).mean()) for k in range(len(causes))]
        labels = [f"{name}, {share:.1f} %" for name, share in zip(causes, shares, strict=True)]
        handles = [Patch(facecolor=c, edgecolor=palette.OUTLINE) for c in _CAUSES]
        panels[2].legend(
            handles[: len(causes)],
            labels,
            loc="upper center",
            bbox_to_anchor=(0.5, -0.02),
            ncols=2,
            frameon=False,
        )
        for axes in panels:
            axes.set_xticks([])
            axes.set_yticks([])
            axes.spines[:].set_visible(True)
        figure.suptitle(title, fontsize=13)
    return figure


def map_figure(
    title: str,
    views: Sequence[MapView],
    vehicle: Vehicle | None,
    *,
    scene: Scene | None = None,
    camera: DepthCamera | None = None,
    view: ViewBox,
) -> Figure:
    """Return the picture of a map at some moments, one a row, with what it says by heights.

    Args:
        title: Of the picture.
        views: The moments.
        vehicle: The chair, drawn where it was; None: none.
        scene: What there truly was, drawn in the first column; None: no such column.
        camera: Whose view is drawn there.
        view: What part of the world is shown.
    """
    columns = len(_SHELVES) + 1 + (scene is not None)
    shape = (view[3] - view[1]) / (view[2] - view[0])
    with matplotlib.rc_context(study_style(10)):
        figure = new_figure(3.1 * columns, 3.1 * shape * len(views) + 1.5)
        grid = figure.subplots(len(views), columns, squeeze=False, sharex=True, sharey=True)
        for row, one in zip(grid, views, strict=True):
            panels = list(row)
            if scene is not None:
                _draw_truth(panels.pop(0), scene, one, camera)
            for axes, (low, high, name) in zip(panels, _SHELVES, strict=False):
                _draw_states(axes, one, low, high)
                axes.set_title(f"{name}: {low:g} to {high:g} m")
            _draw_heights(panels[-1], one)
            for axes in row:
                if vehicle is not None:
                    draw_body(axes, one.pose, vehicle, palette.BLUE)
                axes.set_xlim(view[0], view[2])
                axes.set_ylim(view[1], view[3])
                axes.set_aspect("equal")
                axes.spines[:].set_visible(True)
            row[0].set_ylabel(f"{one.title}\ny [m]")
        for axes in grid[-1]:
            axes.set_xlabel("x [m]")
        _label_heights(figure, grid, views[0].edges)
        handles = [
            Patch(facecolor=_FREE, edgecolor=palette.OUTLINE, label="free"),
            Patch(facecolor=_UNKNOWN, edgecolor=palette.OUTLINE, label="not known"),
            Patch(facecolor=palette.INK, label="occupied"),
        ]
        figure.legend(handles=handles, loc="outside lower left", ncols=3, frameon=False)
        figure.suptitle(title, fontsize=13)
    return figure


def _image(axes: Axes, cells: Array, view: MapView, **look: object) -> None:
    options: dict[str, object] = {"origin": "lower", "interpolation": "nearest", **look}
    axes.imshow(cells.T, extent=view.extent, zorder=1, **options)  # type: ignore[arg-type]
    axes.set_facecolor(_UNKNOWN)


def _draw_states(axes: Axes, view: MapView, low: float, high: float) -> None:
    """Draw what the bands between two heights say together: occupied before free."""
    inside = (view.edges[1:] > low + 1e-9) & (view.edges[:-1] < high - 1e-9)
    bands = view.bands[inside]
    cells = np.where((bands == Cell.FREE).any(axis=0), 1, 0)
    cells[(bands == Cell.OBSTACLE).any(axis=0)] = 2
    _image(axes, cells, view, cmap=ListedColormap([_UNKNOWN, _FREE, palette.INK]), vmin=0, vmax=2)


def _heights(edges: Array) -> tuple[ListedColormap, BoundaryNorm]:
    colours = matplotlib.colormaps["viridis_r"](np.linspace(0.0, 1.0, len(edges) - 1))
    return ListedColormap(colours), BoundaryNorm(edges, len(edges) - 1)


def _draw_heights(axes: Axes, view: MapView) -> None:
    """Draw the height of the highest band that is occupied."""
    middles = 0.5 * (view.edges[1:] + view.edges[:-1])
    occupied = view.bands == Cell.OBSTACLE
    top = len(middles) - 1 - np.argmax(occupied[::-1], axis=0)
    free = np.where((view.bands == Cell.FREE).any(axis=0), 1, 0)
    _image(axes, free, view, cmap=ListedColormap([_UNKNOWN, _FREE]), vmin=0, vmax=1)
    heights = np.ma.masked_where(~occupied.any(axis=0), middles[top])
    colours, norm = _heights(view.edges)
    axes.imshow(
        heights.T,
        extent=view.extent,
        origin="lower",
        interpolation="nearest",
        cmap=colours,
        norm=norm,
        zorder=2,
    )
    axes.set_title("all heights: the highest")


def _label_heights(figure: Figure, grid: NDArray[np.object_], edges: Array) -> None:
    colours, norm = _heights(edges)
    bar = figure.colorbar(
        ScalarMappable(norm, colours), ax=grid[:, -1].tolist(), shrink=0.8, ticks=edges[1::2]
    )
    bar.set_label("height above the floor [m]")


def _draw_truth(axes: Axes, scene: Scene, view: MapView, camera: DepthCamera | None) -> None:
    """Draw what there is, its height by its colour, and what sensors see of it."""
    colours, norm = _heights(view.edges)
    axes.set_facecolor(_FREE)
    for solid in sorted(scene.world.solids, key=lambda solid: solid.z[1]):
        area = solid.shape.buffer(solid.radius) if solid.radius else solid.shape
        patch = PathPatch(outline_of(list(get_parts(area))))
        face = colours(norm(min(solid.z[1], view.edges[-1]) - 1e-6))
        patch.set(facecolor=face, edgecolor=palette.OUTLINE, linewidth=0.5)
        patch.set_zorder(1.0 + solid.z[1])
        axes.add_patch(patch)
    for walker in scene.world.moving:
        x, y = walker.position(view.time)
        disc = Circle((float(x), float(y)), walker.radius)
        disc.set(facecolor="#EBCFDF", edgecolor=palette.INK, zorder=4)
        axes.add_patch(disc)
    if camera is not None:
        _draw_view(axes, view.pose, camera)
    for colour, points in zip(_LASERS, view.seen, strict=False):
        axes.plot(*points.T, ".", color=colour, markersize=2, zorder=5)
    axes.set_title("what there is, what lasers see")


def _draw_view(axes: Axes, pose: Array, camera: DepthCamera) -> None:
    """Draw how far to the sides and ahead a camera sees."""
    lens, mounting = camera.intrinsics, camera.mounting
    place = transform(pose, mounting.position[None, :2])[0]
    half = math.degrees(math.atan(0.5 * lens.width / lens.fx))
    middle = math.degrees(pose[2] + mounting.heading)
    wedge = Wedge(place, camera.furthest, middle - half, middle + half)
    wedge.set(facecolor=palette.SKY, alpha=0.18, edgecolor=palette.BLUE, zorder=0.6)
    axes.add_patch(wedge)
