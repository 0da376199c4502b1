"""Things and people of a scene's document: moved, sized, turned; entries as the format has them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .page_fields import rounded_number

NEW: dict[str, dict[str, Any]] = {
    "stool": {"circle": [0.0, 0.0, 0.2], "z": [0.0, 0.5]},
    "box": {"polygon": [[-0.3, -0.2], [0.3, -0.2], [0.3, 0.2], [-0.3, 0.2]], "z": [0.0, 0.6]},
    "hanging shelf": {
        "polygon": [[-0.4, -0.2], [0.4, -0.2], [0.4, 0.2], [-0.4, 0.2]],
        "z": [1.1, 1.4],
    },
}
"""Things that can be put into the scene, about their middle."""

Entry = Mapping[str, Any]


def moved_entry(entry: Entry, by: Any) -> dict[str, Any]:
    """Return an entry of a solid, or of one that moves, moved by a step (2,), [m]."""
    dx, dy = (float(value) for value in by)
    if entry.get("path") is not None:
        path = [[t, rounded_number(x + dx), rounded_number(y + dy)] for t, x, y in entry["path"]]
        return {**entry, "path": path}
    return _mapped(entry, lambda x, y: (x + dx, y + dy))


def sized_entry(entry: Entry, size: Any) -> dict[str, Any]:
    """Return an entry of a solid made as large as a size along x and y, (2,), [m].

    A circle takes the side that changes most as its diameter.
    """
    before, (x0, y0) = extent(entry), middle(entry)
    if entry.get("circle") is not None:
        widest = max(size, key=lambda side: abs(float(side) - before[0]))
        return {**entry, "circle": [*entry["circle"][:2], rounded_number(0.5 * float(widest))]}
    sx, sy = (float(now) / was for now, was in zip(size, before, strict=True))
    return _mapped(entry, lambda x, y: (x0 + sx * (x - x0), y0 + sy * (y - y0)))


def turned_entry(entry: Entry, by: float) -> dict[str, Any]:
    """Return an entry of a solid turned about its middle [rad], counter-clockwise."""
    (x0, y0), c, s = middle(entry), math.cos(by), math.sin(by)
    return _mapped(
        entry,
        lambda x, y: (x0 + c * (x - x0) - s * (y - y0), y0 + s * (x - x0) + c * (y - y0)),
    )


def middle(entry: Entry) -> tuple[float, float]:
    """Return the middle of a solid's box along x and y [m]."""
    x0, y0, x1, y1 = _box(entry)
    return 0.5 * (x0 + x1), 0.5 * (y0 + y1)


def extent(entry: Entry) -> tuple[float, float]:
    """Return how far a solid reaches along x and along y [m]."""
    x0, y0, x1, y1 = _box(entry)
    return x1 - x0, y1 - y0


def name_of(entry: Entry, index: int) -> str:
    """Return what an entry is called: by its name, or by what it is and where in the list."""
    kind = "circle" if entry.get("circle") is not None else "wall"
    return str(entry.get("name") or f"{kind} {index + 1}")


def _box(entry: Entry) -> tuple[float, float, float, float]:
    if entry.get("circle") is not None:
        x, y, radius = (float(value) for value in entry["circle"])
        return x - radius, y - radius, x + radius, y + radius
    corners = np.asarray(entry["polygon"], dtype=float)
    (x0, y0), (x1, y1) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return x0, y0, x1, y1


def _mapped(entry: Entry, there: Callable[[float, float], tuple[float, float]]) -> dict[str, Any]:
    """Return an entry whose points are elsewhere, to whole tenths of a millimetre."""

    def point(corner: Any) -> list[float]:
        return [rounded_number(value) for value in there(float(corner[0]), float(corner[1]))]

    mapped = dict(entry)
    if mapped.get("circle") is not None:
        mapped["circle"] = [*point(entry["circle"]), entry["circle"][2]]
    if mapped.get("polygon") is not None:
        mapped["polygon"] = [point(corner) for corner in entry["polygon"]]
    if mapped.get("holes") is not None:
        mapped["holes"] = [[point(corner) for corner in hole] for hole in entry["holes"]]
    return mapped
