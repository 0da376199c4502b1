"""The scene from above, to scale: what stands there, what moves, start and goal."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path as Outline

from narrows.scene import Scene
from narrows.se2 import Array, transform
from narrows.vehicle import Vehicle
from narrows.world import Door, MovingSolid, Solid, World

from . import palette
from .view_box import ViewBox

_LABELLED_DOORS = 3


def outline_of(areas: list[shapely.Polygon]) -> Outline:
    """Return the rings of polygons as one outline; holes stay open."""
    vertices, codes = [], []
    for part in areas:
        oriented = shapely.geometry.polygon.orient(part)
        for ring in (oriented.exterior, *oriented.interiors):
            points = shapely.get_coordinates(ring)
            vertices.append(points)
            codes.append([Outline.MOVETO, *[Outline.LINETO] * (len(points) - 2), Outline.CLOSEPOLY])
    if not vertices:
        return Outline(np.zeros((0, 2)))
    return Outline(np.concatenate(vertices), np.concatenate(codes))


def draw_world(axes: Axes, scene: Scene, view: ViewBox) -> None:
    """Draw what stands still: filled where the body can meet it, hatched where it passes."""
    if scene.world.bounds is not None:
        x_min, y_min, x_max, y_max = scene.world.bounds
        frame = Rectangle((x_min, y_min), x_max - x_min, y_max - y_min, fill=False)
        frame.set(edgecolor=palette.OUTLINE, linestyle=(0, (6, 4)), linewidth=1.0, zorder=0.5)
        axes.add_patch(frame)
    groups: dict[str, list[shapely.Polygon]] = {}
    for solid in scene.world.solids:
        groups.setdefault(_kind(solid, scene.vehicle), []).extend(_area(solid, view))
    for kind, areas in groups.items():
        if not areas:
            continue
        patch = PathPatch(outline_of(areas), label=kind)
        patch.set(**_LOOKS[kind])
        axes.add_patch(patch)
    _draw_doors(axes, scene, view)


def solid_areas(world: World, view: ViewBox) -> list[shapely.Polygon]:
    """Return the areas of all solids as far as they are in view."""
    return [area for solid in world.solids for area in _area(solid, view)]


_LOOKS: dict[str, dict[str, Any]] = {
    "solid": {"facecolor": palette.WALL, "edgecolor": "black", "linewidth": 0.5, "zorder": 2},
    "unknown": {"facecolor": "#9A9A9A", "edgecolor": "#6A6A6A", "linewidth": 0.5, "zorder": 1.9},
    "in the way of a part of the body": {
        "facecolor": "#BBBBBB",
        "hatch": "xx",
        "edgecolor": palette.WALL,
        "linewidth": 1.2,
        "alpha": 0.6,
        "zorder": 2.1,
    },
    "above the chair": {
        "fill": False,
        "hatch": "//",
        "edgecolor": palette.OUTLINE,
        "linewidth": 1.2,
        "zorder": 2.1,
    },
    "below the body": {
        "fill": False,
        "hatch": "..",
        "edgecolor": palette.OUTLINE,
        "linewidth": 1.2,
        "zorder": 2.1,
    },
}


def _kind(solid: Solid, vehicle: Vehicle) -> str:
    """Return how a solid is drawn: by what of the body it can touch."""
    low, high = solid.z
    met = [low < layer.z[1] and layer.z[0] < high for layer in vehicle.layers]
    if all(met):
        return "unknown" if solid.name.startswith("unknown") else "solid"
    if any(met):
        return "in the way of a part of the body"
    return "above the chair" if low >= vehicle.height else "below the body"


def _area(solid: Solid, view: ViewBox) -> list[shapely.Polygon]:
    """Return the parts of a solid's area that are in view."""
    low, high = np.array(view[:2]), np.array(view[2:])
    pad = 0.5 * (high - low)
    shape = solid.shape.buffer(solid.radius, quad_segs=16) if solid.radius else solid.shape
    seen = shapely.clip_by_rect(shape, *(low - pad), *(high + pad))
    return [part for part in shapely.get_parts(seen) if part.geom_type == "Polygon"]


def _draw_doors(axes: Axes, scene: Scene, view: ViewBox) -> None:
    doors = _doors_in_view(scene, view)
    for door in doors:
        across = 0.5 * door.width * _across(door)
        ends = np.array(door.center) + np.outer([-1.0, 1.0], across)  # (2, 2)
        axes.plot(*ends.T, color=palette.GREEN, linewidth=1.2, linestyle=(0, (2, 2)), zorder=2.5)
        if len(doors) <= _LABELLED_DOORS:
            x, y = _label_place(door)
            axes.annotate(
                f"door {door.width:.2f} m",
                (x, y),
                ha="center",
                va="center",
                fontsize=10,
                color=palette.INK,
                bbox=LABEL_BOX,
                zorder=7,
            )


