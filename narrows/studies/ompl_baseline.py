"""OMPL as it comes: RRT on Dubins curves with the exact body, then OMPL's own simplification.

Needs the extra `bench`. OMPL draws its random numbers from a generator of its own, so what it finds
differs from run to run.
"""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np
import shapely

from ..errors import MissingExtra, ShapeError
from ..path import Path
from ..scene import Scene
from ..se2 import Array

_TIME = 5.0  # s of wall time that OMPL may search
_SPACING = 0.01  # m between the poses of the path handed back
_CHECKED = 0.01  # m between poses whose body is looked at
_THRESHOLD = 1e-3  # m: distance in OMPL's metric at which the goal counts as reached


def is_installed() -> bool:
    """Return whether OMPL can be imported."""
    return importlib.util.find_spec("ompl") is not None


def ompl_path(scene: Scene) -> Path | None:
    """Return the forward path RRT finds in the time it is given, simplified; or None.

    Args:
        scene: The scene, with bounds, a curvature limit and a body of one layer.

    Raises:
        MissingExtra: If OMPL is not installed.
        ShapeError: If the scene lacks bounds or has a body of several layers.
    """
    if not is_installed():
        raise MissingExtra("ompl", "bench")
    if scene.world.bounds is None or len(scene.vehicle.layers) != 1:
        raise ShapeError("OMPL here needs a scene with bounds and a body of one layer")
    from ompl import base, geometric, util

    util.setLogLevel(util.LOG_ERROR)
    space = base.DubinsStateSpace(1.0 / scene.vehicle.limits.curvature)
    box = base.RealVectorBounds(2)
    x_min, y_min, x_max, y_max = scene.world.bounds
    for axis, (low, high) in enumerate(((x_min, x_max), (y_min, y_max))):
        box.setLow(axis, low)
        box.setHigh(axis, high)
    space.setBounds(box)
    setup = geometric.SimpleSetup(space)
    setup.setStateValidityChecker(_Free(scene))
    ends = [_state(space, pose) for pose in (scene.start, scene.goal.pose)]
    setup.setStartAndGoalStates(*ends, _THRESHOLD)
    information = setup.getSpaceInformation()
    information.setStateValidityCheckingResolution(_CHECKED / space.getMaximumExtent())
    setup.setPlanner(geometric.RRT(information))
    setup.solve(_TIME)
    if not setup.haveExactSolutionPath():
        return None
    setup.simplifySolution()
    found = setup.getSolutionPath()
    found.interpolate(max(2, int(np.ceil(found.length() / _SPACING)) + 1))
    return Path.from_poses([[s.getX(), s.getY(), s.getYaw()] for s in found.getStates()])


class _Free:
    """Whether the body at a state of OMPL's touches nothing and stays inside the bounds."""

    def __init__(self, scene: Scene) -> None:
        layer = scene.vehicle.layers[0]
        solids = [
            solid.shape.buffer(solid.radius, quad_segs=32) if solid.radius else solid.shape
            for solid in scene.world.solids
            if solid.z[0] < layer.z[1] and layer.z[0] < solid.z[1]
        ]
        self.solids = shapely.union_all(solids)
        shapely.prepare(self.solids)
        self.body = layer.polygon
        self.bounds = np.array(scene.world.bounds)

    def __call__(self, state: Any) -> bool:
        """Return whether the state is free."""
        cosine, sine = np.cos(state.getYaw()), np.sin(state.getYaw())
        turn = np.array([[cosine, sine], [-sine, cosine]])
        corners = self.body @ turn + (state.getX(), state.getY())
        if (corners < self.bounds[:2]).any() or (corners > self.bounds[2:]).any():
            return False
        return not shapely.intersects(self.solids, shapely.Polygon(corners))


def _state(space: Any, pose: Array) -> Any:
    """Return a pose as a state of OMPL's."""
    state = space.allocState()
    state.setX(float(pose[0]))
    state.setY(float(pose[1]))
    state.setYaw(float(np.arctan2(np.sin(pose[2]), np.cos(pose[2]))))
    return state
