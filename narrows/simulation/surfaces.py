"""The world as sensors meet it: convex prisms and cylinders, those that move where they are now."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, ShapeError
from ..se2 import Array
from ..world import World


@dataclass(frozen=True, eq=False)
class Surfaces:
    """What can send something back to a sensor at a moment, in the world frame.

    Attributes:
        corners: Corners of convex prisms seen from above, counter-clockwise, shape (P, K, 2), [m];
            the rows beyond a prism's own are zero.
        counts: Number of corners of each, shape (P,).
        heights: Lowest and highest point of each, shape (P, 2), [m].
        rounds: Centre, radius, lowest and highest point of upright cylinders, shape (C, 5), [m].
    """

    corners: Array
    counts: NDArray[np.int64]
    heights: Array
    rounds: Array


class SensedWorld:
    """A world as sensors meet it; made once, asked at many times.

    Attributes:
        world: The world itself.
    """

    def __init__(self, world: World, *, invisible: Collection[str] = ()) -> None:
        """Take a world apart into convex pieces.

        Args:
            world: Solids, concave ones too, and moving solids.
            invisible: Names of solids and moving solids that send nothing back, such as glass:
                sensors look through them.

        Raises:
            InputError: If nothing in the world has one of these names.
        """
        self.world = world
        names = {s.name for s in world.solids} | {m.name for m in world.moving}
        for name in invisible:
            if name not in names:
                allowed = ", ".join(sorted(names - {""})) or "nothing: no solid has a name"
                raise InputError("no solid of that name", value=name, allowed=allowed)
        seen = [solid for solid in world.solids if solid.name not in invisible]
        prisms = [(piece, solid.z) for solid in seen if not solid.radius for piece in solid.pieces]
        most = max((len(piece) for piece, _ in prisms), default=3)
        self._corners = np.zeros((len(prisms), most, 2))
        for row, (piece, _) in enumerate(prisms):
            self._corners[row, : len(piece)] = piece
        self._counts = np.array([len(piece) for piece, _ in prisms], dtype=np.int64)
        self._heights = np.array([z for _, z in prisms], dtype=float).reshape(-1, 2)
        standing = [(*piece[0], s.radius, *s.z) for s in seen if s.radius for piece in s.pieces]
        self._moving = tuple(solid for solid in world.moving if solid.name not in invisible)
        moving = [(0.0, 0.0, solid.radius, *solid.z) for solid in self._moving]
        self._rounds = np.array(standing + moving, dtype=float).reshape(-1, 5)
        self._standing = len(standing)
        self._still = Surfaces(self._corners, self._counts, self._heights, self._rounds)

    def at(self, time: float) -> Surfaces:
        """Return what stands where at a time [s].

        Raises:
            ShapeError: If the time is not a finite number.
        """
        if not np.isfinite(time):
            raise ShapeError(f"a time must be a finite number [s], got {time}")
        if not self._moving:
            return self._still
        rounds = self._rounds.copy()
        for row, solid in enumerate(self._moving, start=self._standing):
            rounds[row, :2] = solid.position(time)
        return Surfaces(self._corners, self._counts, self._heights, rounds)


Answer = TypeVar("Answer", covariant=True)


class Sensor(Protocol[Answer]):
    """Anything on a chair that measures the world around it."""

    def measure(
        self,
        world: SensedWorld,
        pose: ArrayLike,
        time: float = 0.0,
        *,
        rng: np.random.Generator | None = None,
    ) -> Answer:
        """Return what it delivers.

        Args:
            world: What there is.
            pose: True pose of the chair, shape (3,), [m, m, rad].
            time: When [s]: moving solids are where they are then, for all of the measurement.
            rng: Source of noise and dropouts; None: neither.

        Raises:
            ShapeError: If the pose or the time is not finite.
        """
        ...


def checked_pose(pose: ArrayLike) -> Array:
    """Return a pose [x, y, heading], shape (3,).

    Raises:
        ShapeError: If it is not three finite numbers.
    """
    row = np.asarray(pose, dtype=float)
    if row.shape != (3,) or not np.isfinite(row).all():
        raise ShapeError(f"a pose must be three finite numbers [x, y, heading], got {row.tolist()}")
    return row
