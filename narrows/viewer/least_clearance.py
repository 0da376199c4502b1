"""Where the clearance is least: the body there, and an arrow to what it is nearest to."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely
from matplotlib.axes import Axes

from narrows.clearance import Certificate
from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import Array, transform

from . import palette

_FONT = 12  # points


def draw_least(
    axes: Axes,
    scene: Scene,
    path: Path,
    certificate: Certificate,
    crowded: Sequence[shapely.Geometry],
    labels: list[shapely.Polygon],
) -> None:
    """Draw the body where the certificate found the least clearance, and how much it is.

    Args:
        axes: The axes, their limits set and laid out.
        scene: The scene.
        path: The motion.
        certificate: Its certificate; one that met nothing draws nothing.
        crowded: Areas the label better leaves free, [m].
        labels: Areas of other labels, which its arrow leaves free too, [m].
    """
    if not math.isfinite(certificate.attained):
        return
    pose = path(certificate.at[0])
    pair = _nearest_points(scene, pose, certificate)
    body = transform(pose, scene.vehicle.outline)
    closed = np.concatenate([body, body[:1]])
    axes.plot(*closed.T, color=palette.LEAST, linewidth=2.0, zorder=5)
    at = pose[:2] if pair is None else pair.mean(axis=0)
    if pair is not None:
        axes.plot(*pair.T, color=palette.LEAST, linewidth=2.0, zorder=6)
    draw_label(axes, at, _text(certificate), crowded, labels)


def draw_label(
    axes: Axes,
    at: Array,
    text: str,
    crowded: Sequence[shapely.Geometry],
    labels: list[shapely.Polygon],
) -> None:
    """Mark a point by a cross, and say what is there where that covers least.

    Args:
        axes: The axes, their limits set and laid out.
        at: The point in the world, shape (2,), [m].
        text: What is there, one line.
        crowded: Areas the label better leaves free, [m].
        labels: Areas of other labels, which its arrow leaves free too, [m].
    """
    axes.plot(*at, "x", color=palette.LEAST, markersize=9, markeredgewidth=2.4, zorder=6)
    axes.annotate(
        text,
        (float(at[0]), float(at[1])),
        xytext=_free_place(axes, at, text, crowded, labels),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=_FONT,
        fontweight="bold",
        color=palette.INK,
        arrowprops={"arrowstyle": "-|>", "color": palette.LEAST, "linewidth": 2.0, "shrinkB": 4},
        bbox={"boxstyle": "round,pad=0.3", "facecolor": "white", "edgecolor": palette.LEAST},
        zorder=9,
    )


def _free_place(
    axes: Axes,
    at: Array,
    text: str,
    crowded: Sequence[shapely.Geometry],
    labels: list[shapely.Polygon],
) -> tuple[float, float]:
    """Return where around a point a label covers least, as an offset in points.

    Args:
        axes: The axes, laid out.
        at: The point in the world, shape (2,), [m].
        text: The label.
        crowded: Areas in the world better not covered, [m].
        labels: Areas the arrow must not cross either, [m].
    """
    per_metre = np.ptp(axes.transData.transform([[0.0, 0.0], [1.0, 0.0]])[:, 0])
    per_metre *= 72.0 / float(axes.figure.dpi)  # points per metre
    (x_min, x_max), (y_min, y_max) = axes.get_xlim(), axes.get_ylim()
    half = np.array([0.34 * _FONT * len(text), 0.9 * _FONT]) + 6.0  # half the label's box
    best, least = (90.0, 55.0), math.inf
    for distance in (55.0, 85.0, 120.0, 160.0):
        for angle in np.arange(0.0, 2.0 * np.pi, np.pi / 8.0):
            ray = np.array([np.cos(angle), np.sin(angle)])
            offset = ray * (distance + float(np.abs(ray) @ half))
            middle, size = at + offset / per_metre, half / per_metre
            box = shapely.box(*(middle - size), *(middle + size))
            view = shapely.box(x_min, y_min, x_max, y_max)
            cost = 20.0 * (box.area - box.intersection(view).area)
            cost += sum(box.intersection(area).area for area in crowded)
            line = shapely.LineString([at, middle])
            arrow = line.union(box)
            cost += sum(0.3 * arrow.intersects(area) for area in labels)
            cost += sum(0.05 * line.intersection(area).length for area in crowded)
            cost += 0.02 * box.area * distance / 55.0
            if cost < least:
                best, least = (float(offset[0]), float(offset[1])), cost
    return best


def _text(certificate: Certificate) -> str:
    what = f" {certificate.against}" if certificate.against else ""
    if certificate.attained <= 0.0:
        return f"{-1e3 * certificate.attained:.0f} mm inside{what}"
    return f"{1e3 * max(certificate.clearance, 0.0):.0f} mm to{what or ' the nearest solid'}"


def _nearest_points(scene: Scene, pose: Array, certificate: Certificate) -> Array | None:
    """Return the nearest points of body and solid, (2, 2) [m]; of an overlap its middle, twice."""
    best: tuple[float, Array] | None = None
    for layer in scene.vehicle.layers:
        body = shapely.Polygon(transform(pose, layer.polygon))
        for shape in _shapes(scene, layer.z, certificate):
            distance = float(shapely.distance(body, shape))
            if best is not None and distance > best[0]:
                continue
            if distance > 0.0:
                pair = shapely.get_coordinates(shapely.shortest_line(body, shape))
            else:
                overlap = shapely.intersection(body, shape)
                pair = np.repeat(shapely.get_coordinates(overlap.centroid), 2, axis=0)
            if len(pair) == 2:
                best = (distance, pair)
    return None if best is None else best[1]


def _shapes(
    scene: Scene, z: tuple[float, float], certificate: Certificate
) -> list[shapely.Polygon | shapely.Point]:
    """Return the areas of the solids the certificate names that a layer can meet."""
    found: list[shapely.Polygon | shapely.Point] = [
        solid.shape.buffer(solid.radius, quad_segs=32) if solid.radius else solid.shape
        for solid in scene.world.solids
        if solid.name == certificate.against and solid.z[0] < z[1] and z[0] < solid.z[1]
    ]
    if certificate.time is not None:
        found += [
            shapely.Point(moving.position(certificate.time)).buffer(moving.radius, quad_segs=32)
            for moving in scene.world.moving
            if (moving.name or "a person") == certificate.against
        ]
    return found
