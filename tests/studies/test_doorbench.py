"""DoorBench: the certificate against the referee, the yardstick's known answers, the study."""

import csv
import importlib.util
import json
import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from narrows.cli import run as run_command
from narrows.errors import MissingExtra, StudyError
from narrows.interfaces import PlanStatus
from narrows.path import Path as Way
from narrows.planners.ladder import RUNGS, plan
from narrows.scene import Goal, Scene
from narrows.se2 import transform
from narrows.studies import run
from narrows.studies.doorbench_generator import LEVELS, doorbench_rows
from narrows.studies.doorbench_judge import figures_of
from narrows.studies.doorbench_planners import CONTESTANTS, available
from narrows.studies.doorbench_profile import Profile, profile_plans
from narrows.studies.doorbench_report import report_of
from narrows.studies.doorbench_scenes import doorbench_scene, read_doorbench
from narrows.studies.doorbench_tables import MEDIANS, compare, summarise
from narrows.studies.ompl_baseline import is_installed, ompl_path
from narrows.studies.table import Table
from narrows.vehicle import Limits, Vehicle
from narrows.world import Solid, World

SHARED = Path(__file__).resolve().parents[3] / "shared" / "doorbench"
AGREED = 1e-3  # m between the certificate and the referee
ROWS = {row["id"]: row for row in doorbench_rows(per_level=4, seed=3)}


@pytest.fixture(scope="module")
def referee():
    """The benchmark's own checker, which shares no code with narrows."""
    file = SHARED / "checker.py"
    if not file.exists():
        pytest.skip(f"DoorBench's checker is not at {SHARED}")
    module = importlib.util.spec_from_file_location("doorbench_checker", file)
    checker = importlib.util.module_from_spec(module)
    module.loader.exec_module(checker)
    return checker


def rows_of(file):
    return {row["id"]: row for row in json.loads(file.read_text(encoding="utf-8"))["scenes"]}


def agree(referee, row, found, *, reversing):
    """Assert that the referee calls a certified plan valid and as clear, rows included."""
    judged = referee.check(row, found.trajectory.poses, allow_reverse=reversing)
    assert judged["valid"], (row["id"], judged["reasons"])
    assert abs(judged["min_clear"] - found.certificate.clearance) <= AGREED
    assert judged["min_clear"] >= found.certificate.clearance - 1e-4  # a bound, but for chords


@pytest.mark.parametrize("level", ["c30", "c10"])
def test_certificate_and_referee_agree_within_a_millimetre(referee, level):
    row = ROWS[f"{level}_00"]
    found = plan(doorbench_scene(row))
    assert found.status is PlanStatus.CERTIFIED, found.reason
    agree(referee, row, found, reversing=False)


@pytest.mark.slow
@pytest.mark.parametrize("reversing", [False, True])
@pytest.mark.parametrize("level", LEVELS)
def test_certificate_and_referee_agree_on_every_development_scene(referee, level, reversing):
    rows = rows_of(SHARED / "scenes.json")
    scenes = read_doorbench(SHARED / "scenes.json", reversing=reversing)
    certified = 0
    for one in scenes:
        if one.level != level:
            continue
        found = plan(one.scene)
        assert found.status is not PlanStatus.IMPASSABLE  # the referee's author solved most
        if found.status is PlanStatus.CERTIFIED:
            certified += 1
            agree(referee, rows[one.name], found, reversing=reversing)
    assert certified >= 10  # of twelve: most have a way, whatever the machine's time budget


@pytest.mark.slow
@pytest.mark.parametrize("rung", ["auto", *RUNGS])
def test_no_rung_claims_what_the_referee_refuses(referee, rung):
    for number, row in enumerate(ROWS.values()):
        for reversing in (False, True):
            if (number + reversing) % 2:
                continue
            found = plan(doorbench_scene(row, reversing=reversing), planner=rung)
            if found.status is PlanStatus.CERTIFIED:
                agree(referee, row, found, reversing=reversing)


