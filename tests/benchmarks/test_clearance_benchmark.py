"""What certificates cost: a planned door, five metres on a map, a wall slid along, people."""

import math
from pathlib import Path as File

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from narrows.bezier_section import BezierSection
from narrows.clearance import Certificate, certify, clearance_at
from narrows.clearance_search import MotionSearch
from narrows.interfaces import Plan
from narrows.path import Path
from narrows.planners.manoeuvre import ManoeuvrePlanner
from narrows.scene import Scene, load_scene
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

SCENES = File(__file__).parents[2] / "examples" / "scenes"
CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)


def planned(name: str) -> tuple[Scene, Plan]:
    scene = load_scene(SCENES / f"{name}.yaml")
    return scene, ManoeuvrePlanner().plan(scene).raise_for_status()


@pytest.mark.parametrize("name", ["door", "flat"])
@pytest.mark.parametrize("tolerance", [1e-3, 2e-4], ids=["1 mm", "0.2 mm"])
def test_certify_a_planned_path(benchmark: BenchmarkFixture, name: str, tolerance: float) -> None:
    scene, plan = planned(name)
    assert plan.path is not None
    path = plan.path
    found = benchmark(
        lambda: certify(scene.world, scene.vehicle, Path(tuple(path.sections)), tolerance=tolerance)
    )
    assert scene.margin - tolerance <= found.clearance <= scene.margin + 1e-3


def test_certify_the_trajectory_past_a_person(benchmark: BenchmarkFixture) -> None:
    scene, plan = planned("person")
    assert plan.trajectory is not None
    assert benchmark(certify, scene.world, scene.vehicle, plan.trajectory).is_clear


def rounding(length: float) -> tuple[World, Path]:
    """A wall of short pieces along a bend of 3 m radius, 30 mm off the chair's inner side."""
    radius, inner = 3.0, 3.0 - 0.335 - 0.03
    turn = np.linspace(0.0, length / radius, round(10 * length) + 1)
    posts = tuple(
        Solid.circle(
            inner * math.sin(a) - 0.05 * math.sin(a), radius - (inner - 0.05) * math.cos(a), 0.05
        )
        for a in turn
    )
    poses = np.column_stack([radius * np.sin(turn), radius * (1 - np.cos(turn)), turn])
    return World(posts), Path.from_poses(poses)


def test_certify_fifteen_metres_thirty_millimetres_beside_posts(
    benchmark: BenchmarkFixture,
) -> None:
    world, path = rounding(15.0)
    found: Certificate = benchmark(certify, world, CHAIR, path)
    assert 0.029 <= found.clearance <= 0.0305


def test_the_pairs_looked_at_along_the_bend_grow_with_its_length(monkeypatch) -> None:
    counts = []
    examine = MotionSearch._examine

    def counted(self, *args):
        counts[-1] += len(args[-1])
        return examine(self, *args)

    monkeypatch.setattr(MotionSearch, "_examine", counted)
    for length in (4.0, 16.0):
        counts.append(0)
        certify(*(lambda world, path: (world, CHAIR, path))(*rounding(length)))
    assert counts[1] <= 5 * counts[0], counts


def test_the_clearance_of_a_thousand_poses(benchmark: BenchmarkFixture) -> None:
    scene, plan = planned("flat")
    assert plan.path is not None
    poses = plan.path(np.linspace(0.0, plan.path.span, 1000))
    distance, _ = benchmark(clearance_at, scene.world, scene.vehicle, poses)
    assert distance.min() >= scene.margin - 1e-3


def test_a_curve_far_from_everything_costs_its_first_cut_only(benchmark: BenchmarkFixture) -> None:
    line = np.linspace([0.0, 0.0], [5.0, 0.0], 4)
    world = World((Solid.circle(2.0, 30.0, 1.0),))
    found = benchmark(certify, world, CHAIR, Path((BezierSection(line[None]),)))
    assert found.clearance > 28.0
