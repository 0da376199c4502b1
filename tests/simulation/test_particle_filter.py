"""The particle filter tracks where odometry alone is lost."""

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from narrows.errors import ShapeError
from narrows.se2 import compose, invert, transform
from narrows.simulation.grid_mapping import GridMap
from narrows.simulation.particle_filter import FilterOptions, ParticleFilter

EDGE = shapely.box(0.1, 0.1, 3.9, 2.9).exterior
CELL = 0.02


def room():
    x, y = np.meshgrid((np.arange(200) + 0.5) * CELL, (np.arange(150) + 0.5) * CELL)
    middles = shapely.points(np.column_stack([x.T.ravel(), y.T.ravel()]))
    return GridMap(
        (shapely.distance(middles, EDGE) <= 0.5 * CELL).reshape(200, 150), np.zeros(2), CELL
    )


WALLS = shapely.get_coordinates(shapely.segmentize(EDGE, 0.05))


def seen_from(pose, rng):
    """Return the walls in the body frame, with noise."""
    return transform(invert(pose), WALLS) + 0.01 * rng.standard_normal(WALLS.shape)


def circle(count):
    """Return poses of a round through the room."""
    angle = np.linspace(0.0, 2.0 * math.pi, count)
    return np.column_stack([2.0 + np.sin(angle), 1.5 - 0.7 * np.cos(angle), angle])


def track(options=None, *, seed=0, scans=True):
    rng, truth = np.random.default_rng(seed), circle(80)
    tracker = ParticleFilter(room(), truth[0], np.random.default_rng(seed + 1), options)
    wheels, errors = np.zeros(3), []
    tracker.step(wheels, seen_from(truth[0], rng) if scans else WALLS[:0])
    for before, now in pairwise(truth):
        wheels = compose(wheels, compose(invert(before), now) * [1.04, 1.0, 1.03])
        pose = tracker.step(wheels, seen_from(now, rng) if scans else WALLS[:0])
        errors.append(np.hypot(*(pose - now)[:2]))
    drift = np.hypot(*(compose(truth[0], wheels) - truth[-1])[:2])
    return np.array(errors), drift, tracker


def test_the_filter_tracks_where_odometry_is_lost():
    errors, drift, _ = track()
    assert drift > 0.1
    assert errors.max() < 0.05
    assert errors.mean() < 0.02  # the cell of the map


def test_without_scans_it_is_odometry_with_growing_doubt():
    errors, drift, blind = track(scans=False)
    assert errors[-1] == pytest.approx(drift, abs=0.1)
    assert blind.spread > 2.0 * track()[2].spread


def test_few_particles_do():
    assert track(FilterOptions(particles=40))[0].max() < 0.08


def test_weights_sum_to_one_and_the_same_seed_is_the_same_track():
    first, second = track(seed=3), track(seed=3)
    assert first[2].weights.sum() == pytest.approx(1.0)
    assert (first[0] == second[0]).all()


def test_the_mean_heading_knows_that_pi_is_minus_pi():
    one = ParticleFilter(room(), [1.0, 1.0, math.pi], np.random.default_rng(0), spread=(0.0, 0.05))
    assert abs(abs(one.pose[2]) - math.pi) < 0.02


def test_options_are_checked():
    with pytest.raises(ShapeError, match="at least 2 particles"):
        FilterOptions(particles=1)
    with pytest.raises(ShapeError, match="stray"):
        FilterOptions(stray=0.0)