def test_the_referee_and_the_judge_refuse_the_same_cut(referee):
    row = ROWS["c10_00"]
    straight = np.linspace(row["start"], row["goal"], 200)
    scene = doorbench_scene(row)
    depth = -1e-3 * figures_of(scene, Way.from_poses(straight)).clearance_mm
    assert depth > 0.05
    judged = referee.check(row, straight, allow_reverse=True)
    assert "collision" in judged["reasons"]
    # the referee measures depth by the separating axis too, at 2 mm
    assert judged["min_clear"] == pytest.approx(-depth, abs=2e-3)


OPEN = World((Solid.polygon([[-5, -2.1], [5, -2.1], [5, -2], [-5, -2]], name="wall"),))
CHAIR = Vehicle.rectangle(1.0, 0.6, 0.25, limits=Limits(curvature=2.5, reverse_speed=0.0))


def drive(*poses):
    """Return a scene whose ends are those of a path, and the path."""
    path = Way.from_poses(poses)
    return Scene(CHAIR, OPEN, path.start, Goal(path.goal)), path


def test_a_line_and_an_arc_are_worth_what_the_formulas_say():
    """Line of 1 m beside a wall, then a quarter circle of radius 1."""
    turn = [[1 + math.sin(a), 1 - math.cos(a), a] for a in np.linspace(0, math.pi / 2, 10)]
    found = figures_of(*drive([0, 0, 0], *turn))
    assert found.is_valid, found.problem
    assert found.length_m == pytest.approx(1 + math.pi / 2, abs=1e-9)
    # one window straddles the joint; its part is second order in the window
    assert found.integral_k2 == pytest.approx(math.pi / 2, rel=0.01)
    assert found.max_curvature == pytest.approx(1.0, abs=1e-9)
    assert found.curvature_jump == pytest.approx(1.0, rel=0.2)
    assert found.direction_changes == 0
    # the body's right side is 0.3 m from the axle's way; the turn leads away from the wall, but
    # the rear corner swings out
    swing = max(0.25 * math.sin(a) + 0.3 * math.cos(a) - (1 - math.cos(a)) for a in (0, 0.1, 0.2))
    assert found.clearance_mm == pytest.approx(1e3 * (2 - swing), abs=1.0)


def test_reversing_is_judged_by_the_chair_and_counts_its_changes():
    scene, path = drive([0, 0, 0], [1, 0, 0], [0.5, 0, 0])
    assert "reverse" in figures_of(scene, path).problem
    able = Scene(
        Vehicle.rectangle(1.0, 0.6, 0.25, limits=Limits(curvature=2.5)),
        OPEN,
        scene.start,
        scene.goal,
    )
    found = figures_of(able, path)
    assert found.is_valid
    assert found.direction_changes == 1
    assert found.length_m == pytest.approx(1.5)


def test_ends_off_the_scenes_are_invalid():
    scene, path = drive([0, 0, 0], [2, 0, 0])
    short = Scene(CHAIR, OPEN, [-0.02, 0, 0], Goal([2.06, 0, 0]))
    assert figures_of(scene, path).is_valid
    problem = figures_of(short, path).problem
    assert "starts 20 mm" in problem
    assert "ends 60 mm" in problem


def test_a_bend_beyond_the_limit_is_invalid():
    turn = [[0.3 * math.sin(a), 0.3 * (1 - math.cos(a)), a] for a in np.linspace(0, 1, 10)]
    assert "curvature" in figures_of(*drive(*turn)).problem


def test_scenes_depend_on_the_seed_alone():
    assert doorbench_rows(2, seed=5) == doorbench_rows(2, seed=5)
    assert doorbench_rows(2, seed=5) != doorbench_rows(2, seed=6)


def test_drawn_scenes_have_free_ends_and_the_width_their_level_says():
    for row in doorbench_rows(8, seed=11):
        scene = doorbench_scene(row)
        solids = shapely.union_all([s.shape.buffer(s.radius) for s in scene.world.solids])
        for pose in (scene.start, scene.goal.pose):
            body = shapely.Polygon(transform(pose, scene.vehicle.outline))
            assert body.distance(solids) > 0.03
        spare = row["door"]["width"] - row["vehicle"]["width"]
        assert spare == pytest.approx(int(row["level"][1:]) / 100)
        assert len(row["obstacles"]) == int(row["id"][-2:]) % 4