def door_label_areas(scene: Scene, view: ViewBox) -> list[shapely.Polygon]:
    """Return about where the doors' labels are, for others to leave free."""
    doors = _doors_in_view(scene, view)
    places = [_label_place(door) for door in doors] if len(doors) <= _LABELLED_DOORS else []
    return [shapely.box(x - 0.35, y - 0.1, x + 0.35, y + 0.1) for x, y in places]


def _doors_in_view(scene: Scene, view: ViewBox) -> list[Door]:
    return [
        door
        for door in scene.world.doors
        if view[0] < door.center[0] < view[2] and view[1] < door.center[1] < view[3]
    ]


def _across(door: Door) -> Array:
    """Return the unit vector from a door's right jamb to its left one."""
    return np.array([-np.sin(door.heading), np.cos(door.heading)])


def _label_place(door: Door) -> tuple[float, float]:
    """Return a place beside the right jamb, on the side one comes from [m]."""
    ahead = np.array([np.cos(door.heading), np.sin(door.heading)])
    place = np.array(door.center) - (0.5 * door.width + 0.45) * _across(door) - 0.25 * ahead
    return float(place[0]), float(place[1])


LABEL_BOX = {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}
"""Paper behind words in a picture."""


def draw_moving(axes: Axes, solids: tuple[MovingSolid, ...], time: float | None) -> None:
    """Draw moving things: their path, where they start, and where they are at a time [s]."""
    for index, solid in enumerate(solids):
        name = solid.name or "person"
        label = "moving" if index == 0 else None
        track = solid.path[:, 1:]
        axes.plot(*track.T, ":", color=palette.PINK, linewidth=2, zorder=3.1, label=label)
        instants = [solid.path[0, 0]] + ([time] if time is not None else [])
        for instant in instants:
            centre = shapely.Point(solid.position(instant))
            disc = PathPatch(outline_of([centre.buffer(solid.radius, quad_segs=16)]))
            disc.set(facecolor="#EBCFDF", alpha=0.9, edgecolor=palette.INK, zorder=3.2)
            axes.add_patch(disc)
            axes.annotate(
                f"{name}\n{instant:.1f} s",
                (centre.x, centre.y),
                ha="center",
                va="center",
                fontsize=9,
                zorder=7,
            )


def draw_ends(axes: Axes, scene: Scene) -> None:
    """Draw the body where it starts and where it is to arrive, with its heading."""
    ends = (("start", scene.start, palette.START), ("goal", scene.goal.pose, palette.GOAL))
    for name, pose, colour in ends:
        body = transform(pose, scene.vehicle.outline)
        closed = np.concatenate([body, body[:1]])
        style = "-" if name == "start" else (0, (4, 1.5))
        axes.plot(*closed.T, color=colour, linewidth=2.4, linestyle=style, zorder=4)
        for layer in scene.vehicle.layers if len(scene.vehicle.layers) > 1 else ():
            ring = transform(pose, np.concatenate([layer.polygon, layer.polygon[:1]]))
            axes.plot(*ring.T, color=colour, linewidth=1.0, zorder=4)
        tip = transform(pose, np.array([[scene.vehicle.front_overhang + 1e-3, 0.0]]))[0]
        axes.annotate(
            "",
            (float(tip[0]), float(tip[1])),
            (float(pose[0]), float(pose[1])),
            arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 2.0},
            zorder=5,
        )
        middle = transform(pose, scene.vehicle.outline.mean(axis=0)[None])[0]
        axes.annotate(
            name,
            middle,
            ha="center",
            va="center",
            fontsize=12,
            fontweight="bold",
            color=palette.INK,
            bbox=LABEL_BOX,
            zorder=7,
        )


def draw_scale(axes: Axes, view: ViewBox) -> None:
    """Draw a bar of a round length in the lower left corner."""
    width = view[2] - view[0]
    length = float(10.0 ** np.floor(np.log10(0.25 * width)))
    length *= max(f for f in (1.0, 2.0, 5.0) if f * length <= 0.25 * width)
    x, y = view[0] + 0.02 * width, view[1] + 0.025 * width
    for colour, thick in (("white", 9), ("black", 4)):
        style: dict[str, Any] = {"linewidth": thick, "zorder": 8, "solid_capstyle": "butt"}
        axes.plot([x, x + length], [y, y], color=colour, **style)
    middle = (x + 0.5 * length, y)
    axes.annotate(
        f"{length:g} m",
        middle,
        (0, 9),
        textcoords="offset points",
        ha="center",
        fontsize=11,
        bbox=LABEL_BOX,
        zorder=8,
    )
