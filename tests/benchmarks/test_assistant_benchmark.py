"""How long a step of the assistant takes, and its safety regions."""

import numpy as np
import pytest

import narrows
from narrows.interfaces import Percept
from narrows.reactive.assistant import Assistant
from narrows.reactive.safety_regions import RegionOptions, SafetyRegions


@pytest.fixture(scope="module")
def chair():
    return narrows.load_vehicle("xeno")


@pytest.fixture(scope="module")
def regions(chair):
    return SafetyRegions.compute(chair, RegionOptions(directions=240))


def wall(x, half_gap, count):
    """Return points of a wall across the way with a gap in it, shape (count, 3)."""
    y = np.linspace(half_gap, half_gap + 2.0, count // 2)
    across = np.concatenate([-y, y])
    return np.column_stack([np.full(len(across), x), across, np.full(len(across), 0.1)])


SURROUNDINGS = {
    "nothing near": wall(30.0, 0.0, 1000),
    "a wall ahead": wall(1.2, 0.0, 1000),
    "in a doorway": np.concatenate([wall(0.3, 0.4, 1000), wall(0.4, 0.4, 1000)]),
}


@pytest.mark.parametrize("name", SURROUNDINGS)
@pytest.mark.parametrize("command", [(0.5, 0.0), (0.4, 0.15)])
def test_a_step(benchmark, chair, regions, name, command):
    assistant = Assistant(chair, regions)
    time = [0.0]

    def step():
        time[0] += 0.02
        return assistant.step(
            time[0], command, [0.1, 0.0], Percept(time[0], SURROUNDINGS[name], 0.02)
        )

    assert np.isfinite(benchmark(step)).all()


def test_regions_of_a_chair(benchmark, chair):
    options = RegionOptions(directions=48)
    SafetyRegions.compute(chair, RegionOptions(directions=8))
    regions = benchmark.pedantic(SafetyRegions.compute, (chair, options), rounds=2)
    assert len(regions.levels) == 48
