"""A motion from above, to scale: where the body passes, and the way of its axle."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch

from narrows.path import Path
from narrows.se2 import Array, transform
from narrows.vehicle import Vehicle

from . import palette
from .scene_drawing import LABEL_BOX, outline_of


def swept_area(outline: Array, path: Path) -> list[shapely.Polygon]:
    """Return the area a body's outline (K, 2) passes over: from poses every 2 cm or 2 degrees."""
    poses = path(_spread(path, 0.02, np.deg2rad(2.0)))
    bodies = transform(poses, outline)
    hulls = [shapely.MultiPoint(np.concatenate(pair)).convex_hull for pair in pairwise(bodies)]
    return [part for part in shapely.get_parts(shapely.union_all(hulls))]


def draw_motion(axes: Axes, vehicle: Vehicle, path: Path, *, fault: str) -> None:
    """Draw the body swept along a path and the way of its drive axle.

    A motion with a fault is drawn dashed, in another colour, and called by its fault.
    """
    colour = palette.REFUSED if fault else palette.SKY
    name = f"swept body, {fault}" if fault else "swept body"
    for index, layer in enumerate(vehicle.layers):
        area = PathPatch(outline_of(swept_area(layer.polygon, path)))
        area.set(facecolor=colour, alpha=0.22, edgecolor="none", zorder=1)
        area.set_label(name if index == 0 else "_")
        axes.add_patch(area)
    bodies = transform(path(_spread(path, 0.25, np.deg2rad(15.0))), vehicle.outline)
    for body in bodies:
        closed = np.concatenate([body, body[:1]])
        axes.plot(*closed.T, color=colour, alpha=0.55, linewidth=0.8, zorder=3)
    _draw_axle(axes, path, fault)


def _draw_axle(axes: Axes, path: Path, fault: str) -> None:
    drawn: set[str] = set()
    for k, direction in enumerate(path.directions):
        low, high = path.section_bounds[k], path.section_bounds[k + 1]
        if direction == 0:
            x, y, _ = path(0.5 * (low + high))
            label = "turn on the spot"
            style: dict[str, Any] = {
                "marker": "o",
                "markersize": 11,
                "fillstyle": "none",
                "linestyle": "none",
            }
            colour = palette.INK
            points = np.array([[x, y]])
        else:
            count = max(2, int((high - low) / 0.01))
            inside = np.linspace(low, high, count)
            inside[0] += 1e-9  # a joint belongs to the section before
            points = path(inside)[:, :2]
            label = "drive axle, forward" if direction > 0 else "drive axle, in reverse"
            colour = palette.FORWARD if direction > 0 else palette.REVERSE
            style = {"linestyle": "-" if direction > 0 else (0, (5, 1.5)), "linewidth": 2.2}
        if fault:
            colour = palette.REFUSED
            style |= {} if direction == 0 else {"linestyle": (0, (4, 3))}
            label = f"{label}, {fault}"
        axes.plot(
            *points.T, color=colour, label=None if label in drawn else label, zorder=4.5, **style
        )
        drawn.add(label)
    moving = np.flatnonzero(path.directions)
    changes = moving[1:][path.directions[moving[1:]] != path.directions[moving[:-1]]]
    for number, index in enumerate(changes, start=1):
        x, y, _ = path(path.section_bounds[index])
        axes.plot(
            x,
            y,
            "D",
            color=palette.INK,
            markersize=7,
            zorder=5.2,
            linestyle="none",
            label="change of direction" if number == 1 else None,
        )
        axes.annotate(
            f"{number}",
            (x, y),
            xytext=(8, 6),
            textcoords="offset points",
            fontsize=11,
            fontweight="bold",
            bbox=LABEL_BOX,
            zorder=7,
        )


def _spread(path: Path, distance: float, angle: float) -> Array:
    """Return progress values, every distance [m] or angle [rad], ends of sections included."""
    values = [np.zeros(1)]
    for k, direction in enumerate(path.directions):
        low, high = path.section_bounds[k], path.section_bounds[k + 1]
        if direction == 0:
            step = angle
        else:
            turned = abs(float(path(high)[2] - path(low + 1e-9)[2]))
            step = min(distance, max(angle * (high - low) / max(turned, 1e-9), 0.2 * distance))
        values.append(np.linspace(low, high, max(2, int(np.ceil((high - low) / step)) + 1))[1:])
    return np.concatenate(values)


def draw_planned(axes: Axes, path: Path) -> None:
    """Draw the path a drive was to follow."""
    points = path(_spread(path, 0.02, 1.0))[:, :2]
    axes.plot(*points.T, color=palette.PALE, linewidth=6.0, zorder=3.5, label="planned")
