"""The Deformable Virtual Zone of [FuzzyDVZ] in 3-D, its derivatives in closed form.

Rays leave the chair at azimuths theta (from its heading) and latitudes phi, heights squashed as
`ZoneShape` says. c is the range of what stands on a ray; a ray is intruded where c < d_h. Summed
over intruded rays only, with dtheta dphi (not the solid angle, as in the paper):

    I       = sum (d_h / c - 1)                                   [FuzzyDVZ, Eq. (14)]
    J_V     = dI/dV     = j V,  j = (2 lambda / c_x) sum d_h / c  [Eqs. (17)-(20)], with J_BV right
    J_alpha = dI/dalpha = (6 / (5 c_x)) sum (d_h^2 / c) sin theta cos phi
    F_rob V = dI/dt while the chair drives straight at V and all else stands
    F_obs   = dI/dt while the chair stands and what is seen moves

F is exact, not the paper's fixed-ray integral: a surface also slides across the rays. With
a = -(w . e), b = w . (e turned left) for a surface's velocity w in the body frame (the chair's own
driving: w = (-1, 0)) and e = (cos theta, sin theta), the surface's rays turn at b / (c cos phi)
and rise at a sin phi / c; integrated by parts,

    F = sum c^-2 [d_h a cos phi + (d/dtheta (d_h b) / cos phi + d/dphi (d_h a sin phi)) / 2]
        + [b / cos phi (d_h / (2 c^2) - 1/c)] + [a sin phi (d_h / (2 c^2) - 1/c)],

the brackets between the ends of every intruded interval in theta and in phi. An edge of one
surface before another, which moves with the nearer one, adds
d_h / (2 cos phi) (b / c^2 - 2 b / (c c') + b' / c'^2), primed behind it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ShapeError
from ..se2 import Array
from .zone_shape import ZoneShape


@dataclass(frozen=True)
class RayGrid:
    """The directions in which the zone is looked at.

    Attributes:
        columns: Azimuths all round.
        rows: Latitudes; 1: a flat zone, points of all heights in one row.
        latitude: Greatest latitude, up and down [rad]; what is steeper counts in the last row.
        least: Ranges are not taken shorter than this [m], so that I stays finite.
        jump: Neighbours of which one is further away by this share are two surfaces.
    """

    columns: int = 120
    rows: int = 9
    latitude: float = math.radians(45.0)
    least: float = 0.05
    jump: float = 0.5

    def __post_init__(self) -> None:
        """Check the numbers."""
        if self.columns < 8 or self.rows < 1:
            raise ShapeError(f"a grid needs 8 columns and a row, got {self.columns}, {self.rows}")
        if not 0.0 < self.latitude < 0.5 * math.pi or not self.least > 0.0 or not self.jump > 0.0:
            raise ShapeError("latitude must lie below a right angle, least and jump above 0")

    @property
    def edges(self) -> Array:
        """Edges of the rows, shape (rows + 1,), [rad]."""
        return np.asarray(np.linspace(-self.latitude, self.latitude, self.rows + 1))

    @property
    def latitudes(self) -> Array:
        """Middles of the rows, shape (rows,), [rad]; 0 for a flat zone."""
        edges = self.edges
        return np.asarray(0.5 * (edges[1:] + edges[:-1]))

    @property
    def azimuths(self) -> Array:
        """Middles of the columns, shape (columns,), from -pi to pi, [rad]."""
        step = 2.0 * math.pi / self.columns
        return np.asarray(-math.pi + step * (np.arange(self.columns) + 0.5))

    @property
    def steps(self) -> tuple[float, float]:
        """Width of a column and height of a row [rad]; a flat zone's row is 1 high."""
        height = 2.0 * self.latitude / self.rows if self.rows > 1 else 1.0
        return 2.0 * math.pi / self.columns, height


@dataclass(frozen=True)
class Deformation:
    """How far the zone is intruded, and how that changes.

    Attributes:
        intrusion: I, 0: not at all.
        by_speed: j, dI/dV = j V [s^2/m^2].
        by_heading: J_alpha, dI/dalpha [1/rad]; positive: turning left makes it worse.
        by_driving: F_rob, dI/dt per m/s of the chair's own speed [1/m].
        by_others: F_obs, dI/dt by what is known to move [1/s].
        rays: Number of intruded rays.
    """

    intrusion: float = 0.0
    by_speed: float = 0.0
    by_heading: float = 0.0
    by_driving: float = 0.0
    by_others: float = 0.0
    rays: int = 0


