"""The search on DoorBench, judged by its independent referee."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from narrows.clearance import certify
from narrows.planners.search import SearchPlanner
from narrows.studies.doorbench_scenes import doorbench_scene

FOLDER = Path(__file__).parents[3] / "shared" / "doorbench"
SHUT_IN = {"c30_11", "c23_01", "c10_07"}
"""Goals with an obstacle close behind: no forward way ends there, by exhaustion at 12.5 mm."""

pytestmark = pytest.mark.skipif(
    not (FOLDER / "checker.py").exists(), reason="the DoorBench folder is not on this machine"
)


@pytest.fixture(scope="module")
def referee():
    spec = importlib.util.spec_from_file_location("doorbench_checker", FOLDER / "checker.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def rows():
    return json.loads((FOLDER / "scenes.json").read_text())["scenes"]


def sampled(path):
    """Return poses at most 4 mm apart, with those where the curvature changes."""
    progress = [np.linspace(0.0, path.span, int(path.span / 0.004) + 2)]
    for begin, section in zip(path.section_bounds, path.sections, strict=False):
        pieces = np.arange(section.pieces)
        progress.append(begin + section.progress_at(pieces, np.ones(len(pieces))))
    s = np.unique(np.concatenate(progress))
    return path(s[np.r_[True, np.diff(s) > 1e-6]])


def judge(referee, row, *, reversing):
    """Return whether a manoeuvre was found, after the referee and the certificate agreed on it."""
    scene = doorbench_scene(row, reversing=reversing)
    manoeuvre = SearchPlanner().search(scene).manoeuvre
    if manoeuvre is None:
        return False
    path = manoeuvre.path
    verdict = referee.check(row, sampled(path), allow_reverse=reversing)
    assert verdict["valid"], verdict["reasons"]
    assert verdict["cusps"] == path.direction_changes
    certificate = certify(scene.world, scene.vehicle, path, tolerance=1e-4)
    assert certificate.is_clear
    # The referee looks every 2 mm: it may miss less than a millimetre of the approach.
    assert certificate.clearance == pytest.approx(verdict["min_clear"], abs=1e-3)
    return True


@pytest.mark.parametrize("name", ["c30_00", "c23_02", "c15_00", "c10_01", "c05_01", "c05_09"])
def test_a_door_of_every_level_is_passed_forward_and_the_referee_agrees(referee, name):
    row = next(row for row in rows() if row["id"] == name)
    assert judge(referee, row, reversing=False)


def test_a_goal_with_an_obstacle_behind_it_is_reached_by_reversing(referee):
    row = next(row for row in rows() if row["id"] == "c23_01")
    assert judge(referee, row, reversing=True)


@pytest.mark.slow
@pytest.mark.parametrize("reversing", [False, True])
def test_every_scene_is_solved_but_those_no_forward_way_ends_in(referee, reversing):
    unsolved = {row["id"] for row in rows() if not judge(referee, row, reversing=reversing)}
    assert unsolved == (set() if reversing else SHUT_IN)
