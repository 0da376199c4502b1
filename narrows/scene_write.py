"""Scenes as text people can read: one line a solid, SI units, degrees for headings."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely

from .vehicle import Layer, Vehicle
from .world import FLOOR_TO_CEILING, Door, MovingSolid, Solid, World


def vehicle_entry(vehicle: Vehicle) -> dict[str, Any]:
    """Return the `vehicle:` entry of a chair, all numbers spelled out."""
    limits = {name: value for name, value in vars(vehicle.limits).items() if math.isfinite(value)}
    return {
        "name": vehicle.name,
        **_body(vehicle.layers),
        "track": vehicle.track,
        "wheel_radius": vehicle.wheel_radius,
        "limits": limits,
    }


def world_entry(world: World) -> dict[str, Any]:
    """Return the `world:` entry of a world."""
    entry: dict[str, Any] = {} if world.bounds is None else {"bounds": list(world.bounds)}
    entry["solids"] = [_solid(solid) for solid in world.solids]
    entry["moving"] = [_moving(moving) for moving in world.moving]
    entry["doors"] = [_door(door) for door in world.doors]
    return {key: value for key, value in entry.items() if value}


def pose_entry(pose: Any) -> dict[str, float]:
    """Return {x, y, heading_deg} of a pose (3,)."""
    x, y, heading = (float(value) for value in pose)
    return {"x": x, "y": y, "heading_deg": math.degrees(heading)}


def to_yaml(document: dict[str, Any]) -> str:
    """Return the text of a document: mappings and lists, text and numbers."""
    return "".join(_block(document, 0))


def _body(layers: tuple[Layer, ...]) -> dict[str, Any]:
    if len(layers) > 1 or layers[0].z[0] != 0.0:
        slabs = [{"polygon": layer.polygon.tolist(), "z": list(layer.z)} for layer in layers]
        return {"layers": slabs}
    polygon, height = layers[0].polygon, layers[0].z[1]
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    sizes = float(high[0] - low[0]), float(high[1] - low[1]), float(-low[0])
    if 0.0 <= sizes[2] <= sizes[0]:
        again = Vehicle.rectangle(*sizes).outline
        if np.array_equal(again, polygon):
            names = ("length", "width", "rear_overhang")
            return {"body": dict(zip(names, sizes, strict=True)), "height": height}
    return {"body": {"polygon": polygon.tolist()}, "height": height}


def _tail(thing: Solid | MovingSolid) -> dict[str, Any]:
    heights = {} if thing.z == FLOOR_TO_CEILING else {"z": list(thing.z)}
    return {**heights, "name": thing.name}


def _ring(ring: shapely.LinearRing) -> list[list[float]]:
    return [list(corner) for corner in ring.coords[:-1]]


def _solid(solid: Solid) -> dict[str, Any]:
    if isinstance(solid.shape, shapely.Point):
        return {"circle": [solid.shape.x, solid.shape.y, solid.radius], **_tail(solid)}
    entry: dict[str, Any] = {"polygon": _ring(solid.shape.exterior)}
    if solid.shape.interiors:
        entry["holes"] = [_ring(hole) for hole in solid.shape.interiors]
    return {**entry, **_tail(solid)}


def _moving(moving: MovingSolid) -> dict[str, Any]:
    circle = [0.0, 0.0, moving.radius]
    return {"circle": circle, "path": moving.path.tolist(), **_tail(moving)}


def _door(door: Door) -> dict[str, Any]:
    heading = math.degrees(door.heading)
    return {"center": list(door.center), "width": door.width, "heading_deg": heading}


def _block(value: dict[str, Any], depth: int) -> list[str]:
    lines = []
    for key, entry in value.items():
        lead = "  " * depth + f"{key}:"
        if isinstance(entry, dict) and entry and depth == 0 and key in ("world", "vehicle"):
            lines += [f"{lead}\n", *_block(entry, depth + 1)]
        elif isinstance(entry, list) and entry and isinstance(entry[0], dict):
            rows = [f"{'  ' * depth}  - {_flow(row)}\n" for row in entry]
            lines += [f"{lead}\n", *rows]
        else:
            lines.append(f"{lead} {_flow(entry)}\n")
    return lines


def _flow(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {_flow(entry)}' for key, entry in value.items())}}}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_flow(entry) for entry in value)}]"
    if isinstance(value, str):
        return _quoted(value)
    return repr(float(value))


def _quoted(text: str) -> str:
    """Return text in double quotes, with what YAML does not take as it stands escaped."""
    return '"' + "".join(_escaped(character) for character in text) + '"'


def _escaped(character: str) -> str:
    if character in '"\\':
        return f"\\{character}"
    return character if character.isprintable() else f"\\U{ord(character):08x}"
