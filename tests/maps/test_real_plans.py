"""Real maps: the planner certifies every drive that is known to be possible, and no other.

The maps are third-party files outside the repository, as in `test_real_maps.py`. A few drives of
each map are planned here; NARROWS_ALL_DRIVES=1 plans all of them (a quarter of an hour).
"""

from __future__ import annotations

import csv
import functools
import os
import re
from pathlib import Path

import numpy as np
import pytest

from narrows.clearance import certify, clearance_at
from narrows.interfaces import PlanStatus
from narrows.limit_check import check_limits
from narrows.maps import load_map
from narrows.path import Path as Motion
from narrows.planners.ladder import plan
from narrows.scene import Goal, Scene
from narrows.twist_section import TwistSection
from narrows.vehicle import Vehicle

ROOT = Path(__file__).resolve().parents[2]
MAPS = Path(os.environ.get("NARROWS_DATA", ROOT.parent / "shared" / "data")) / "maps"
CASES = MAPS / "cases.csv"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not CASES.is_file(), reason=f"the real maps are not there: {CASES}; set NARROWS_DATA"
    ),
]

EVERYTHING = os.environ.get("NARROWS_ALL_DRIVES") == "1"
GRIDS = {
    "willow_garage": "01_willow_garage/raw/map.yaml",
    "gdc3ne": "06_gdc3_doors/raw/3ne.yaml",
    "pal_hospital": "09_care_hospital/raw/hospital.yaml",
}
"""Maps whose vector file is drawn from a grid: the grid says the same and loads faster."""

CERTIFICATE = 2e-4  # m: what a plan's certificate may lie below the true clearance
STEP = 2e-3  # m between the poses at which a plan is looked at again

PASSING = {
    "willow_garage": ("3", "5", "8", "17", "59"),  # 8: doors on a slant with 13 mm of room
    "office02": ("1", "22", "39"),
    "room02": ("0", "11"),
    "shopping_mall": ("13", "21"),
    "duplex_level1": ("0", "4", "5"),
    "duplex_level2": ("1", "2", "3"),
    "gdc3ne": ("28", "38"),  # 22 245 pieces, furniture
    "pal_hospital": ("12", "16"),
}
FAILING = {
    "willow_garage": ("2",),
    "room02": ("4",),
    "gdc3ne": ("29",),
}
WIDENED = {"room02": ("0", "11")}  # 0: nothing passes then; 11: still free, the width is rounded


@functools.cache
def world_of(folder, name):
    return load_map(MAPS / GRIDS.get(name, f"{folder}/{name}.json"))


def drives(expect, chosen):
    """Return the rows of `cases.csv` to try, as test parameters."""
    if not CASES.is_file():
        return []
    with CASES.open(newline="") as table:
        rows = [row for row in csv.DictReader(table) if row["expect"] == expect]
    return [
        pytest.param(row, id=f"{row['map']}-{row['door_or_task']}")
        for row in rows
        if EVERYTHING or row["door_or_task"] in chosen.get(row["map"], ())
    ]


def scene_of(row, width):
    length = float(row["chair_length"])
    start, goal = (
        np.array([float(row[f"{end}_{k}"]) for k in ("x", "y", "yaw")]) for end in ("start", "goal")
    )
    chair = Vehicle.rectangle(length, width, length / 2)  # poses are of the body's centre
    return Scene(chair, world_of(row["folder"], row["map"]), start, Goal(goal))


def check_plan(scene, found):
    """Assert what a certified plan promises, at poses 2 mm apart."""
    samples = np.arange(0.0, found.path.span + STEP, STEP).clip(max=found.path.span)
    distance, _ = clearance_at(scene.world, scene.vehicle, found.path(samples))
    assert distance.min() >= found.certificate.clearance > 0.0
    off = found.path.goal - scene.goal.pose
    assert np.hypot(*off[:2]) <= scene.goal.position_tolerance * (1.0 + 1e-6)
    assert check_limits(found.trajectory, scene.vehicle).kept
    is_short = found.certificate.clearance < scene.margin - CERTIFICATE
    assert ("margin of 20 mm asked for is not kept" in found.reason) == is_short


@pytest.mark.parametrize("row", drives("must_succeed", PASSING))
def test_a_drive_that_must_succeed_is_planned_and_certified(row):
    scene = scene_of(row, float(row["chair_width"]))
    found = plan(scene)
    assert found.status is PlanStatus.CERTIFIED, found.reason
    check_plan(scene, found)
    # Straight on is a way; what is planned gives away no room that the margin asks for.
    straight = Motion((TwistSection(np.stack([scene.start, scene.goal.pose])),))
    room = certify(scene.world, scene.vehicle, straight, tolerance=CERTIFICATE).clearance
    assert found.certificate.clearance >= min(room, scene.margin) - 2.0 * CERTIFICATE


@pytest.mark.parametrize("row", drives("must_fail", FAILING))
def test_a_drive_that_must_fail_is_not_certified(row):
    found = plan(scene_of(row, float(row["chair_width"])))
    assert found.status in (PlanStatus.IMPASSABLE, PlanStatus.NOT_FOUND), found.reason
    assert found.path is None
    if found.status is PlanStatus.IMPASSABLE and "missing_mm" in found.statistics:
        assert found.statistics["missing_mm"] > 0.0


def test_a_door_that_is_too_narrow_is_named_with_what_is_missing():
    """A door of 0.762 m between two rooms of the Duplex, a chair of 0.83 m."""
    rows = [parameter.values[0] for parameter in drives("must_fail", {"duplex_level1": ("3",)})]
    row = next(row for row in rows if (row["map"], row["door_or_task"]) == ("duplex_level1", "3"))
    found = plan(scene_of(row, float(row["chair_width"])), time_budget=300.0)
    assert found.status is PlanStatus.IMPASSABLE
    assert found.reason.endswith("it is 68 mm too large for the door at (2.51, -8.13)")


@pytest.mark.parametrize("row", drives("must_succeed", WIDENED))
def test_a_chair_wider_than_the_sweep_is_planned_another_way_or_refused(row):
    """A tenth of a metre more than the width that is free straight on."""
    stated = float(re.search(r"up to width ([\d.]+)", row["why"])[1])
    scene = scene_of(row, stated + 0.1)
    straight = Motion((TwistSection(np.stack([scene.start, scene.goal.pose])),))
    is_free = certify(scene.world, scene.vehicle, straight).is_clear
    found = plan(scene)
    if found.status is PlanStatus.CERTIFIED:
        check_plan(scene, found)
    elif found.status is PlanStatus.IMPASSABLE:
        assert not is_free  # a proof that nothing passes may not be met by something that does