class DeformableZone:
    """The zone about a chair, deformed by points.

    Attributes:
        shape: The undeformed zone.
        grid: Its rays.
        upright: Whether the nearest point of an azimuth stands for an obstacle of the zone's
            whole height, as where a laser sees one height of it. Otherwise rays at other heights
            are free unless a point is on them.
    """

    def __init__(
        self, shape: ZoneShape, grid: RayGrid | None = None, *, upright: bool = True
    ) -> None:
        """Make a zone."""
        self.shape = shape
        self.grid = RayGrid() if grid is None else grid
        self.upright = upright
        top = shape.heights[1] - shape.center_height
        self._top = shape.squash * max(top, shape.center_height - shape.heights[0])
        self._edges, self._latitudes = self.grid.edges, self.grid.latitudes
        if self.grid.rows == 1:
            self._edges = np.array([-math.pi, math.pi])

    def ranges(self, points: ArrayLike, speed: float, *, spread: float = 0.0) -> Array:
        """Return c on every ray, shape (rows, columns), infinite where no point is, [m].

        Args:
            points: Points of obstacles in the body frame, z above the floor, shape (N, 3), [m].
            speed: The chair's [m/s]; points outside the zone are left out.
            spread: An obstacle may reach this far beyond a point, seen from above [m].
        """
        return self._nearest(points, speed, spread)[0]

    def measure(
        self,
        points: ArrayLike,
        speed: float,
        *,
        spread: float = 0.0,
        velocities: ArrayLike | None = None,
    ) -> Deformation:
        """Return the deformation by points.

        Args:
            points: Points of obstacles in the body frame, z above the floor, shape (N, 3), [m].
            speed: The chair's [m/s].
            spread: An obstacle may reach this far beyond a point, seen from above [m].
            velocities: Velocities of the points over the floor, in the body frame's directions,
                shape (N, 2), [m/s]; None: all stand.
        """
        found, index = self._nearest(points, speed, spread)
        drift = np.zeros((*found.shape, 2))
        if velocities is not None:
            rows = np.asarray(velocities, dtype=float).reshape(-1, 2)
            if len(rows) != len(np.asarray(points).reshape(-1, 3)):
                raise ShapeError("velocities must have a row for each point")
            drift[index >= 0] = rows[index[index >= 0]]
        return self.deform(found, speed, drift)

    def deform(self, ranges: Array, speed: float, drift: Array | None = None) -> Deformation:
        """Return the deformation by ranges.

        Args:
            ranges: c, shape (rows, columns), infinite where nothing is, [m].
            speed: The chair's [m/s].
            drift: Velocity of what each ray sees over the floor, body frame, shape
                (rows, columns, 2), [m/s]; None: all stands.
        """
        from .zone_kernels import measure_rays

        expected = (self.grid.rows, self.grid.columns)
        if ranges.shape != expected:
            raise ShapeError(f"ranges must have shape {expected}, got {ranges.shape}")
        drift = np.zeros((*expected, 2)) if drift is None else drift
        c_x = self.shape.c_x(speed)
        intrusion, swelling, turning, own, others, count = measure_rays(
            ranges, drift, self._latitudes, self.grid.steps, c_x, self.grid.jump
        )
        by_speed = 2.0 * self.shape.growth / c_x * swelling
        return Deformation(intrusion, by_speed, turning, own, others, count)

    def _nearest(
        self, points: ArrayLike, speed: float, spread: float
    ) -> tuple[Array, NDArray[np.int64]]:
        from .zone_kernels import nearest_points, stand_upright

        rows = np.ascontiguousarray(np.asarray(points, dtype=float).reshape(-1, 3))
        shape = self.shape
        zone = (shape.c_x(speed), shape.center_height, shape.squash, *shape.heights)
        found = nearest_points(
            rows, float(spread), zone, self.grid.least, self._edges, self.grid.columns
        )
        if self.upright and self.grid.rows > 1 and math.isfinite(self._top):
            return stand_upright(*found, self._latitudes, self._top)
        return found
