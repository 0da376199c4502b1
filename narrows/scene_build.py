"""From the entries of a scene file to vehicle and world, with errors that point into the file."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import shapely
from numpy.typing import ArrayLike

from .errors import SceneError, ShapeError
from .scene_problems import first_of
from .scene_source import Source, Step
from .se2 import Array
from .short_forms import Corridor, Doorway
from .vehicle import Layer, Limits, Vehicle
from .vehicle_presets import preset_entry
from .world import Door, MovingSolid, Solid, World

if TYPE_CHECKING:
    from .scene_model import (
        BodyEntry,
        DoorEntry,
        MovingEntry,
        SceneEntry,
        SolidEntry,
        VehicleEntry,
        WorldEntry,
    )

    Made = TypeVar("Made")

_LEAST_AREA = 1e-6  # m^2: smaller polygons are slips of the pen, and lost in decomposition
_DEFAULT_HEIGHT = 1.3  # m: a seated adult


def build_vehicle(entry: VehicleEntry, source: Source) -> Vehicle:
    """Return the chair of a `vehicle:` entry, presets filled in.

    Raises:
        SceneError: If the preset is unknown, or the body is incomplete or not convex.
    """
    known: VehicleEntry = entry
    if entry.preset is not None:
        known = preset_entry(entry.preset, source)
    layers = _layers(entry, known, source)
    outline = np.concatenate([layer.polygon for layer in layers])
    width = float(np.ptp(outline[:, 1]))
    limits: dict[str, float] = {}
    for given in (known, entry):
        if given.limits is not None:
            limits |= given.limits.model_dump(exclude_none=True)
    return Vehicle(
        layers=layers,
        track=_first(entry.track, known.track, 0.85 * width),
        wheel_radius=_first(entry.wheel_radius, known.wheel_radius, 0.16),
        limits=Limits(**limits),
        name=_first(entry.name, entry.preset, "chair"),
    )


def _first(*choices: Made | None) -> Made:
    return next(choice for choice in choices if choice is not None)


def _layers(entry: VehicleEntry, known: VehicleEntry, source: Source) -> tuple[Layer, ...]:
    path: tuple[Step, ...] = ("vehicle",)
    slabs = known.layers if entry.layers is None and entry.body is None else entry.layers
    if slabs is not None:
        return tuple(
            _layer(source, (*path, "layers", index), slab.polygon, slab.z)
            for index, slab in enumerate(slabs)
        )
    if entry.body is None and known.body is None:
        raise source.error(
            path,
            "a chair needs a body",
            allowed="a name, or body: {length, width, rear_overhang} or {polygon}, or layers",
        )
    height = _first(entry.height, known.height, _DEFAULT_HEIGHT)
    corners = _body_corners(entry.body, known.body, source)
    return (_layer(source, (*path, "body"), corners, (0.0, height)),)


def _layer(
    source: Source, path: tuple[Step, ...], corners: ArrayLike, z: tuple[float, float]
) -> Layer:
    if z[0] < 0.0:
        raise source.error(
            (*path, "z"), "a chair has nothing below the floor", value=z, allowed="0 <= low < high"
        )
    polygon = np.asarray(corners, dtype=float)
    return _made(
        lambda: Layer(polygon, z),
        source,
        (*path, "polygon"),
        value=polygon.tolist(),
        allowed="corners in order around a convex polygon, in the body frame [m]",
    )


def _body_corners(body: BodyEntry | None, known: BodyEntry | None, source: Source) -> Array:
    given = body if body is not None else known
    if given is not None and given.polygon is not None:
        return np.array(given.polygon)
    sizes: dict[str, float] = {}
    for entry in (known, body):
        if entry is not None:
            sizes |= entry.model_dump(exclude_none=True, exclude={"polygon"})
    for key in ("length", "width", "rear_overhang"):
        if key not in sizes:
            raise source.error(
                ("vehicle", "body", key),
                "is missing",
                allowed="a rectangle's length, width and rear_overhang [m], or a polygon",
            )
    if sizes["rear_overhang"] > sizes["length"]:
        raise source.error(
            ("vehicle", "body", "rear_overhang"),
            "the drive axle would stand in front of the body",
            value=sizes["rear_overhang"],
            allowed=f"0 to the length, {sizes['length']:g} m",
        )
    chair = _made(
        lambda: Vehicle.rectangle(sizes["length"], sizes["width"], sizes["rear_overhang"]),
        source,
        ("vehicle", "body"),
        value=sizes,
    )
    return chair.outline


def build_world(
    scene: SceneEntry, source: Source, folder: Path
) -> tuple[World, Doorway | Corridor | None]:
    """Return the world of a scene, and the short form it was built from.

    Raises:
        SceneError: If a solid has an impossible shape, or the short forms do not fit.
    """
    forms = [name for name in ("doorway", "corridor", "map") if getattr(scene, name) is not None]
    if len(forms) > 1:
        raise source.error(
            (forms[1],), f"{forms[1]} and {forms[0]} exclude each other", allowed="one short form"
        )
    if not forms and scene.world is None:
        raise source.error((), "there is no world", allowed="world, doorway, corridor or map")
    form, base = _short_form(scene, source, folder)
    return (base if scene.world is None else _joined(base, scene.world, source)), form


def _short_form(
    scene: SceneEntry, source: Source, folder: Path
) -> tuple[Doorway | Corridor | None, World]:
    if scene.doorway is not None:
        door = scene.doorway
        doorway = _made(lambda: Doorway(**door.model_dump()), source, ("doorway",))
        return doorway, _made(doorway.world, source, ("doorway",))
    if scene.corridor is not None:
        sizes = scene.corridor.model_dump()
        turn = math.radians(sizes.pop("turn_deg"))
        corridor = _made(lambda: Corridor(turn=turn, **sizes), source, ("corridor",))
        return corridor, _made(corridor.world, source, ("corridor",))
    if scene.map is not None:
        from .maps import load_map

        file, unknown = folder / scene.map.file, scene.map.unknown
        return None, _made(lambda: load_map(file, unknown=unknown), source, ("map", "file"))
    return None, World()


def _joined(base: World, entry: WorldEntry, source: Source) -> World:
    """Return a world with the solids, doors and moving things of a `world:` entry added."""
    problems: list[SceneError] = []
    solids: list[Solid] = []
    for index, solid in enumerate(entry.solids):
        try:
            solids.append(_solid(solid, index, source))
        except SceneError as problem:
            problems.append(problem)
    moving: list[MovingSolid] = []
    for index, person in enumerate(entry.moving):
        path = ("world", "moving", index, "path")
        try:
            moving.append(_moving(person, index, source, path))
        except SceneError as problem:
            problems.append(problem)
    if problems:
        raise first_of(problems)
    return World(
        solids=(*base.solids, *solids),
        bounds=base.bounds if entry.bounds is None else entry.bounds,
        moving=(*base.moving, *moving),
        doors=(*base.doors, *(_door(door) for door in entry.doors)),
    )


def _solid(entry: SolidEntry, index: int, source: Source) -> Solid:
    path = ("world", "solids", index)
    if entry.circle is not None:
        x, y, radius = entry.circle
        name = f"circle {index + 1}" if entry.name is None else entry.name
        return Solid.circle(x, y, radius, z=entry.z, name=name)
    with np.errstate(all="ignore"):  # coordinates that are almost zero underflow harmlessly
        shape = shapely.Polygon(entry.polygon, entry.holes or [])
        reason = "" if shape.is_valid else shapely.is_valid_reason(shape)
    if reason:
        raise source.error(
            (*path, "polygon"),
            _crossing(reason),
            value=entry.polygon,
            allowed="corners in order around a polygon that does not cross itself",
        )
    if shape.area < _LEAST_AREA:
        raise source.error(
            (*path, "polygon"),
            f"the polygon has an area of {shape.area:g} m^2",
            allowed=f"at least {_LEAST_AREA:g} m^2",
        )
    name = f"wall {index + 1}" if entry.name is None else entry.name
    return Solid(shape, 0.0, entry.z, name)


def _crossing(reason: str) -> str:
    """Return why a polygon is not simple, for people, with the place."""
    found = re.fullmatch(r"(.*)\[(\S+) (\S+)\]", reason)
    if found is None:
        return f"not a simple polygon: {reason}"
    what, x, y = found[1].lower(), float(found[2]), float(found[3])
    if "hole" in what or "nested" in what or "disconnected" in what:
        return f"its holes do not fit at ({x:g}, {y:g}): {what}"
    return f"the polygon crosses or touches itself at ({x:g}, {y:g})"


def _moving(entry: MovingEntry, index: int, source: Source, place: tuple[Step, ...]) -> MovingSolid:
    x, y, radius = entry.circle
    name = f"person {index + 1}" if entry.name is None else entry.name
    path = np.array(entry.path) + np.array([0.0, x, y])
    return _made(
        lambda: MovingSolid(radius, path, entry.z, name),
        source,
        place,
        value=entry.path,
        allowed="rows [t, x, y] with increasing times",
    )


def _door(entry: DoorEntry) -> Door:
    return Door(entry.center, entry.width, math.radians(entry.heading_deg))


def _made(
    make: Callable[[], Made],
    source: Source,
    path: tuple[Step, ...],
    *,
    value: object = None,
    allowed: str | None = None,
) -> Made:
    """Return what is made; a wrong shape becomes an error that points into the file."""
    try:
        return make()
    except ShapeError as error:
        raise source.error(path, str(error), value=value, allowed=allowed) from None
