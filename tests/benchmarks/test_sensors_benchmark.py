"""How long simulated sensors and percepts take among 20 solids; goals: a frame 10 ms, others 1."""

import math

import numpy as np
import pytest

from narrows.perception.camera import Mounting
from narrows.scene import Goal, Scene
from narrows.simulation.chair_senses import two_lasers
from narrows.simulation.depth_sensor import DepthSensor, kinect
from narrows.simulation.laser import LaserManners, LaserScanner
from narrows.simulation.senses import IdealSenses
from narrows.simulation.surfaces import SensedWorld
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

HERE = np.zeros(3)


@pytest.fixture(scope="module")
def world() -> SensedWorld:
    rng, solids = np.random.default_rng(0), []
    for number in range(20):
        x, y, turn = rng.uniform(0.8, 5.0), rng.uniform(-2.0, 2.0), rng.uniform(0.0, 6.3)
        low = float(rng.choice([0.0, 0.0, 0.6]))
        z = (low, low + rng.uniform(0.05, 1.0))
        if number % 4 == 0:
            solids.append(Solid.circle(x, y, rng.uniform(0.05, 0.4), z=z))
            continue
        c, s = math.cos(turn), math.sin(turn)
        box = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * rng.uniform(0.05, 0.25, 2)
        solids.append(Solid.polygon(box @ np.array([[c, s], [-s, c]]) + [x, y], z=z))
    return SensedWorld(World(tuple(solids)))


@pytest.fixture(scope="module")
def camera() -> DepthSensor:
    return DepthSensor(kinect(Mounting(0.8, math.radians(25.0), x=0.3)))


def test_exact_inverse_depths_of_640_by_480(benchmark, world, camera):
    assert benchmark(camera.inverse_depth, world, HERE).max() > 0.5


def test_a_frame_with_missing_returns_and_quantisation(benchmark, world, camera):
    assert benchmark(camera.measure, world, HERE).any()


def test_a_frame_with_noise_too(benchmark, world, camera):
    rng = np.random.default_rng(0)
    assert benchmark(camera.measure, world, HERE, rng=rng).any()


@pytest.mark.parametrize("beams", [541, 1081])
def test_a_scan(benchmark, world, beams):
    laser, rng = LaserScanner(manners=LaserManners(beams=beams)), np.random.default_rng(0)
    assert benchmark(laser.measure, world, HERE, rng=rng).has_answer


def test_a_percept_by_two_lasers_of_541_beams_at_12_and_a_half_hertz(benchmark, world):
    """The mean of a second of control steps, 12 or 13 of them with new scans, is a round."""
    scene = Scene(Vehicle.rectangle(1.0, 0.67, 0.25), world.world, HERE, Goal(HERE))
    senses, steps = two_lasers(scene), iter(range(10**9))

    def second() -> int:
        return sum(len(senses.perceive(0.02 * next(steps), HERE, HERE).points) for _ in range(50))

    assert benchmark(second) > 0


def test_an_ideal_percept(benchmark, world):
    senses = IdealSenses(world.world)
    assert len(benchmark(senses.perceive, 0.0, HERE, HERE).points) > 100
