"""What part of the world a picture shows."""

from __future__ import annotations

import numpy as np
import shapely

from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import Array, transform
from narrows.world import World

ViewBox = tuple[float, float, float, float]

_AROUND = 0.8  # m of surroundings at least
_SHAPE = 0.6  # least ratio of the sides of a cropped view
_CROPPED = 4.0  # a world more than so many times the motion's surroundings is cropped


def view_box(scene: Scene, paths: list[Path], among: Array | None = None) -> ViewBox:
    """Return x_min, y_min, x_max, y_max of what to show [m].

    The whole world where it is small; else the surroundings of start, goal and the motions.

    Args:
        scene: The scene.
        paths: Motions to show.
        among: Further poses to show, shape (N, 3).
    """
    poses = [scene.start[None], scene.goal.pose[None], *([] if among is None else [among])]
    poses += [path(np.linspace(0.0, path.span, 200)) for path in paths]
    corners = transform(np.concatenate(poses), scene.vehicle.outline).reshape(-1, 2)
    low, high = corners.min(axis=0), corners.max(axis=0)
    around = np.maximum(_AROUND, 0.15 * (high - low).max())
    low, high = low - around, high + around
    short = np.maximum(_SHAPE * (high - low).max() - (high - low), 0.0)
    low, high = low - 0.5 * short, high + 0.5 * short
    world = world_box(scene.world)
    if world is not None:
        world_low, world_high = np.array(world[:2]), np.array(world[2:])
        area = float(np.prod(world_high - world_low))
        if area <= _CROPPED * float(np.prod(high - low)):
            edge = 0.02 * float((world_high - world_low).max())
            low = np.minimum(corners.min(axis=0), world_low) - edge
            high = np.maximum(corners.max(axis=0), world_high) + edge
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def world_box(world: World) -> ViewBox | None:
    """Return the box around bounds and everything in the world [m]; None if it is empty."""
    boxes: list[Array] = []
    if world.bounds is not None:
        boxes.append(np.array(world.bounds))
    for solid in world.solids:
        grow = np.array([-1.0, -1.0, 1.0, 1.0]) * solid.radius
        boxes.append(np.array(shapely.bounds(solid.shape)) + grow)
    for moving in world.moving:
        low, high = moving.path[:, 1:].min(axis=0), moving.path[:, 1:].max(axis=0)
        boxes.append(np.concatenate([low - moving.radius, high + moving.radius]))
    if not boxes:
        return None
    stack = np.array(boxes)
    low, high = stack[:, :2].min(axis=0), stack[:, 2:].max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])
