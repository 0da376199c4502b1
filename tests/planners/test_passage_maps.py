"""Real maps: what must fail is never called passable, what must succeed never impassable.

The cases prove themselves: a straight sweep of the chair is free, or the free space of its
inscribed disc is not connected (cases.csv beside the maps). They live outside the project.
"""

import csv
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from narrows.maps import load_map
from narrows.planners.passage import PassageStatus, passable
from narrows.scene import Goal, Scene
from narrows.vehicle import Vehicle
from narrows.world import World

MAPS = Path("/work/shared/data/maps")
pytestmark = pytest.mark.skipif(not (MAPS / "cases.csv").exists(), reason="no maps here")
EXPECTED = {"must_fail": PassageStatus.IMPASSABLE, "must_succeed": PassageStatus.PASSABLE}


@cache
def world(folder: str, name: str) -> World:
    return load_map(MAPS / folder / f"{name}.json")


def cases(name: str, every: int) -> list[dict[str, str]]:
    with (MAPS / "cases.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["map"] == name]
    failing = [row for row in rows if row["expect"] == "must_fail"]
    passing = [row for row in rows if row["expect"] == "must_succeed"]
    return failing[::every] + passing[::every]


def scene(row: dict[str, str]) -> Scene:
    """Poses in the table are of the body's centre, so the axle is put there."""
    length, width = float(row["chair_length"]), float(row["chair_width"])
    ends = [
        np.array([float(row[f"{end}_{part}"]) for part in ("x", "y", "yaw")])
        for end in ("start", "goal")
    ]
    chair = Vehicle.rectangle(length, width, length / 2.0)
    goal = Goal(ends[1], 0.05, math.radians(3.0))
    return Scene(chair, world(row["folder"], row["map"]), ends[0], goal)


@pytest.mark.parametrize(
    ("name", "every"),
    [
        ("room02", 5),
        ("duplex_level1", 2),
        pytest.param("office02", 4, marks=pytest.mark.slow),
        pytest.param("duplex_level2", 1, marks=pytest.mark.slow),
        pytest.param("shopping_mall", 6, marks=pytest.mark.slow),
        pytest.param("barn_001_x0.80", 1, marks=pytest.mark.slow),
        pytest.param("willow_garage", 12, marks=pytest.mark.slow),
    ],
)
def test_self_proving_cases_are_decided_as_they_must_be(name: str, every: int) -> None:
    for row in cases(name, every):
        verdict = passable(scene(row), spare=False, time_budget=30.0)
        assert verdict.status is EXPECTED[row["expect"]], row
