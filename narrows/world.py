"""The world: solids extruded between two heights, moving solids, doors, bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from .errors import ShapeError
from .geometry import convex_pieces
from .se2 import Array

FLOOR_TO_CEILING = (0.0, 2.5)


def _checked_heights(z: tuple[float, float]) -> tuple[float, float]:
    low, high = (float(h) for h in z)
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise ShapeError(f"heights must be finite with low < high, got [{low}, {high}]")
    return low, high


@dataclass(frozen=True, eq=False)
class Solid:
    """A wall or a piece of furniture: an area extruded between two heights.

    The area is `shape` grown by `radius`: a polygon and 0, or a point and a cylinder's radius.

    Attributes:
        shape: A valid polygon, holes allowed, or the centre of a circle, [m].
        radius: Radius of the circle, 0 for a polygon [m].
        z: Lowest and highest point above the floor [m].
        name: Name for people.
        parts: Convex polygons (K, 2), counter-clockwise, whose union is the polygon, where the
            maker has them (a grid map's rectangles); empty: found when they are asked for.
    """

    shape: shapely.Polygon | shapely.Point
    radius: float = 0.0
    z: tuple[float, float] = FLOOR_TO_CEILING
    name: str = ""
    parts: tuple[Array, ...] = ()

    def __post_init__(self) -> None:
        """Check shape, radius and heights."""
        object.__setattr__(self, "z", _checked_heights(self.z))
        if not np.isfinite(shapely.get_coordinates(self.shape)).all():
            raise ShapeError("a solid's coordinates must be finite")
        if isinstance(self.shape, shapely.Polygon):
            if not self.shape.is_valid or self.shape.area <= 0.0:
                why = shapely.is_valid_reason(self.shape)
                raise ShapeError(f"a solid's polygon must be simple with an area: {why}")
        elif not (0.0 < self.radius < math.inf):
            raise ShapeError(f"a circle's radius must be a positive number, got {self.radius}")

    @classmethod
    def polygon(
        cls, corners: ArrayLike, *, z: tuple[float, float] = FLOOR_TO_CEILING, name: str = ""
    ) -> Solid:
        """Return an extruded polygon, convex or not, from its corners (M, 2), [m]."""
        return cls(shapely.Polygon(np.asarray(corners, dtype=float)), 0.0, z, name)

    @classmethod
    def circle(
        cls,
        x: float,
        y: float,
        radius: float,
        *,
        z: tuple[float, float] = FLOOR_TO_CEILING,
        name: str = "",
    ) -> Solid:
        """Return a cylinder from its centre and radius [m]."""
        return cls(shapely.Point(float(x), float(y)), float(radius), z, name)

    @cached_property
    def pieces(self) -> tuple[Array, ...]:
        """Convex polygons (K, 2), or one point, whose union grown by `radius` is the area."""
        if isinstance(self.shape, shapely.Point):
            return (np.array([[self.shape.x, self.shape.y]]),)
        if self.parts:
            return self.parts
        return tuple(convex_pieces(self.shape))


@dataclass(frozen=True, eq=False)
class MovingSolid:
    """A cylinder that moves along straight lines between times, such as a person.

    Attributes:
        radius: Radius [m].
        path: Rows [t, x, y], shape (K, 3), K >= 1, times increasing [s, m, m]. Before the first
            and after the last row it stands still.
        z: Lowest and highest point above the floor [m].
        name: Name for people.
    """

    radius: float
    path: Array
    z: tuple[float, float] = FLOOR_TO_CEILING
    name: str = ""

    def __post_init__(self) -> None:
        """Check the numbers; keep a read-only copy."""
        path = np.array(self.path, dtype=float)
        if path.ndim != 2 or path.shape[1] != 3 or len(path) < 1 or not np.isfinite(path).all():
            raise ShapeError(
                f"a moving solid's path must be finite rows [t, x, y], got {path.shape}"
            )
        if (np.diff(path[:, 0]) <= 0.0).any():
            raise ShapeError("the times of a moving solid's path must increase")
        if not (0.0 < self.radius < math.inf):
            raise ShapeError(f"a moving solid's radius must be positive, got {self.radius}")
        path.setflags(write=False)
        object.__setattr__(self, "path", path)
        object.__setattr__(self, "z", _checked_heights(self.z))

    def position(self, time: ArrayLike) -> Array:
        """Return the centre at times (...) [s], shape (..., 2), [m]."""
        t = np.asarray(time, dtype=float)
        return np.stack([np.interp(t, self.path[:, 0], self.path[:, k]) for k in (1, 2)], axis=-1)

    @property
    def speed(self) -> float:
        """Greatest speed along the path [m/s]."""
        if len(self.path) < 2:
            return 0.0
        step = np.diff(self.path, axis=0)
        return float((np.hypot(step[:, 1], step[:, 2]) / step[:, 0]).max())


@dataclass(frozen=True)
class Door:
    """A doorway to drive through.

    Attributes:
        center: Middle of the clear opening, in the middle of the wall's thickness [m].
        width: Clear width [m].
        heading: Direction of driving through, from the corridor into the room [rad].
    """

    center: tuple[float, float]
    width: float
    heading: float


@dataclass(frozen=True, eq=False)
class ConvexPieces:
    """Convex pieces of many solids in one block, for vectorised distances.

    Attributes:
        corners: Corners counter-clockwise, shape (P, K, 2), [m]; short ones repeat their last.
        radius: What each piece is grown by, shape (P,), [m].
        owner: Index into `World.solids` of the solid each piece belongs to, shape (P,).
        low: Lower corner of the box of each grown piece, shape (P, 2), [m].
        high: Upper corner of that box, shape (P, 2), [m].
    """

    corners: Array
    radius: Array
    owner: NDArray[np.int64]
    low: Array
    high: Array

    def __len__(self) -> int:
        """Return the number of pieces."""
        return len(self.corners)

    def near(self, low: ArrayLike, high: ArrayLike, reach: float) -> NDArray[np.int64]:
        """Return the indices of all pieces within reach of a box, and few others, shape (M,).

        A piece that is left out is further than `reach` from every point of the box; for a
        negative reach, it holds no point of the box deeper than that.

        Args:
            low: Lower corner of the box, shape (2,), [m].
            high: Upper corner of the box, shape (2,), [m].
            reach: Distance [m].
        """
        (x_min, y_min), (x_max, y_max) = np.asarray(low) - reach, np.asarray(high) + reach
        kept = (self.low[:, 0] <= x_max) & (self.high[:, 0] >= x_min)
        kept &= (self.low[:, 1] <= y_max) & (self.high[:, 1] >= y_min)
        return np.flatnonzero(kept)


@dataclass(frozen=True, eq=False)
class World:
    """What the chair must not touch.

    Attributes:
        solids: Walls and furniture that stand still.
        bounds: x_min, y_min, x_max, y_max that nothing may leave [m], or None.
        moving: People and other moving things.
        doors: Known doorways.
    """

    solids: tuple[Solid, ...] = ()
    bounds: tuple[float, float, float, float] | None = None
    moving: tuple[MovingSolid, ...] = ()
    doors: tuple[Door, ...] = ()
    _slices: dict[tuple[float, float], ConvexPieces] = field(
        default_factory=dict, init=False, repr=False
    )

    def __post_init__(self) -> None:
        """Check the bounds."""
        if self.bounds is not None:
            x_min, y_min, x_max, y_max = self.bounds
            if not (np.isfinite(self.bounds).all() and x_min < x_max and y_min < y_max):
                raise ShapeError(f"bounds must be x_min < x_max, y_min < y_max, got {self.bounds}")

    def pieces_between(self, low: float, high: float) -> ConvexPieces:
        """Return the convex pieces of the solids that a body between two heights can meet.

        Touching heights do not meet: a table top whose underside is the body's height is free.

        Args:
            low: Lowest point of the body [m].
            high: Highest point of the body [m].
        """
        if (low, high) not in self._slices:
            self._slices[low, high] = self._pack(low, high)
        return self._slices[low, high]

    def _pack(self, low: float, high: float) -> ConvexPieces:
        found = [
            (piece, solid.radius, index)
            for index, solid in enumerate(self.solids)
            if solid.z[0] < high and low < solid.z[1]
            for piece in solid.pieces
        ]
        most = max((len(piece) for piece, _, _ in found), default=1)
        corners = np.zeros((len(found), most, 2))
        for row, (piece, _, _) in enumerate(found):
            corners[row, : len(piece)] = piece
            corners[row, len(piece) :] = piece[-1]
        radius = np.array([r for _, r, _ in found], dtype=float)
        owner = np.array([i for _, _, i in found], dtype=np.int64)
        boxes = (corners.min(axis=1) - radius[:, None], corners.max(axis=1) + radius[:, None])
        return ConvexPieces(corners, radius, owner, *boxes)
