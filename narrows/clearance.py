"""The certificate: a proven lower bound on the clearance of a body swept over a motion.

How the bound is found stands in `clearance_search`. Negative clearance is the depth of an overlap.
No code is shared with the planners.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .clearance_search import (
    BLOCK,
    BOUNDS_SLACK,
    STRETCH,
    MotionSearch,
    box_distance,
    inside_bounds,
)
from .errors import ShapeError
from .geometry import separation
from .moving_clearance import clearance_of_moving
from .path import Path
from .se2 import Array, transform
from .trajectory import Trajectory
from .vehicle import Vehicle
from .world import World

TOLERANCE = 1e-3
"""How far the proven clearance may stay below the attained one [m]."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """What is proven about the clearance of a motion.

    Attributes:
        clearance: Proven lower bound on the swept body's clearance [m]; negative: overlap;
            infinite where there is nothing to touch.
        attained: A clearance the motion does have, at `at` [m]: an upper bound.
        at: Progress, x and y of the body origin where `attained` was found, [m or rad, m, m].
        against: Name of the solid that is nearest there.
        inside: Proven lower bound on the distance to the world's bounds [m]; infinite if none.
        time: Time of `at` [s]; None for a motion without time.
    """

    clearance: float
    attained: float
    at: tuple[float, float, float]
    against: str
    inside: float = math.inf
    time: float | None = None

    @property
    def is_clear(self) -> bool:
        """Whether the whole motion is proven free of contact and inside the bounds."""
        return self.clearance > 0.0 and self.inside >= -BOUNDS_SLACK

    @property
    def reason(self) -> str:
        """What was found, for people."""
        _, x, y = self.at
        where = f"at ({x:.2f}, {y:.2f})"
        solid = self.against or "a solid"
        if self.attained <= 0.0:
            depth = -1e3 * self.attained
            cut = f"{depth:.0f} mm" if depth >= 0.5 else "less than 1 mm"
            return f"the body cuts {cut} into {solid} {where}"
        if self.inside < -BOUNDS_SLACK:
            return f"the body leaves the world's bounds by {-1e3 * self.inside:.0f} mm"
        if self.clearance <= 0.0:
            return f"contact with {solid} {where} could not be excluded"
        if math.isinf(self.clearance):
            return "there is nothing to touch"
        return f"clear by {1e3 * self.clearance:.1f} mm, least against {solid} {where}"


def certify(
    world: World, vehicle: Vehicle, motion: Path | Trajectory, *, tolerance: float = TOLERANCE
) -> Certificate:
    """Return a proven lower bound on the clearance of a continuous motion.

    The bound lies within `tolerance` below the true clearance, closer where needed to tell
    clearance from contact. Moving solids count where the motion has times; a path without times
    is judged against what stands still. The cost grows with the length driven near contact.

    >>> from narrows.world import Solid
    >>> wall = Solid.polygon([[3, -1], [3.1, -1], [3.1, 1], [3, 1]], name="wall")
    >>> chair = Vehicle.rectangle(1.0, 0.8, 0.2)
    >>> certificate = certify(World((wall,)), chair, Path.from_poses([[0, 0, 0], [2, 0, 0]]))
    >>> certificate.is_clear, certificate.against, round(certificate.clearance, 2)
    (True, 'wall', 0.2)

    Args:
        world: Solids, bounds, moving solids.
        vehicle: The body, each layer against the solids at its heights.
        motion: The motion of the body origin.
        tolerance: Largest gap between the proven and the attained clearance [m], positive.

    Raises:
        ShapeError: If the tolerance is not a positive number.
    """
    if not tolerance > 0.0:
        raise ShapeError(f"tolerance must be positive [m], got {tolerance}")
    path = motion.path if isinstance(motion, Trajectory) else motion
    search = MotionSearch(path, tolerance)
    for layer in vehicle.layers:
        search.against(layer.polygon, world.pieces_between(*layer.z))
    x, y = (float(v) for v in path(search.progress)[:2])
    against = world.solids[search.solid].name if search.solid >= 0 else ""
    time = None
    if isinstance(motion, Trajectory):
        time = float(motion.profile.time_at(search.progress))
    static = Certificate(
        min(search.proven, search.least),
        search.least,
        (search.progress, x, y),
        against,
        inside_bounds(path, vehicle.outline, world.bounds),
        time,
    )
    if not isinstance(motion, Trajectory) or not world.moving:
        return static
    return _with_moving(static, world, vehicle, motion, tolerance)


def _with_moving(
    static: Certificate, world: World, vehicle: Vehicle, motion: Trajectory, tolerance: float
) -> Certificate:
    """Return the certificate lowered by what moving solids do."""
    result = static
    for solid in world.moving:
        for layer in vehicle.layers:
            if not (solid.z[0] < layer.z[1] and layer.z[0] < solid.z[1]):
                continue
            proven, attained, time = clearance_of_moving(solid, layer.polygon, motion, tolerance)
            if attained < result.attained:
                x, y = (float(v) for v in motion(time)[:2])
                at = (float(motion.progress(time)), x, y)
                result = replace(
                    result, attained=attained, at=at, against=solid.name or "a person", time=time
                )
            result = replace(result, clearance=min(result.clearance, proven))
    return result


def clearance_at(world: World, vehicle: Vehicle, poses: ArrayLike) -> tuple[Array, tuple[str, ...]]:
    """Return the signed clearance of the body standing at poses, and what is nearest.

    Args:
        world: Solids that stand still; moving ones and the bounds are left out.
        vehicle: The body.
        poses: Poses, shape (N, 3), [m, m, rad].

    Returns:
        Distance, shape (N,), [m], negative: depth of the overlap, infinite: nothing there; and
        the name of the nearest solid of each pose.
    """
    rows = np.atleast_2d(np.asarray(poses, dtype=float))
    least = np.full(len(rows), np.inf)
    nearest = np.full(len(rows), -1)
    for layer in vehicle.layers:
        pieces = world.pieces_between(*layer.z)
        if not len(pieces):
            continue
        body = transform(rows, layer.polygon)
        radius = float(np.linalg.norm(layer.polygon, axis=1).max())

        def measure(row: NDArray[np.int64], piece: NDArray[np.int64]) -> None:
            distance = separation(body[row], pieces.corners[piece]).distance - pieces.radius[piece]  # noqa: B023
            order = np.argsort(-distance, kind="stable")  # the least is written last
            better = order[distance[order] < least[row[order]]]
            least[row[better]] = distance[better]
            nearest[row[better]] = pieces.owner[piece[better]]  # noqa: B023

        length = max(STRETCH, BLOCK // len(pieces))
        for begin in range(0, len(rows), length):
            every = np.arange(begin, min(begin + length, len(rows)))
            points = rows[every, :2]
            first = box_distance(points[:1], pieces.low, pieces.high).argmin()
            measure(every, np.full(len(every), first))
            limit = float(least[every].max()) + radius
            close = pieces.near(points.min(axis=0), points.max(axis=0), limit)
            if not len(close):
                continue
            bound = box_distance(points, pieces.low[close], pieces.high[close]) - radius
            measure(every, close[bound.argmin(axis=1)])
            row, piece = np.nonzero(bound < least[every, None])
            measure(every[row], close[piece])
    names = tuple(world.solids[i].name if i >= 0 else "" for i in nearest)
    return least, names
