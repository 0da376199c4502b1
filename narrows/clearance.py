"""The certificate: a proven lower bound on the clearance of a body swept over a motion.

The motion is cut into intervals. On an interval the positions lie in the convex hull of known
points P_j and the heading in a known range (`narrows.section.Enclosure`), so along any unit axis n
the gap between a body with corners v_i and a convex solid of support h is at least

    h - max_j n.P_j - max_i max_theta |v_i| cos(theta + angle(v_i) - angle(n)),

whichever n is taken. The axis that separates body and solid at the interval's middle makes the
bound exact as the interval shrinks; the distance there bounds the clearance from above. Where the
bound comes within the tolerance of the least distance seen the interval is done; else it is cut.
Negative clearance is the depth of an overlap. No code is shared with the planners.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ShapeError
from .geometry import separation
from .motion_intervals import Intervals, support_bound
from .moving_clearance import clearance_of_moving
from .path import Path
from .se2 import Array, transform
from .section import Enclosure
from .trajectory import Trajectory
from .vehicle import Vehicle
from .world import ConvexPieces, World

TOLERANCE = 1e-3
"""How far the proven clearance may stay below the attained one [m]."""

_FINEST = 1e-5  # m: contact and clearance below this are not told apart
_BOUNDS_SLACK = 1e-4  # m: the bounds are a box drawn by a person, not a wall
_PARTS = 4  # parts an undecided interval is cut into
_BLOCK = 50_000  # pairs of interval and piece looked at together: a few MB
_STRETCH = 16  # but at least so many intervals, 0.8 m: each stretch costs a look at all pieces
_ROUNDS = 14  # 0.05 m / 4^14 is below rounding


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
        return self.clearance > 0.0 and self.inside >= -_BOUNDS_SLACK

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
        if self.inside < -_BOUNDS_SLACK:
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
    search = _Search(path, tolerance)
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
        _inside_bounds(path, vehicle.outline, world.bounds),
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


class _Search:
    """Branch and bound over intervals of a path and convex pieces of solids."""

    def __init__(self, path: Path, tolerance: float) -> None:
        self.path = path
        self.tolerance = tolerance
        self.least = math.inf  # least distance seen
        self.proven = math.inf  # least bound of all pairs that are done
        self.progress = 0.0  # where `least` was seen
        self.solid = -1  # and against which solid

    def allowed(self) -> float:
        """Return how far below `least` a bound may stay: less where contact must be excluded."""
        if self.least <= 0.0:
            return self.tolerance
        return max(min(self.tolerance, 0.5 * self.least), _FINEST)

    def against(self, body: Array, pieces: ConvexPieces) -> None:
        """Lower `least` and `proven` by what one convex body meets along the path."""
        if not len(pieces):
            return
        intervals = Intervals.of(self.path)
        enclosure = intervals.enclose(self.path.sections)
        row, piece = self._near(body, pieces, intervals, enclosure)
        for _ in range(_ROUNDS):
            lower = self._examine(body, pieces, intervals, enclosure, row, piece)
            undecided = lower < self.least - self.allowed()
            self.proven = min(self.proven, float(lower[~undecided].min(initial=math.inf)))
            if not undecided.any():
                return
            kept, index = np.unique(row[undecided], return_inverse=True)
            intervals = intervals.cut(kept, _PARTS)
            enclosure = intervals.enclose(self.path.sections)
            row = (index[:, None] * _PARTS + np.arange(_PARTS)).ravel()
            piece = np.repeat(piece[undecided], _PARTS)
        self.proven = min(self.proven, float(lower[undecided].min()))

    def _near(
        self, body: Array, pieces: ConvexPieces, intervals: Intervals, enclosure: Enclosure
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the pairs of interval and piece that their boxes do not rule out.

        Stretch by stretch: what is further from the whole stretch than the least distance seen so
        far is left out at once, which is most of a large map.
        """
        reach = np.linalg.norm(enclosure.hull - enclosure.middle[:, None, :2], axis=2).max(axis=1)
        reach += float(np.linalg.norm(body, axis=1).max())
        none = np.zeros(0, dtype=np.int64)
        found = [(none, none, np.zeros(0))]
        length = max(_STRETCH, _BLOCK // len(pieces))
        for begin in range(0, len(reach), length):
            every = np.arange(begin, min(begin + length, len(reach)))
            middle = enclosure.middle[every, :2]
            limit = self.least + float(reach[every].max())
            close = pieces.near(middle.min(axis=0), middle.max(axis=0), limit)
            if not len(close):
                continue
            box = _box_distance(middle, pieces.low[close], pieces.high[close])
            bound = box - reach[every, None]
            self._examine(body, pieces, intervals, enclosure, every, close[bound.argmin(axis=1)])
            row, piece = np.nonzero(bound < self.least)
            found.append((every[row], close[piece], bound[row, piece]))
        row, piece, bound = (np.concatenate(part) for part in zip(*found, strict=True))
        near = bound < self.least
        return row[near], piece[near]

    def _examine(
        self,
        body: Array,
        pieces: ConvexPieces,
        intervals: Intervals,
        enclosure: Enclosure,
        row: NDArray[np.int64],
        piece: NDArray[np.int64],
    ) -> Array:
        """Return a lower bound for each pair; keep the least distance seen at the middles."""
        solid = pieces.corners[piece]
        distance, axis = separation(transform(enclosure.middle, body)[row], solid)
        distance = distance - pieces.radius[piece]
        if len(distance) and distance.min() < self.least:
            best = int(distance.argmin())
            self.least = float(distance[best])
            self.solid = int(pieces.owner[piece[best]])
            k = int(row[best])
            section = int(intervals.section[k])
            middle = np.array([0.5 * (intervals.low[k] + intervals.high[k])])
            within = self.path.sections[section].progress_at(intervals.piece[k : k + 1], middle)
            self.progress = float(self.path.section_bounds[section] + within[0])
        support = np.einsum("nkd,nd->nk", solid, axis).min(axis=1) - pieces.radius[piece]
        return np.asarray(support - support_bound(body, enclosure, row, axis))


def _box_distance(points: Array, low: Array, high: Array) -> Array:
    """Return the distance from points (N, 2) to boxes (P, 2), shape (N, P), [m].

    Inside a box it is minus the way to its nearest side: a body deep in a solid can be deeper
    than its own radius.
    """
    offset = np.maximum(low - points[:, None], points[:, None] - high)
    outside = np.maximum(offset, 0.0)
    inside = np.minimum(offset.max(axis=2), 0.0)
    return np.asarray(np.hypot(outside[..., 0], outside[..., 1]) + inside)


def _inside_bounds(
    path: Path, body: Array, bounds: tuple[float, float, float, float] | None
) -> float:
    """Return a lower bound on the distance of the swept body to the bounds [m].

    Intervals are cut until they are proven inside (to a tenth of a millimetre) or seen outside.
    """
    if bounds is None:
        return math.inf
    normals = np.array([[-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    offsets = np.array([-bounds[0], -bounds[1], bounds[2], bounds[3]])
    intervals = Intervals.of(path)
    proven = math.inf
    for _ in range(_ROUNDS):
        enclosure = intervals.enclose(path.sections)
        rows = np.repeat(np.arange(len(intervals.low)), 4)
        axis = np.tile(normals, (len(intervals.low), 1))
        reach = support_bound(body, enclosure, rows, axis).reshape(-1, 4)
        lower = (offsets - reach).min(axis=1)
        corners = transform(enclosure.middle, body)  # (N, K, 2)
        seen = (offsets - (corners @ normals.T).max(axis=1)).min()
        undecided = (lower < -_BOUNDS_SLACK) & (seen >= -_BOUNDS_SLACK)
        proven = min(proven, float(lower[~undecided].min(initial=math.inf)))
        if not undecided.any():
            return min(proven, float(seen)) if seen < -_BOUNDS_SLACK else proven
        intervals = intervals.cut(np.flatnonzero(undecided), _PARTS)
    return min(proven, float(lower[undecided].min()))


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

        length = max(_STRETCH, _BLOCK // len(pieces))
        for begin in range(0, len(rows), length):
            every = np.arange(begin, min(begin + length, len(rows)))
            points = rows[every, :2]
            first = _box_distance(points[:1], pieces.low, pieces.high).argmin()
            measure(every, np.full(len(every), first))
            limit = float(least[every].max()) + radius
            close = pieces.near(points.min(axis=0), points.max(axis=0), limit)
            if not len(close):
                continue
            bound = _box_distance(points, pieces.low[close], pieces.high[close]) - radius
            measure(every, close[bound.argmin(axis=1)])
            row, piece = np.nonzero(bound < least[every, None])
            measure(every[row], close[piece])
    names = tuple(world.solids[i].name if i >= 0 else "" for i in nearest)
    return least, names
