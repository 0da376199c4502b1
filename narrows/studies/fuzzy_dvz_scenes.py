"""The scenes of the [FuzzyDVZ] study: the paper's runs, and worlds it did not try.

The paper prints starts, targets, some distances and heights; places beside the way are lost with
its figures. Those here are chosen so that each obstacle is met.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import shapely

from ..errors import StudyError
from ..scene import Goal, Scene
from ..se2 import Array
from ..vehicle import Vehicle
from ..world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.2, 0.7, 0.25, name="chair with its occupant")
"""1.2 x 0.7 x 1.3 m, for the random worlds."""

LOW_CHAIR = Vehicle.rectangle(1.0, 0.65, 0.25, height=1.0, track=0.55, name="chair of 1 m height")
"""As high as the paper's "1 m high security zone", for its runs; its own size is not printed."""

NEAR = 0.2
"""How near a goal the chair has to stand [m]: it arrives at 0.1 m and stops."""

_TALL = 1.8  # m: people

KINDS = ("constant", "stop-and-go", "crossing")
"""Ways of walking."""


def scene_of(
    vehicle: Vehicle, world: World, start: tuple[float, float, float], goal: tuple[float, float]
) -> Scene:
    """Return a scene whose goal is a place, at any heading: the controller chooses none."""
    pose = np.array([start[0], start[1], math.radians(start[2])])
    return Scene(vehicle, world, pose, Goal(np.array([*goal, 0.0]), NEAR, math.pi))


def _three_fixed() -> Scene:
    """Three fixed obstacles; start and target are printed."""
    solids = (
        Solid.circle(-1.05, 1.2, 0.25, name="first"),
        Solid.circle(0.35, -0.55, 0.25, name="second"),
        Solid.circle(1.45, -1.0, 0.25, name="third"),
    )
    return scene_of(LOW_CHAIR, World(solids), (-2.5, 2.5, -45.0), (2.5, -2.5))


def _suspended_boxes() -> Scene:
    """Box 1 too low to drive under, box 2 high enough."""
    solids = (
        _box(-0.6, 0.1, 0.6, 0.6, (0.7, 1.0), "box 1, 0.7 m up"),
        _box(1.6, -0.4, 0.6, 1.4, (1.1, 1.4), "box 2, 1.1 m up"),
    )
    return scene_of(LOW_CHAIR, World(solids), (-3.0, 0.0, 0.0), (3.0, 0.0))


def _table_ball_chair() -> Scene:
    """A table, a ball and a chair 1.25, 1.75 and 2.75 m before the camera at the chair's front."""
    camera = -2.2 + LOW_CHAIR.front_overhang
    table, ball, chair = (camera + distance for distance in (1.25, 1.75, 2.75))
    legs = tuple(
        Solid.circle(-0.85 + dx, table + 0.25 + dy, 0.03, z=(0.0, 0.7), name="a table leg")
        for dx in (-0.35, 0.35)
        for dy in (-0.2, 0.2)
    )
    solids = (
        _box(-0.85, table + 0.25, 0.8, 0.5, (0.7, 0.74), "table"),
        *legs,
        Solid.circle(-0.42, ball + 0.12, 0.12, z=(0.0, 0.24), name="ball"),
        _box(-0.45, chair + 0.2, 0.4, 0.4, (0.0, 0.9), "chair"),
    )
    return scene_of(LOW_CHAIR, World(solids), (0.0, -2.2, 90.0), (0.0, 2.2))


def _person() -> Scene:
    """A person who walks towards the chair, stops, walks around it, and comes again."""
    walk = [
        [0.0, 0.3, 3.4],
        [4.0, 0.1, 0.9],
        [5.5, 0.1, 0.9],
        [7.5, 1.3, 0.4],
        [10.0, 1.2, -1.6],
        [12.0, -1.2, -1.9],
        [14.5, -1.4, 0.4],
        [16.0, -0.9, 1.2],
        [19.0, -2.8, 2.2],
    ]
    person = MovingSolid(0.25, np.array(walk), (0.0, 1.75), "person")
    return scene_of(LOW_CHAIR, World(moving=(person,)), (0.0, -2.2, 90.0), (0.0, 2.2))


def _hanging() -> Scene:
    """Three hanging objects, 0.75, 1.2 and 0.5 m up, on the way of a chair of 1 m height."""
    solids = (
        _box(-0.15, -0.6, 0.35, 0.35, (0.75, 1.6), "first, 0.75 m up"),
        _box(0.9, 0.65, 0.5, 0.5, (1.2, 1.6), "second, 1.2 m up"),
        _box(-0.1, 2.3, 0.35, 0.35, (0.5, 1.6), "third, 0.5 m up"),
    )
    return scene_of(LOW_CHAIR, World(solids), (0.0, -2.8, 90.0), (0.0, 4.2))


def _box(
    x: float, y: float, length: float, width: float, z: tuple[float, float], name: str
) -> Solid:
    a, b = 0.5 * length, 0.5 * width
    corners = [[x - a, y - b], [x + a, y - b], [x + a, y + b], [x - a, y + b]]
    return Solid.polygon(corners, z=z, name=name)


PAPER_SCENES: dict[str, Callable[[], Scene]] = {
    "three fixed": _three_fixed,
    "suspended boxes": _suspended_boxes,
    "table, ball, chair": _table_ball_chair,
    "person": _person,
    "three hanging": _hanging,
}
"""The paper's runs by name."""


