"""What the chair believes about its pose: exactly, with noise, or by its encoders alone."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..errors import ShapeError
from ..se2 import Array
from ..vehicle import Vehicle
from .noise import GaussMarkov
from .plant import Plant, PlantOptions


class Estimator(Protocol):
    """A localisation at work."""

    def estimate(self, plant: Plant, period: float) -> Array:
        """Return the believed pose now, shape (3,); `period` seconds pass until the next call."""
        ...


class Localisation(Protocol):
    """A kind of localisation."""

    def start(
        self, vehicle: Vehicle, plant: PlantOptions, pose: Array, rng: np.random.Generator
    ) -> Estimator:
        """Return an estimator for a drive from a true pose, shape (3,)."""
        ...


@dataclass(frozen=True)
class ExactPose:
    """The true pose."""

    def start(
        self, vehicle: Vehicle, plant: PlantOptions, pose: Array, rng: np.random.Generator
    ) -> Estimator:
        """Return the estimator; it draws nothing."""
        return _Exact()


class _Exact:
    def estimate(self, plant: Plant, period: float) -> Array:
        return plant.pose


@dataclass(frozen=True)
class NoisyPose:
    """The true pose with normal errors.

    Attributes:
        position: Standard deviation of x and of y [m].
        heading: Standard deviation of the heading [rad].
        memory: Time over which errors change [s]; 0 = fresh ones at every reading.
    """

    position: float = 0.02
    heading: float = math.radians(1.0)
    memory: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name, value in self.__dict__.items():
            if not (0.0 <= value < math.inf):
                raise ShapeError(f"{name} must be a finite number >= 0, got {value}")

    def start(
        self, vehicle: Vehicle, plant: PlantOptions, pose: Array, rng: np.random.Generator
    ) -> Estimator:
        """Return the estimator."""
        sigmas = (self.position, self.position, self.heading)
        return _Noisy([GaussMarkov(sigma, self.memory, rng) for sigma in sigmas])


class _Noisy:
    def __init__(self, errors: list[GaussMarkov]) -> None:
        self._errors = errors

    def estimate(self, plant: Plant, period: float) -> Array:
        errors = np.array([error.step(period) for error in self._errors])
        return np.asarray(plant.pose + errors)


@dataclass(frozen=True)
class EncoderOdometry:
    """Dead reckoning from the encoders' whole ticks, the nominal wheel radius and track."""

    def start(
        self, vehicle: Vehicle, plant: PlantOptions, pose: Array, rng: np.random.Generator
    ) -> Estimator:
        """Return the estimator; it knows the true pose at the start."""
        return _Odometry(pose, plant.tick, vehicle.track)


class _Odometry:
    def __init__(self, pose: Array, tick: float, track: float) -> None:
        self._x, self._y, self._heading = (float(value) for value in pose)
        self._tick = tick
        self._track = track
        self._counts = (0, 0)

    def estimate(self, plant: Plant, period: float) -> Array:
        counts = plant.ticks
        left, right = (
            self._tick * (now - then) for now, then in zip(counts, self._counts, strict=True)
        )
        self._counts = counts
        travel, angle = 0.5 * (left + right), (right - left) / self._track
        half = 0.5 * angle
        chord = travel * (math.sin(half) / half if half else 1.0)
        self._x += chord * math.cos(self._heading + half)
        self._y += chord * math.sin(self._heading + half)
        self._heading += angle
        return np.array([self._x, self._y, self._heading])
