"""Where a chair is in a known map, from laser scans and odometry: a particle filter.

[DrivingAssistant, Section V-B] localised its runs by GMapping with the map left untouched: "a
small number of particles keeps track". Monte Carlo localisation with the likelihood field of the
map (Thrun, Burgard, Fox, Probabilistic Robotics, 2005, Chapters 8 and 6): a particle weighs the
more, the nearer the scan's points lie to walls when seen from it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..se2 import Array, compose, invert
from .grid_mapping import GridMap


@dataclass(frozen=True)
class FilterOptions:
    """How a particle filter tracks.

    Attributes:
        particles: Number of them.
        beams: Points of a scan that are weighed, evenly spread.
        noise: Distance of a point to its wall that is not unusual [m].
        stray: Share of points that may be anything: people, things moved since.
        along: Error of odometry, as a share of the distance.
        turning: Error of the heading, as a share of the angle turned.
        veering: Error of the heading per distance [rad/m].
        jitter: Error of place [m] and heading [rad] that is always there.
        independent: Points that count as independent: neighbours err alike.
        resample: Share of effective particles below which they are drawn anew.
    """

    particles: int = 150
    beams: int = 60
    noise: float = 0.03
    stray: float = 0.1
    along: float = 0.05
    turning: float = 0.05
    veering: float = 0.03
    jitter: tuple[float, float] = (0.003, 0.003)
    independent: float = 10.0
    resample: float = 0.5

    def __post_init__(self) -> None:
        """Check the numbers."""
        if self.particles < 2 or self.beams < 1:
            raise ShapeError("a filter needs at least 2 particles and 1 beam")
        if not (self.noise > 0.0 and 0.0 < self.stray < 1.0 and 0.0 < self.resample <= 1.0):
            raise ShapeError("noise must be positive, stray and resample shares of one")


class ParticleFilter:
    """Tracks a chair in a map.

    Attributes:
        particles: Poses, shape (P, 3), [m, m, rad].
        weights: Their weights, shape (P,), of sum 1.
    """

    def __init__(
        self,
        grid: GridMap,
        pose: ArrayLike,
        rng: np.random.Generator,
        options: FilterOptions | None = None,
        *,
        spread: tuple[float, float] = (0.05, 0.05),
    ) -> None:
        """Put the particles about a pose.

        Args:
            grid: The map; it is not changed.
            pose: Where the chair is, more or less, shape (3,), [m, m, rad].
            rng: Source of the particles.
            options: Default `FilterOptions()`.
            spread: Standard deviations of that, of place [m] and heading [rad].
        """
        self._grid, self._rng = grid, rng
        self._options = FilterOptions() if options is None else options
        count = self._options.particles
        scale = np.array([spread[0], spread[0], spread[1]])
        self.particles = np.asarray(pose, dtype=float) + scale * rng.standard_normal((count, 3))
        self.weights = np.full(count, 1.0 / count)
        self._before: Array | None = None

    @property
    def pose(self) -> Array:
        """Mean of the particles, shape (3,), [m, m, rad]; the heading within (-pi, pi]."""
        x, y = self.weights @ self.particles[:, :2]
        heading = self.particles[:, 2]
        mean = math.atan2(self.weights @ np.sin(heading), self.weights @ np.cos(heading))
        return np.array([x, y, mean])

    @property
    def spread(self) -> float:
        """Standard deviation of the particles' places [m]."""
        gap = self.particles[:, :2] - self.pose[:2]
        return math.sqrt(float(self.weights @ np.sum(gap**2, axis=1)))

    def step(self, odometry: ArrayLike, points: Array) -> Array:
        """Return where the chair is after a scan, shape (3,), [m, m, rad].

        Args:
            odometry: Pose by the wheels alone, in a frame of its own, shape (3,), [m, m, rad].
            points: The scan in the body frame, shape (M, 2), [m]; none: odometry alone.
        """
        now = np.asarray(odometry, dtype=float)
        if self._before is not None:
            self._move(compose(invert(self._before), now))
        self._before = now
        if len(points):
            self._weigh(points)
            if 1.0 / np.sum(self.weights**2) < self._options.resample * len(self.weights):
                self._draw_anew()
        return self.pose

    def _move(self, step: Array) -> None:
        """Move each particle by the odometry's step, each with an error of its own."""
        options = self._options
        far = math.hypot(step[0], step[1])
        turned = abs(math.remainder(float(step[2]), 2.0 * math.pi))
        place = options.jitter[0] + options.along * far
        heading = options.jitter[1] + options.turning * turned + options.veering * far
        errors = self._rng.standard_normal(self.particles.shape) * [place, 0.5 * place, heading]
        self.particles = compose(self.particles, step + errors)

    def _weigh(self, points: Array) -> None:
        """Weigh the particles by how near the scan's points come to walls."""
        options = self._options
        chosen = points[
            np.linspace(0, len(points) - 1, min(options.beams, len(points))).astype(int)
        ]
        c, s = np.cos(self.particles[:, 2, None]), np.sin(self.particles[:, 2, None])
        x = self.particles[:, 0, None] + c * chosen[:, 0] - s * chosen[:, 1]  # (P, M)
        y = self.particles[:, 1, None] + s * chosen[:, 0] + c * chosen[:, 1]
        distance = self._grid.distance(np.stack([x, y], axis=-1))
        likely = options.stray + (1.0 - options.stray) * np.exp(
            -0.5 * (distance / options.noise) ** 2
        )
        counted = min(1.0, options.independent / len(chosen))
        logs = np.log(self.weights) + counted * np.log(likely).sum(axis=1)
        weights = np.exp(logs - logs.max()) + 1e-300
        self.weights = weights / weights.sum()

    def _draw_anew(self) -> None:
        """Draw as many particles by their weights, at even steps from one random start."""
        count = len(self.weights)
        marks = (self._rng.random() + np.arange(count)) / count
        chosen = np.minimum(np.searchsorted(np.cumsum(self.weights), marks), count - 1)
        self.particles = self.particles[chosen]
        self.weights = np.full(count, 1.0 / count)
