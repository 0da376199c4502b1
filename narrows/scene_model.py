"""The scene format as a pydantic model: keys, types and ranges; the JSON Schema comes from it.

Field descriptions end up in error messages ("allowed: ..."): meaning and unit in few words. What
one entry cannot say alone (presets, shapes, what fits what) is checked in `scene_build`.
"""

from __future__ import annotations

import unicodedata
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    model_validator,
)
from pydantic_core import PydanticCustomError

_CONTROLS = {"Cc", "Cs", "Zl", "Zp"}  # control characters, surrogates, line separators


def _plain_text(text: str) -> str:
    if any(unicodedata.category(character) in _CONTROLS for character in text):
        raise PydanticCustomError("text", "must be one line of printable text")
    return text


def _rising(pair: tuple[float, float]) -> tuple[float, float]:
    if not pair[0] < pair[1]:
        raise PydanticCustomError("order", "the first number must be less than the second")
    return pair


def _box(bounds: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    x_min, y_min, x_max, y_max = bounds
    if not (x_min < x_max and y_min < y_max):
        raise PydanticCustomError("order", "needs x_min < x_max and y_min < y_max")
    return bounds


def _by_name(entry: Any) -> Any:
    return {"preset": entry} if isinstance(entry, str) else entry


_Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Coordinate = Annotated[_Number, Field(ge=-1e6, le=1e6, description="a coordinate [m]")]
Length = Annotated[_Number, Field(ge=1e-3, le=1e3, description="a length [m]")]
Size = Annotated[_Number, Field(ge=1e-3, le=20.0, description="a size of a chair [m]")]
Amount = Annotated[_Number, Field(gt=0.0, le=1e3)]
Degrees = Annotated[_Number, Field(ge=-3600.0, le=3600.0)]
Height = Annotated[_Number, Field(ge=-100.0, le=1e3, description="height above the floor [m]")]
Heights = Annotated[
    tuple[Height, Height], AfterValidator(_rising), Field(description="[low, high] [m]")
]
Point = Annotated[tuple[Coordinate, Coordinate], Field(description="a point [x, y] [m]")]
Corners = Annotated[list[Point], Field(min_length=3, description="corners [[x, y], ...] [m]")]
Circle = Annotated[
    tuple[Coordinate, Coordinate, Length], Field(description="a circle [x, y, radius] [m]")
]
Text = Annotated[str, Field(max_length=200), AfterValidator(_plain_text)]


class Entry(BaseModel):
    """A mapping of the format: every key known, nothing converted silently."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class LimitsEntry(Entry):
    """What the drive may do; what is left out keeps the preset's or the default value."""

    speed: Amount | None = Field(None, description="forward speed [m/s]")
    reverse_speed: Annotated[_Number, Field(ge=0.0, le=1e3)] | None = Field(
        None, description="backward speed [m/s]; 0 = forward only"
    )
    acceleration: Amount | None = Field(None, description="along the path [m/s^2]")
    jerk: Amount | None = Field(None, description="along the path [m/s^3]")
    yaw_rate: Amount | None = Field(None, description="heading rate [rad/s]")
    yaw_acceleration: Amount | None = Field(None, description="[rad/s^2]")
    lateral_acceleration: Amount | None = Field(None, description="v omega [m/s^2]")
    curvature: Amount | None = Field(
        None, description="greatest curvature [1/m]; absent = may turn on the spot"
    )


class BodyEntry(Entry):
    """The chair seen from above: a rectangle, or a convex polygon in the body frame."""

    length: Size | None = Field(None, description="overall length [m]")
    width: Size | None = Field(None, description="overall width [m]")
    rear_overhang: Annotated[_Number, Field(ge=0.0, le=20.0)] | None = Field(
        None, description="how far the body reaches behind the drive axle [m]"
    )
    polygon: Corners | None = Field(
        None, description="convex corners [[x, y], ...] in the body frame [m]"
    )

    @model_validator(mode="after")
    def _one_shape(self) -> BodyEntry:
        if self.polygon is not None and len(self.model_fields_set) > 1:
            raise PydanticCustomError(
                "choice", "a polygon and a rectangle's sizes exclude each other"
            )
        return self


class LayerEntry(Entry):
    """A convex slab of the body between two heights."""

    polygon: Corners = Field(description="convex corners [[x, y], ...] in the body frame [m]")
    z: Heights = Field(description="[low, high] above the floor [m], 0 <= low < high")


class VehicleEntry(Entry):
    """A chair: a preset, a body of its own, or a preset with changes."""

    preset: Text | None = Field(None, description="name of a chair that comes with narrows")
    name: Text | None = Field(None, description="name for people")
    body: BodyEntry | None = Field(None, description="{length, width, rear_overhang} or {polygon}")
    height: Size | None = Field(None, description="top of the chair with its occupant [m]")
    layers: Annotated[list[LayerEntry], Field(min_length=1, max_length=50)] | None = Field(
        None, description="[{polygon, z}, ...] in place of body and height"
    )
    track: Size | None = Field(None, description="distance between the drive wheels [m]")
    wheel_radius: Size | None = Field(None, description="radius of the drive wheels [m]")
    limits: LimitsEntry | None = Field(None, description="limits of the drive")

    @model_validator(mode="after")
    def _one_body(self) -> VehicleEntry:
        if self.layers is not None and (self.body is not None or self.height is not None):
            raise PydanticCustomError("choice", "layers stand in place of body and height")
        return self


class PresetEntry(VehicleEntry):
    """A chair that comes with narrows: every number has its source."""

    title: Text = Field(description="what chair this is")
    sources: dict[str, str] = Field(
        description="where each number comes from, by dotted path; 'assumed: why' where nowhere"
    )


class SolidEntry(Entry):
    """A wall or a piece of furniture: a polygon or a circle extruded between two heights."""

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["polygon"]}, {"required": ["circle"]}]}
    )

    polygon: Corners | None = Field(
        None, description="corners [[x, y], ...] of a polygon that does not cross itself [m]"
    )
    holes: list[Corners] | None = Field(None, description="corners of holes in the polygon [m]")
    circle: Circle | None = Field(None, description="[x, y, radius] [m]")
    z: Heights = Field((0.0, 2.5), description="[low, high] above the floor [m]")
    name: Text | None = Field(None, description="name for people")

    @model_validator(mode="after")
    def _one_shape(self) -> SolidEntry:
        if (self.polygon is None) == (self.circle is None):
            raise PydanticCustomError("choice", "needs either polygon or circle")
        if self.holes and self.polygon is None:
            raise PydanticCustomError("choice", "holes need a polygon")
        return self