def cluttered(rng: np.random.Generator, *, count: int | None = None) -> Scene:
    """Return a world of 6 to 12 things between a start and a goal 8 m apart.

    Seven of ten stand on the floor, one in ten is a board 0.75 m up as a table's, two in ten hang
    higher than the chair.
    """
    wanted = int(rng.integers(6, 13)) if count is None else count
    solids: list[Solid] = []
    while len(solids) < wanted:
        x, y = rng.uniform(-3.0, 3.0, 2).tolist()
        if math.hypot(x + 4.0, y) < 1.5 or math.hypot(x - 4.0, y) < 1.2:
            continue
        kind = rng.random()
        z = (0.0, float(rng.uniform(0.3, 1.8)))
        if kind > 0.9:
            z = (0.75, 0.8)
        elif kind > 0.7:
            z = (1.35, 2.0)
        name = f"thing {len(solids) + 1}"
        if rng.random() < 0.5:
            solids.append(Solid.circle(x, y, float(rng.uniform(0.1, 0.4)), z=z, name=name))
        else:
            angle, (a, b) = rng.uniform(0.0, math.pi), 0.5 * rng.uniform(0.2, 0.9, 2)
            cos, sin = math.cos(angle), math.sin(angle)
            corners = np.array([[-a, -b], [a, -b], [a, b], [-a, b]])
            turned = corners @ np.array([[cos, sin], [-sin, cos]]) + [x, y]
            solids.append(Solid.polygon(turned, z=z, name=name))
    return scene_of(CHAIR, World(tuple(solids)), (-4.0, 0.0, 0.0), (4.0, 0.0))


def peopled(rng: np.random.Generator, kind: str) -> Scene:
    """Return a world of four things and three people who all walk in one way, there and back.

    Args:
        rng: Source of the world.
        kind: One of `KINDS`. "constant" walk along the chair's way, "crossing" across it, both at
            constant speed; "stop-and-go" stop for 0.5 to 3 s three times on each way. Nobody
            walks through things.
    """
    if kind not in KINDS:
        raise StudyError("nobody walks so", value=kind, allowed=", ".join(KINDS))
    still = cluttered(rng, count=4)
    met = [s.shape.buffer(s.radius) for s in still.world.solids if s.z[0] < _TALL]
    things = shapely.union_all(met)
    people: list[MovingSolid] = []
    while len(people) < 3:
        person = _walker(rng, kind, f"person {len(people) + 1}")
        line = shapely.LineString(person.path[:, 1:])
        if line.distance(things) > person.radius:
            people.append(person)
    return Scene(
        still.vehicle, World(still.world.solids, moving=tuple(people)), still.start, still.goal
    )


def _walker(rng: np.random.Generator, kind: str, name: str) -> MovingSolid:
    speed = rng.uniform(0.5, 1.3)
    if kind == "crossing":
        across = rng.uniform(-2.5, 2.5)
        ends = np.array([[across, -4.5], [across + rng.uniform(-1.0, 1.0), 4.5]])
    else:
        ends = np.array([[6.0, rng.uniform(-1.5, 1.5)], [-6.5, rng.uniform(-1.5, 1.5)]])
    time = rng.uniform(0.0, 10.0)
    rows = [[0.0, *ends[0]], [time + 1e-3, *ends[0]]]
    for first, last in (ends, ends[::-1]):
        pieces = 4 if kind == "stop-and-go" else 1
        for k in range(1, pieces + 1):
            place = first + (last - first) * k / pieces
            time = rows[-1][0] + float(np.hypot(*(last - first))) / pieces / speed
            rows.append([time, *place])
            if kind == "stop-and-go" and k < pieces:
                rows.append([time + rng.uniform(0.5, 3.0), *place])
    return MovingSolid(0.25, np.array(rows), (0.0, _TALL), name)


def trap(depth: float) -> Scene:
    """Return a wall in U shape, open to the start, the goal behind it.

    Args:
        depth: How deep it is [m].
    """
    solids = (
        _box(1.0, 0.0, 0.1, 2.4, (0.0, 1.5), "bottom of the U"),
        _box(1.0 - 0.5 * depth, 1.25, depth, 0.1, (0.0, 1.5), "left side of the U"),
        _box(1.0 - 0.5 * depth, -1.25, depth, 0.1, (0.0, 1.5), "right side of the U"),
    )
    return scene_of(CHAIR, World(solids), (-3.0, 0.0, 0.0), (3.5, 0.0))


GLASS = "glass top"
"""Name of the solid that sends nothing back."""


def glass_table() -> Scene:
    """Return a table with a glass top on the way, its legs wide enough apart for the chair."""
    legs = tuple(
        Solid.circle(0.6 * i, 0.6 * j, 0.03, z=(0.0, 0.7), name="a leg")
        for i in (-1, 1)
        for j in (-1, 1)
    )
    top = _box(0.0, 0.0, 1.3, 1.3, (0.7, 0.72), GLASS)
    return scene_of(CHAIR, World((*legs, top)), (-3.0, 0.0, 0.0), (3.0, 0.0))


def velocities_of(world: World) -> Callable[[float, Array], Array]:
    """Return a function that knows how fast points (N, 3) of moving solids are at a time."""

    def velocities(time: float, points: Array) -> Array:
        found = np.zeros((len(points), 2))
        for solid in world.moving:
            now, soon = solid.position([time, time + 1e-3])
            near = np.hypot(*(points[:, :2] - now).T) < solid.radius + 0.1
            found[near] = (soon - now) / 1e-3
        return found

    return velocities