def test_drawn_scenes_lie_in_the_shared_ones_ranges():
    """Ours and the development scenes are one family: same walls for the same level."""
    file = SHARED / "scenes.json"
    if not file.exists():
        pytest.skip(f"DoorBench's scenes are not at {SHARED}")
    theirs = rows_of(file)
    for level in LEVELS:
        one, other = theirs[f"{level}_00"], ROWS[f"{level}_00"]
        np.testing.assert_allclose(one["walls"], other["walls"], atol=1e-9)
        assert one["vehicle"] == other["vehicle"]
        np.testing.assert_allclose(one["bounds"], other["bounds"], atol=1e-9)


def test_impossible_numbers_of_scenes_are_refused():
    with pytest.raises(StudyError, match=">= 1"):
        doorbench_rows(0, seed=1)
    with pytest.raises(StudyError, match="negative"):
        doorbench_rows(1, seed=-1)


@pytest.mark.skipif(is_installed(), reason="OMPL is installed")
def test_without_ompl_it_is_left_out_and_says_what_brings_it():
    assert "ompl-rrt" not in available()
    with pytest.raises(MissingExtra, match="bench"):
        ompl_path(doorbench_scene(ROWS["c30_00"]))


@pytest.mark.skipif(not is_installed(), reason="OMPL is not installed (extra bench)")
def test_ompl_finds_a_way_through_a_wide_door():
    scene = doorbench_scene(ROWS["c30_00"])
    found = figures_of(scene, ompl_path(scene))
    assert found.is_valid, found.problem
    assert found.max_curvature == pytest.approx(2.5, rel=0.01)  # Dubins curves turn at the limit


def table_of(*rows):
    names = {"scene", "planner", "level", "is_claimed", "is_valid", "answer", *MEDIANS}
    full = [{"status": "done", **dict.fromkeys(names), **row} for row in rows]
    return Table(("scene", "planner"), (*sorted(names), "status"), tuple(full))


def test_a_summary_counts_what_is_claimed_valid_and_impassable():
    way = {"planner": "a", "level": "x", "is_claimed": True, "answer": "certified"}
    table = table_of(
        {**way, "scene": "1", "is_valid": True, "plan_cpu_s": 1.0, "length_m": 4.0},
        {**way, "scene": "2", "is_valid": False, "plan_cpu_s": 3.0, "length_m": 9.0},
        {
            **way,
            "scene": "3",
            "is_claimed": False,
            "is_valid": False,
            "plan_cpu_s": 2.0,
            "answer": "impassable: 5 mm are missing",
        },
    )
    (row,) = summarise(table, ["a"], ["x"], seed=0)
    assert (row["scenes"], row["claimed"], row["valid"], row["invalid"]) == (3, 2, 1, 1)
    assert row["impassable"] == 1
    assert row["plan_cpu_s"] == 2.0  # of every attempt
    assert row["length_m"] == 4.0  # of the valid one
    assert row["valid_low"] < 1 / 3 < row["valid_high"]


def test_a_comparison_is_over_the_scenes_both_solve():
    def one(scene, planner, squares):
        return {
            "scene": scene,
            "planner": planner,
            "level": "x",
            "is_valid": squares is not None,
            "integral_k2": squares,
        }

    table = table_of(
        one("1", "a", 1.0), one("1", "b", 3.0), one("2", "a", 9.0), one("2", "b", None)
    )
    (row,) = compare(table, "a", ["b"])
    assert (row["scenes"], row["integral_k2_ours"], row["integral_k2_theirs"]) == (1, 1.0, 3.0)


