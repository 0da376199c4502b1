"""Vector maps in the form `wall-map/1`: walls, furniture and doors as polygons in JSON."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from ..errors import SceneError
from ..se2 import Array
from ..world import Door, Solid, World
from .map_file import read_map_file

FORMAT = "wall-map/1"
FARTHEST = 1e7  # m; beyond, coordinates lose their micrometres
_LARGEST_FILE = 100_000_000  # bytes
_NAMES = {"walls": "wall", "unknown": "unknown", "furniture": "furniture", "stairs": "stairs"}
_SHAPE = "[[x, y], ...], at least 3 points, finite, in metres"


def read_wall_map(file: Path, *, unknown_is_occupied: bool = True) -> World:
    """Read a `wall-map/1` file: walls, unknown areas, furniture and stairs become solids.

    Each polygon `[shell, hole, ...]` is one solid from floor to ceiling, named after its list and
    its place there, counted from 0. `doors` become doors in the file's order, headed along
    `normal_rad`; `bounds`, if given, become the world's bounds. Other fields are left alone.

    Args:
        file: The JSON file.
        unknown_is_occupied: Whether the areas under `unknown` are solid.

    Raises:
        SceneError: If the map cannot be used; says which field and why.
    """
    document = _Document(str(file), _load(file))
    solids = tuple(
        Solid(polygon, name=f"{name} {index}")
        for field, name in _NAMES.items()
        if unknown_is_occupied or field != "unknown"
        for index, polygon in enumerate(document.polygons(field))
    )
    return World(solids, document.bounds(), doors=document.doors())


def _load(file: Path) -> dict[str, Any]:
    """Return the JSON object in the file, known to call itself a wall map."""
    place = str(file)
    content = read_map_file(file, _LARGEST_FILE)
    try:
        document = json.loads(content)
    except json.JSONDecodeError as error:
        raise SceneError(f"this is not JSON: {error.msg}", file=place, line=error.lineno) from error
    except (ValueError, RecursionError) as error:
        raise SceneError("this is not JSON text", file=place) from error
    found = document.get("format") if isinstance(document, dict) else type(document).__name__
    if found != FORMAT:
        problem = "this JSON is no wall map"
        raise SceneError(problem, file=place, field="format", value=found, allowed=FORMAT)
    return dict(document)


@dataclass(frozen=True, eq=False)
class _Document:
    """A wall map's fields, checked as they are asked for.

    Attributes:
        file: Name of the file, for messages.
        fields: The JSON object.
    """

    file: str
    fields: dict[str, Any]

    def polygons(self, field: str) -> list[shapely.Polygon]:
        """Return the polygons of a list; an absent list is empty."""
        return [
            self._polygon(rings, f"{field}[{index}]")
            for index, rings in enumerate(self._list(field))
        ]

    def bounds(self) -> tuple[float, float, float, float] | None:
        """Return x_min, y_min, x_max, y_max [m], or None if there are none."""
        if "bounds" not in self.fields:
            return None
        allowed = "[x_min, y_min, x_max, y_max], finite, in metres"
        bounds = self._numbers(self.fields["bounds"], "bounds", (4,), allowed)
        x_min, y_min, x_max, y_max = (float(value) for value in bounds)
        if not (x_min < x_max and y_min < y_max):
            raise self._error("the bounds enclose nothing", "bounds", bounds.tolist(), allowed)
        return x_min, y_min, x_max, y_max

    def doors(self) -> tuple[Door, ...]:
        """Return the doors in the file's order."""
        return tuple(
            self._door(door, f"doors[{index}]") for index, door in enumerate(self._list("doors"))
        )

    def _door(self, door: Any, field: str) -> Door:
        if not isinstance(door, dict):
            raise self._error("a door must be an object", field, door, "centre, width, normal_rad")
        center = self._numbers(door.get("centre"), f"{field}.centre", (2,), "[x, y] in metres")
        width = self._numbers(door.get("width"), f"{field}.width", (), "metres, more than 0")
        normal = self._numbers(door.get("normal_rad"), f"{field}.normal_rad", (), "radians")
        if width <= 0.0:
            raise self._error("a door must be open", f"{field}.width", float(width), "more than 0")
        heading = math.remainder(float(normal), math.tau)
        return Door((float(center[0]), float(center[1])), float(width), heading)

    def _polygon(self, rings: Any, field: str) -> shapely.Polygon:
        if not isinstance(rings, list) or not rings:
            raise self._error(
                "a polygon must be a list of rings", field, rings, "[shell, hole, ...]"
            )
        shell, *holes = [
            self._numbers(ring, f"{field}[{index}]", (-1, 2), _SHAPE)
            for index, ring in enumerate(rings)
        ]
        polygon = shapely.Polygon(shell, holes)
        if not polygon.is_valid or polygon.area <= 0.0:
            reason = shapely.is_valid_reason(polygon)
            why = "no area" if reason == "Valid Geometry" else reason
            raise self._error(
                f"the polygon is not valid: {why}", field, None, "rings that do not cross"
            )
        return polygon

    def _list(self, field: str) -> list[Any]:
        found = self.fields.get(field, [])
        if not isinstance(found, list):
            raise self._error("this field must be a list", field, found, "[...]")
        return found

    def _numbers(self, found: Any, field: str, shape: tuple[int, ...], allowed: str) -> Array:
        """Return an array of finite numbers of a shape; -1 stands for 3 or more."""
        try:
            array = np.array(found)
        except ValueError:  # rows of different lengths
            array = np.array(None)
        fits = array.ndim == len(shape) and all(
            have == want or (want == -1 and have >= 3)
            for have, want in zip(array.shape, shape, strict=True)
        )
        if not fits or array.dtype.kind not in "if" or not (np.abs(array) <= FARTHEST).all():
            raise self._error("this must be numbers in range", field, found, allowed)
        return array.astype(float)

    def _error(self, problem: str, field: str, value: Any, allowed: str) -> SceneError:
        return SceneError(problem, file=self.file, field=field, value=value, allowed=allowed)
