"""Rays cast one by one with shapely, and random worlds to cast them into."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from narrows.world import MovingSolid, Solid, World

FAR = 1e3


def cast(world: World, origin, direction, *, time: float = 0.0, floor: bool = True) -> float:
    """Return the parameter at which a ray meets the world first; infinite where it does not.

    Plain and slow: the ray seen from above is cut with each whole solid, concave or round, and
    what is left is cut with its heights.
    """
    ox, oy, oz = (float(value) for value in origin)
    dx, dy, dz = (float(value) for value in direction)
    best = -oz / dz if floor and dz < 0.0 else math.inf
    flat = math.hypot(dx, dy)
    line = shapely.LineString([(ox, oy), (ox + FAR * dx / flat, oy + FAR * dy / flat)])
    for solid in world.solids:
        if solid.radius:
            spans = _of_circle(solid.shape.x, solid.shape.y, solid.radius, ox, oy, dx, dy)
        else:
            spans = _of_polygon(solid.shape, line, ox, oy, flat)
        best = min([best, *_within(spans, solid.z, oz, dz)])
    for solid in world.moving:
        x, y = solid.position(time)
        spans = _of_circle(x, y, solid.radius, ox, oy, dx, dy)
        best = min([best, *_within(spans, solid.z, oz, dz)])
    return best


def _of_circle(x, y, radius, ox, oy, dx, dy):
    """Where a ray is over a circle: roots of |o + t d - c|^2 = r^2."""
    a = dx * dx + dy * dy
    b = dx * (ox - x) + dy * (oy - y)
    root = b * b - a * ((ox - x) ** 2 + (oy - y) ** 2 - radius**2)
    if root < 0.0:
        return []
    return [((-b - math.sqrt(root)) / a, (-b + math.sqrt(root)) / a)]


def _of_polygon(polygon, line, ox, oy, flat):
    cut = line.intersection(polygon)
    spans = []
    for part in getattr(cut, "geoms", [cut]):
        ends = shapely.get_coordinates(part)
        if len(ends) >= 2:
            t = np.hypot(*(ends - [ox, oy]).T) / flat
            spans.append((t.min(), t.max()))
    return spans


def _within(spans, z, oz, dz):
    """Return where each span enters the heights, if it does."""
    low, high = -math.inf, math.inf
    if dz != 0.0:
        low, high = sorted(((z[0] - oz) / dz, (z[1] - oz) / dz))
    elif not z[0] <= oz <= z[1]:
        return
    for first, last in spans:
        enter, leave = max(first, low, 0.0), min(last, high)
        if enter <= leave:
            yield enter


def clutter(rng: np.random.Generator, count: int = 8) -> World:
    """Return a world of boxes, cylinders, L-shapes, things that hang and somebody who walks."""
    solids = []
    for number in range(count):
        x, y, turn = rng.uniform(0.9, 5.0), rng.uniform(-2.5, 2.5), rng.uniform(0.0, 6.3)
        low = float(rng.choice([0.0, 0.0, 0.7]))
        z = (low, low + rng.uniform(0.02, 1.2))
        c, s = math.cos(turn), math.sin(turn)
        size = rng.uniform(0.05, 0.8)
        if number % 3 == 0:
            solids.append(Solid.circle(x, y, 0.5 * size, z=z, name=f"{number}"))
            continue
        ell = [[0, 0], [1, 0], [1, 0.4], [0.4, 0.4], [0.4, 1], [0, 1]]
        box = [[0, 0], [1, 0], [1, 0.3], [0, 0.3]]
        corners = size * np.array(ell if number % 3 == 1 else box)
        turned = corners @ np.array([[c, s], [-s, c]]) + [x, y]
        solids.append(Solid.polygon(turned, z=z, name=f"{number}"))
    somebody = MovingSolid(0.25, np.array([[0, 2.0, -1.5], [3, 2.5, 1.5]]), (0.0, 1.7), "somebody")
    return World(tuple(solids), moving=(somebody,))


def is_outside(world: World, x: float, y: float, time: float = 0.0) -> bool:
    """Return whether a place, at any height, is 5 cm clear of everything."""
    point = shapely.Point(x, y)
    still = all(s.shape.distance(point) > s.radius + 0.05 for s in world.solids)
    return still and all(
        math.hypot(*(m.position(time) - [x, y])) > m.radius + 0.05 for m in world.moving
    )


@pytest.fixture(scope="session")
def plain() -> SimpleNamespace:
    """What is above, for test files, which cannot import this one."""
    return SimpleNamespace(cast=cast, clutter=clutter, is_outside=is_outside)
