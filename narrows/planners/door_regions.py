"""Which door to take, and the convex regions on either side of it.

Everything is measured in the door's frame: xi along the direction of driving through, eta to its
left, origin at the middle of the opening. The corridor is the box before the door's plane
(xi <= 0) that the nearest walls leave free around start and door, the room the box behind it
around door and goal [DoorBezier, C of Eq. (5) and R of Eq. (11b)]; boxes because control points
are kept in them by half-planes. What crosses the door's plane is the door's own wall and bounds
neither. What is round, or shorter than `FURNITURE` both ways, is an obstacle and no wall.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import shapely

from ..errors import ShapeError
from ..geometry import edge_normals
from ..scene import Scene
from ..se2 import Array, invert, transform
from ..vehicle import Vehicle
from ..world import Door, Solid
from .bezier_segment import Obstacle

FURNITURE = 1.0  # [m]


@dataclass(frozen=True, eq=False)
class Passage:
    """A door taken in a direction, with what lies around it.

    Attributes:
        door: The door, its heading the direction of driving.
        corridor: Half-planes [n_x, n_y, c], n . p <= c, of the region before it, shape (H, 3).
        room: The same behind it.
        obstacles_before: Disks to keep away from in the corridor.
        obstacles_behind: Disks to keep away from in the room.
    """

    door: Door
    corridor: Array
    room: Array
    obstacles_before: tuple[Obstacle, ...]
    obstacles_behind: tuple[Obstacle, ...]

    @property
    def pose(self) -> Array:
        """Middle of the door and its heading, shape (3,)."""
        return door_pose(self.door)


def door_pose(door: Door) -> Array:
    """Return the pose in the middle of a door, heading through it, shape (3,)."""
    return np.array([*door.center, door.heading], dtype=float)


def choose_door(scene: Scene) -> Door | str:
    """Return the door between start and goal, turned the way it is driven, or why there is none.

    Of several doors the one with the shortest way start - door - goal.
    """
    doors = scene.world.doors
    if not doors:
        return (
            "the scene names no door; give its middle, width and heading under world.doors, "
            "or use another planner"
        )
    between: list[tuple[float, Door]] = []
    for door in doors:
        ends = np.array([scene.start[:2], scene.goal.pose[:2]])
        depth = transform(invert(door_pose(door)), ends)[:, 0]
        if depth[0] * depth[1] < 0.0:
            driven = door if depth[0] < 0.0 else replace(door, heading=door.heading + math.pi)
            way = float(np.linalg.norm(ends - door.center, axis=1).sum())
            between.append((way, driven))
    if not between:
        x, y = scene.goal.pose[:2]
        return (
            f"no door of the scene lies between start and goal: both are on the same side of "
            f"every door's wall; move the goal ({x:.2f}, {y:.2f}) or use another planner"
        )
    _, chosen = min(between, key=lambda entry: entry[0])
    least = least_width(scene.vehicle)
    if least >= chosen.width:
        return (
            f"the door is {chosen.width:.3f} m wide and the chair at its narrowest {least:.3f} m: "
            f"{1e3 * (least - chosen.width):.0f} mm are missing"
        )
    return chosen


def least_width(vehicle: Vehicle) -> float:
    """Return the least width of the body between parallel lines [m]; an edge lies on one."""
    outline = vehicle.outline
    across = outline @ edge_normals(outline).T
    return float(np.ptp(across, axis=0).min())


def describe_passage(scene: Scene, door: Door, *, keep_off: str) -> Passage:
    """Return the regions and obstacles around a door.

    Args:
        scene: The scene.
        door: The door, heading the way it is driven.
        keep_off: What d_r of [DoorBezier, Eq. (12)] takes of the chair, besides the obstacle's
            radius: "half_width", right beside the chair, or "circumscribed", right everywhere.
    """
    to_door = invert(door_pose(door))
    low, high = scene.vehicle.layers[0].z[0], scene.vehicle.height
    walls: list[Array] = []
    obstacles: list[tuple[float, Obstacle]] = []
    chair = own_reach(scene.vehicle, keep_off)
    for solid in scene.world.solids:
        if solid.z[0] >= high or low >= solid.z[1]:
            continue
        center, radius, is_wall = _as_disk(solid, to_door)
        if is_wall:
            walls += [transform(to_door, piece) for piece in solid.pieces]
        else:
            depth = float(transform(to_door, center[None])[0, 0])
            disk = Obstacle((float(center[0]), float(center[1])), radius + chair)
            obstacles.append((depth, disk))
    spans = np.array([[*wall.min(axis=0), *wall.max(axis=0)] for wall in walls]).reshape(-1, 4)
    ends = transform(to_door, np.array([scene.start[:2], scene.goal.pose[:2]]))
    return Passage(
        door=door,
        corridor=_region(scene, door, spans, ends[0], side=-1.0),
        room=_region(scene, door, spans, ends[1], side=1.0),
        obstacles_before=tuple(disk for depth, disk in obstacles if depth < 0.5),
        obstacles_behind=tuple(disk for depth, disk in obstacles if depth > -0.5),
    )


def own_reach(vehicle: Vehicle, keep_off: str) -> float:
    """Return what the chair adds to d_r [m]."""
    if keep_off == "half_width":
        return float(np.abs(vehicle.outline[:, 1]).max())
    if keep_off == "circumscribed":
        return vehicle.radius
    raise ShapeError(f"keep_off must be 'half_width' or 'circumscribed', got {keep_off!r}")


def _as_disk(solid: Solid, to_door: Array) -> tuple[Array, float, bool]:
    """Return centre and radius of a disk around a solid, and whether it is a wall."""
    if isinstance(solid.shape, shapely.Point):
        return np.array([solid.shape.x, solid.shape.y]), solid.radius, False
    corners = np.asarray(solid.shape.exterior.coords)[:-1]
    extent = np.ptp(transform(to_door, corners), axis=0)
    circle = shapely.minimum_bounding_circle(solid.shape)
    center = np.array([circle.centroid.x, circle.centroid.y])
    radius = float(shapely.minimum_bounding_radius(solid.shape))
    return center, radius, bool(extent.max() >= FURNITURE)


def _region(scene: Scene, door: Door, spans: Array, end: Array, side: float) -> Array:
    """Return the half-planes, in the world, of the box on one side of the door.

    Args:
        scene: For the bounds.
        door: The door.
        spans: xi_min, eta_min, xi_max, eta_max of each wall piece, shape (W, 4).
        end: Start or goal in the door's frame, shape (2,).
        side: -1 before the door, +1 behind it.
    """
    slack = 1e-6
    crosses = (spans[:, 0] < slack) & (spans[:, 2] > -slack)
    on_side = np.where(side < 0.0, spans[:, 2] < -slack, spans[:, 0] > slack)
    walls = spans[on_side & ~crosses]
    low, high = np.minimum(end, 0.0), np.maximum(end, 0.0)
    faces = [(np.array([-side, 0.0]), 0.0)]  # the door's plane
    for axis in (0, 1):
        other = 1 - axis
        facing = walls[(walls[:, other] < high[other]) & (walls[:, other + 2] > low[other])]
        unit = np.eye(2)[axis]
        above = facing[facing[:, axis] >= high[axis] - slack][:, axis]
        below = facing[facing[:, axis + 2] <= low[axis] + slack][:, axis + 2]
        if len(above) and (axis == 1 or side > 0.0):
            faces.append((unit, float(above.min())))
        if len(below) and (axis == 1 or side < 0.0):
            faces.append((-unit, float(-below.max())))
    heading = door.heading
    turn = np.array(
        [[math.cos(heading), -math.sin(heading)], [math.sin(heading), math.cos(heading)]]
    )
    rows = []
    for normal, offset in faces:
        world_normal = turn @ normal
        rows.append([*world_normal, offset + float(world_normal @ door.center)])
    if scene.world.bounds is not None:
        x_min, y_min, x_max, y_max = scene.world.bounds
        rows += [[1.0, 0.0, x_max], [-1.0, 0.0, -x_min], [0.0, 1.0, y_max], [0.0, -1.0, -y_min]]
    return np.array(rows)
