"""The scene in 3-D: world, chair, ends, motions and marks, on the page and in its replays."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely
from viser import SceneApi

from narrows.scene import Scene
from narrows.se2 import Array, transform
from narrows.vehicle import Vehicle
from narrows.world import FLOOR_TO_CEILING, Door, Solid

from . import palette
from .chair_mesh import chair_parts
from .motion_shapes import swept_floor
from .page_camera import CUT
from .solids_mesh import Mesh, edges_of, flat_mesh, joined, solid_mesh
from .view_box import view_box, world_box

WALL: tuple[int, int, int] = (150, 150, 148)
THING: tuple[int, int, int] = (176, 137, 92)
FLOOR: tuple[int, int, int] = (238, 236, 230)

_DASH = 0.12  # m
_PIN = 1.5  # m
_SWEPT, _PATH, _LABEL = 0.01, 0.06, 0.3  # m above the floor


def rgb(colour: str) -> tuple[int, int, int]:
    """Return `#rrggbb` as numbers.

    >>> rgb("#0072B2")
    (0, 114, 178)
    """
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def turn(heading: float) -> tuple[float, float, float, float]:
    """Return the quaternion [w, x, y, z] of a turn about z [rad]."""
    return math.cos(0.5 * heading), 0.0, 0.0, math.sin(0.5 * heading)


def is_thing(solid: Solid) -> bool:
    """Return whether a solid is furniture rather than a wall: round, or not up to the ceiling."""
    return solid.radius > 0.0 or solid.z != FLOOR_TO_CEILING


class SceneDrawing:
    """What stands in a 3-D scene; every method replaces what it drew before."""

    def __init__(self, api: SceneApi) -> None:
        """Draw into the scene of a page or of a replay."""
        self.api = api
        self._named: dict[str, list[Any]] = {}
        self._tints: dict[str, str] = {}

    def stage(self) -> None:
        """Set up the light and which way is up."""
        self.api.set_up_direction("+z")
        self.api.configure_default_lights(False)
        self.api.add_light_ambient("/light/everywhere", intensity=1.6)
        self.api.add_light_directional(
            "/light/sun", intensity=1.7, position=(-2.0, -4.0, 7.0), cast_shadow=False
        )
        self.api.configure_environment_map(None)

    def remove(self, group: str) -> None:
        """Take away what was drawn under a name."""
        for handle in reversed(self._named.pop(group, [])):  # parents last: they take the rest away
            handle.remove()

    def keep(self, group: str, *handles: Any) -> None:
        """Remember what was drawn under a name."""
        self._named.setdefault(group, []).extend(handles)

    def mesh(self, name: str, mesh: Mesh, colour: tuple[int, int, int], **looks: Any) -> Any:
        """Add triangles of one colour and return their handle."""
        return self.api.add_mesh_simple(
            name,
            mesh.vertices.astype(np.float32),
            mesh.faces.astype(np.uint32),
            color=colour,
            flat_shading=True,
            side="front",  # of both sides, what is seen through would be drawn twice
            cast_shadow=False,  # shadows cost seconds where there is no graphics card
            receive_shadow=False,
            **looks,
        )

    def world(self, scene: Scene) -> None:
        """Draw the floor, the walls cut at `CUT`, and the doors; not the things."""
        self.remove("world")
        box = world_box(scene.world) or view_box(scene, [])
        ends = [transform(pose, scene.vehicle.outline) for pose in (scene.start, scene.goal.pose)]
        shown = shapely.MultiPoint(np.concatenate([*ends, np.reshape(box, (2, 2))])).bounds
        floor = flat_mesh(shapely.box(*shown), -0.004)
        self.keep("world", self.mesh("/world/floor", floor, FLOOR))
        walls = [solid for solid in scene.world.solids if not is_thing(solid)]
        if walls:
            mesh = joined(solid_mesh(solid, solid.z[0], CUT) for solid in walls)
            self.keep("world", self.mesh("/world/walls", mesh, WALL))
            rings = [np.array(ring.coords) for solid in walls for ring in _rings(solid)]
            tops = [_lifted(ring, CUT + 0.002) for ring in rings]
            segments = np.concatenate([np.stack([t[:-1], t[1:]], axis=1) for t in tops])
            self.keep("world", self._lines("/world/edges", segments, rgb(palette.WALL), 1.5))
        for number, door in enumerate(scene.world.doors):
            label = self.api.add_label(
                f"/world/door_{number}",
                f"door {1e3 * door.width:.0f} mm",
                position=_beside(door),
                anchor="bottom-left",
            )
            self.keep("world", label)

    def things(self, scene: Scene) -> dict[int, Any]:
        """Draw furniture, each piece where it is, and return the handles by index of solid."""
        self.remove("things")
        handles: dict[int, Any] = {}
        for index, solid in enumerate(scene.world.solids):
            if is_thing(solid):
                mesh = solid_mesh(solid, *solid.z)
                handles[index] = self.mesh(f"/things/{index}", mesh, THING, opacity=0.9)
        self.keep("things", *handles.values())
        return handles

    def people(self, scene: Scene) -> dict[int, Any]:
        """Draw those who move where they begin, and return their handles by index."""
        self.remove("people")
        handles: dict[int, Any] = {}
        for number, moving in enumerate(scene.world.moving):
            disc = shapely.Point(0.0, 0.0).buffer(moving.radius)
            body = solid_mesh(Solid(disc, 0.0, moving.z), *moving.z)
            handles[number] = self.mesh(
                f"/moving/{number}", body, rgb(palette.ORANGE), opacity=0.75
            )
        self.keep("people", *handles.values())
        self.at_time(scene, 0.0)
        return handles

    def at_time(self, scene: Scene, time: float) -> None:
        """Put people where they are at a time [s]."""
        for number, moving in enumerate(scene.world.moving):
            handle = self.api.get_handle_by_name(f"/moving/{number}")
            if handle is not None:
                handle.position = (*moving.position(time).tolist(), 0.0)

    def chair(self, vehicle: Vehicle) -> None:
        """Draw the chair with its occupant, and the body it is taken for."""
        self.remove("chair")
        self._tints = {}
        self.keep("chair", self.api.add_frame("/chair", show_axes=False))
        for part in chair_parts(vehicle):
            self.keep("chair", self.mesh(f"/chair/{part.name}", part.mesh, part.colour))
        for number, layer in enumerate(vehicle.layers):
            area = shapely.Polygon(layer.polygon)
            body = solid_mesh(Solid(area, 0.0, layer.z), *layer.z)
            name = f"/chair/body_{number}"
            self.keep("chair", self.mesh(name, body, rgb(palette.SKY), opacity=0.12))
            edges = edges_of(layer.polygon, max(layer.z[0], 0.01), layer.z[1])
            self.keep("chair", self._lines(f"{name}_edges", edges, rgb(palette.BLUE), 1.5))

    def place(self, pose: Array) -> None:
        """Put the chair at a pose (3,)."""
        handle = self.api.get_handle_by_name("/chair")
        if handle is not None:
            handle.position = (float(pose[0]), float(pose[1]), 0.0)
            handle.wxyz = turn(float(pose[2]))

    def tint(self, colour: str) -> None:
        """Give the chair's body a colour: who is in control."""
        for number in range(len(self._named.get("chair", []))):
            for name in (f"/chair/body_{number}", f"/chair/body_{number}_edges"):
                handle: Any = self.api.get_handle_by_name(name)
                if handle is not None and self._tints.get(name) != colour:
                    self._tints[name] = colour
                    if name.endswith("edges"):
                        handle.colors = np.array(rgb(colour), dtype=np.uint8)
                    else:
                        handle.color = rgb(colour)

    def end(self, name: str, vehicle: Vehicle, pose: Array) -> dict[str, Any]:
        """Draw `start` or `goal`: the body's print on the floor, an arrow; return their handles."""
        self.remove(name)
        colour = rgb(palette.START if name == "start" else palette.GOAL)
        frame = self.api.add_frame(
            f"/{name}", show_axes=False, position=(*pose[:2], 0.0), wxyz=turn(float(pose[2]))
        )
        low = _SWEPT
        print_ = flat_mesh(shapely.Polygon(vehicle.outline), low + 0.02)
        body = self.mesh(f"/{name}/print", print_, colour, opacity=0.35)
        ring = np.concatenate([vehicle.outline, vehicle.outline[:1]])
        edge = _lifted(ring, low + 0.03)
        outline = self._lines(
            f"/{name}/outline", np.stack([edge[:-1], edge[1:]], axis=1), colour, 3.0
        )
        tip = vehicle.front_overhang + 0.28
        head = np.array([[tip, 0.0], [tip - 0.2, 0.11], [tip - 0.2, -0.11]])
        arrow = self.mesh(
            f"/{name}/arrow", flat_mesh(shapely.Polygon(head), low + 0.03), colour, opacity=0.95
        )
        text = self.api.add_label(
            f"/{name}/label", name, position=(tip, 0.0, 0.05), anchor="bottom-center"
        )
        self.keep(name, frame, body, outline, arrow, text)
        return {"frame": frame, "body": body, "arrow": arrow}

    def motion(self, group: str, vehicle: Vehicle, poses: Array, *, fault: str = "") -> None:
        """Draw a motion: the floor it sweeps and the way of the axle.

        One that is not certified, or touched something, is dashed and red and says so.

        Args:
            group: `plan` or `drive`.
            vehicle: The body that sweeps.
            poses: The motion, rows close to each other, shape (N, 3), N >= 2.
            fault: Why it must not be taken for one that is clear, or empty.
        """
        self.remove(group)
        driven = group == "drive"
        colour = rgb(palette.REFUSED if fault else palette.GREEN if driven else palette.BLUE)
        level = _SWEPT + (0.01 if driven else 0.0)
        swept = flat_mesh(swept_floor(vehicle.outline, poses), level)
        opacity = 0.12 if driven else 0.25
        self.keep(group, self.mesh(f"/{group}/swept", swept, colour, opacity=opacity))
        points = _lifted(poses[:, :2], _PATH + (0.01 if driven else 0.0))
        segments = np.stack([points[:-1], points[1:]], axis=1)
        ahead = np.column_stack([np.cos(poses[:-1, 2]), np.sin(poses[:-1, 2])])
        reverse = np.einsum("nd,nd->n", np.diff(poses[:, :2], axis=0), ahead) < -1e-9
        if fault:
            along = np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))
            shown = (along // _DASH) % 2 == 0
            segments, reverse = segments[shown], np.zeros(int(shown.sum()), dtype=bool)
            middle = (*points[len(points) // 2, :2].tolist(), _LABEL)
            self.keep(group, self.api.add_label(f"/{group}/fault", fault, position=middle))
        for name, kept, shade in (
            ("forward", ~reverse, colour),
            ("reverse", reverse, rgb(palette.REVERSE)),
        ):
            if kept.any():
                self.keep(group, self._lines(f"/{group}/{name}", segments[kept], shade, 4.0))

    def mark(self, at: Array | None, text: str, *, bad: bool) -> None:
        """Mark the narrowest place with a pin and a text; None: no mark."""
        self.remove("mark")
        if at is None:
            return
        x, y = float(at[0]), float(at[1])
        colour = rgb(palette.REFUSED if bad else palette.INK)
        pin = np.array([[[x, y, 0.0], [x, y, _PIN]]])
        disc = flat_mesh(shapely.Point(x, y).buffer(0.12), 0.02)
        label = self.api.add_label(
            "/mark/label", text, position=(x, y, _PIN), anchor="bottom-center"
        )
        self.keep(
            "mark",
            self._lines("/mark/pin", pin, colour, 4.0),
            self.mesh("/mark/disc", disc, colour, opacity=0.85),
            label,
        )

    def _lines(self, name: str, segments: Array, colour: tuple[int, int, int], width: float) -> Any:
        """Add line segments (S, 2, 3) of a width in pixels."""
        return self.api.add_line_segments(
            name, segments.astype(np.float32), colour, thickness=width, thickness_units="screen"
        )


def _beside(door: Door) -> tuple[float, float, float]:
    """Return where a door's label stands: on the wall, to the right of who drives through."""
    right = np.array([math.sin(door.heading), -math.cos(door.heading)])
    x, y = (np.asarray(door.center) + (0.5 * door.width + 0.1) * right).tolist()
    return x, y, CUT + 0.02


def _rings(solid: Solid) -> list[shapely.LinearRing]:
    shape = solid.shape
    if isinstance(shape, shapely.Point):
        shape = shape.buffer(solid.radius)
    return [shape.exterior, *shape.interiors]


def _lifted(points: Array, height: float) -> Array:
    """Return points (N, 2) at a height, (N, 3)."""
    return np.column_stack([points, np.full(len(points), height)])
