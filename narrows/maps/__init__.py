"""Maps of others as worlds: occupancy grids of ROS and `wall-map/1` vector maps."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from ..errors import SceneError
from ..world import World
from .ros_map import read_ros_map
from .wall_map import read_wall_map

__all__ = ["load_map", "read_ros_map", "read_wall_map"]


def load_map(file: Path | str, *, unknown: Literal["occupied", "free"] = "occupied") -> World:
    """Read a map: a map_server map (`.yaml`, `.yml`) or a `wall-map/1` file (`.json`).

    Args:
        file: The map's file.
        unknown: Whether places the map knows nothing about are solid or free.

    Raises:
        SceneError: If the map cannot be used; says file, field, value and what is allowed.
    """
    file = Path(file)
    if unknown not in ("occupied", "free"):
        raise SceneError(
            "unknown places are one or the other",
            field="unknown",
            value=unknown,
            allowed="occupied or free",
        )
    suffix = file.suffix.lower()
    if suffix in (".yaml", ".yml"):
        return read_ros_map(file, unknown_is_occupied=unknown == "occupied")
    if suffix == ".json":
        return read_wall_map(file, unknown_is_occupied=unknown == "occupied")
    raise SceneError(
        "a map of this kind cannot be read",
        file=str(file),
        value=suffix,
        allowed=".yaml (map_server) or .json (wall-map/1)",
    )