@pytest.mark.slow
def test_the_report_compares_ours_with_as_little_clearance_with_the_others_too():
    way = {"scene": "1", "level": "x", "is_valid": True, "answer": "certified", "is_claimed": True}
    planners = ["narrows", "narrows-1mm", "obca-rechecked"]
    table = table_of(*({**way, "planner": name, "integral_k2": 2.0} for name in planners))
    summary = summarise(table, planners, ["x"], seed=0)
    report = report_of(table, summary, Profile(0, 0.0, (), ()), planners, source="drawn")
    assert "## `narrows` and the others" in report
    assert "## `narrows-1mm` and the others" in report


def test_the_stages_account_for_nearly_all_of_a_plans_time():
    """A renamed function would fall out of the profile."""
    scenes = [doorbench_scene(ROWS[name]) for name in ("c30_00", "c15_01", "c10_02")]
    found = profile_plans(plan, scenes)
    outer = [row for row in found.stages if not str(row["stage"]).startswith("·")]
    assert 0.9 < sum(row["share"] for row in outer) < 1.02
    assert all(row["calls"] > 0 for row in found.stages if "making smooth" in str(row["stage"]))
    assert sum(row["share"] for row in found.modules) > 0.8


@pytest.mark.slow
def test_the_study_runs_from_a_file_writes_its_tables_and_resumes(tmp_path, capsys):
    file = tmp_path / "scenes.json"
    chosen = [ROWS["c30_00"], ROWS["c23_01"]]
    file.write_text(json.dumps({"scenes": chosen}), encoding="utf-8")
    out = tmp_path / "out"
    planners = ("narrows", "obca", "obca-rechecked")
    report = run("doorbench", out, scenes=str(file), planners=planners)
    with (out / "plans.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 6
    ours = [row for row in rows if row["planner"] == "narrows"]
    assert all(row["is_valid"] == "1" and row["is_repeated"] == "1" for row in ours)
    assert {p.name for p in (out / "pictures").iterdir()} == {"c30_00.png", "c23_01.png"}
    assert (out / "summary.png").stat().st_size > 10_000
    assert "claimed but invalid" in report.text
    assert "2 scenes of `scenes.json`" in report.text
    before = (out / "plans.csv").read_bytes()
    run("doorbench", out, scenes=str(file), planners=planners, resume=True, pictures=False)
    assert (out / "plans.csv").read_bytes() == before


def test_the_command_takes_a_file_of_scenes_and_says_when_it_is_none(tmp_path, capsys):
    wrong = tmp_path / "none.json"
    code = run_command(["study", "doorbench", "--out", str(tmp_path), "--scenes", str(wrong)])
    assert code == 2
    assert "none.json" in capsys.readouterr().err


def test_a_study_without_scenes_refuses_the_option(tmp_path, capsys):
    code = run_command(["study", "door-bezier", "--out", str(tmp_path), "--scenes", "x.json"])
    assert code == 2
    assert "no such option" in capsys.readouterr().err


def test_unknown_planners_are_refused(tmp_path):
    with pytest.raises(StudyError, match="no such planner"):
        run("doorbench", tmp_path, planners=("nobody",))


def test_asked_for_the_same_clearance_ours_bends_less_than_when_asked_for_more():
    row = doorbench_rows(1, 3)[0]
    scene = doorbench_scene(row)
    ours, touching = (CONTESTANTS[name].claim(scene).path for name in ("narrows", "narrows-1mm"))
    near, far = figures_of(scene, touching), figures_of(scene, ours)
    assert near.clearance_mm < far.clearance_mm
    assert near.integral_k2 <= far.integral_k2


def test_no_two_planners_look_alike_in_the_pictures():
    from narrows.viewer.doorbench_pictures import look_of

    looks = [look_of(name, list(CONTESTANTS)) for name in CONTESTANTS]
    assert len({(colour, str(dashes)) for colour, dashes, _ in looks}) == len(looks)
    assert len({marker for *_, marker in looks}) == len(looks)


def test_ours_are_marked_as_ours():
    assert [name for name, one in CONTESTANTS.items() if one.is_ours] == [
        "narrows",
        "narrows-reversing",
        "narrows-1mm",
        "search",
        "search-reversing",
    ]