class MovingEntry(Entry):
    """A person or another cylinder that moves along straight lines between times."""

    circle: Circle = Field(description="[x, y, radius] about the path's points [m]")
    path: Annotated[list[tuple[Coordinate, Coordinate, Coordinate]], Field(min_length=1)] = Field(
        description="rows [t, x, y] [s, m, m], times increasing"
    )
    z: Heights = Field((0.0, 2.5), description="[low, high] above the floor [m]")
    name: Text | None = Field(None, description="name for people")


class DoorEntry(Entry):
    """A known doorway."""

    center: Point = Field(description="[x, y] in the middle of the opening and the wall [m]")
    width: Length = Field(description="clear width [m]")
    heading_deg: Degrees = Field(
        description="direction of driving through, corridor to room, in degrees"
    )


class WorldEntry(Entry):
    """What the chair must not touch."""

    bounds: (
        Annotated[
            tuple[Coordinate, Coordinate, Coordinate, Coordinate],
            AfterValidator(_box),
        ]
        | None
    ) = Field(None, description="[x_min, y_min, x_max, y_max] that nothing leaves [m]")
    solids: list[SolidEntry] = Field([], description="walls and furniture")
    moving: list[MovingEntry] = Field([], description="people and other moving things")
    doors: list[DoorEntry] = Field([], description="known doorways")


class DoorwayEntry(Entry):
    """Short form: a corridor along x, a door in its left wall, a room behind it."""

    corridor_width: Length = Field(description="between the corridor's walls [m]")
    door_width: Length = Field(description="clear width of the door [m]")
    door_position: Coordinate = Field(1.6, description="x of the door's middle [m]")
    wall_thickness: Length = Field(0.1, description="thickness of all walls [m]")
    room: tuple[Length, Length] = Field((4.0, 3.0), description="[width, depth] of the room [m]")


class CorridorEntry(Entry):
    """Short form: a corridor along x that turns."""

    width: Length = Field(description="before the turn [m]")
    turn_deg: Degrees = Field(90.0, description="left positive, right negative, in degrees")
    width_after: Length | None = Field(None, description="after the turn [m]; absent = width")
    length: Length = Field(3.0, description="of each leg outside the corner [m]")
    wall_thickness: Length = Field(0.1, description="thickness of all walls [m]")


class MapEntry(Entry):
    """Short form: the walls of a map file."""

    file: Text = Field(
        description="a ROS map_server map (.yaml) or a wall-map/1 JSON, beside the scene file"
    )
    unknown: Literal["occupied", "free"] = Field(
        "occupied", description="what unknown cells count as: occupied or free"
    )


class PoseEntry(Entry):
    """Where the middle of the drive axle is, and where the chair looks."""

    x: Coordinate = Field(description="of the middle of the drive axle [m]")
    y: Coordinate = Field(description="of the middle of the drive axle [m]")
    heading_deg: Degrees = Field(description="counter-clockwise from the x axis, in degrees")


class GoalEntry(PoseEntry):
    """The pose to reach, and how exactly."""

    position_tolerance: Amount = Field(0.05, description="radius about the goal [m]")
    heading_tolerance_deg: Annotated[_Number, Field(gt=0.0, le=180.0)] = Field(
        3.0, description="either side of the heading, in degrees"
    )


class SceneEntry(Entry):
    """A scene: a chair, a world, where to start and where to go."""

    model_config = ConfigDict(
        json_schema_extra={
            "anyOf": [{"required": [key]} for key in ("world", "doorway", "corridor", "map")]
        }
    )

    name: Text = Field("", description="name for people")
    vehicle: Annotated[
        VehicleEntry,
        BeforeValidator(_by_name, json_schema_input_type=VehicleEntry | str),
        Field(description="a chair by name, or {body, height, track, wheel_radius, limits}"),
    ]
    world: WorldEntry | None = Field(None, description="{bounds, solids, moving, doors}")
    doorway: DoorwayEntry | None = Field(
        None, description="{corridor_width, door_width, door_position, wall_thickness, room}"
    )
    corridor: CorridorEntry | None = Field(
        None, description="{width, turn_deg, width_after, length, wall_thickness}"
    )
    map: MapEntry | None = Field(None, description="{file, unknown}")
    start: PoseEntry | None = Field(None, description="{x, y, heading_deg}")
    goal: GoalEntry | None = Field(
        None,
        description="{x, y, heading_deg, position_tolerance, heading_tolerance_deg}",
    )
    margin: Annotated[_Number, Field(ge=0.0, le=10.0)] = Field(
        0.02, description="clearance asked for [m]"
    )
