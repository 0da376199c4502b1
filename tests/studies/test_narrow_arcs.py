"""[NarrowArcs] again: its numbers are ours, its arc touches, the best ones do not."""

from pathlib import Path

import numpy as np
import pytest

from narrows.errors import StudyError
from narrows.planners.corridor_turn import Corner
from narrows.studies.narrow_arcs_cases import (
    ARCS,
    SPEED,
    WIDTH,
    certify_arc,
    chair_cases,
    execute,
    named_arc,
    paper_body,
    run_chair,
    run_turn,
)
from narrows.studies.narrow_arcs_figures import clearance_of_radius, door_trade_off
from narrows.studies.registry import names, run


def test_the_papers_speed_is_ten_turns_of_its_wheel_a_minute():
    assert pytest.approx(0.1676, abs=5e-5) == SPEED


@pytest.mark.parametrize(("name", "clearance_mm"), [*zip(ARCS, (0.0, 69.8, 135.7), strict=True)])
def test_the_certificate_finds_the_clearance_of_each_arc(name, clearance_mm):
    arc = named_arc(name)
    _, attained = certify_arc(paper_body(), Corner(WIDTH, WIDTH), arc)
    assert 1e3 * arc.clearance == pytest.approx(clearance_mm, abs=0.05)
    assert attained == pytest.approx(arc.clearance, abs=2e-4)


def test_there_is_no_other_arc():
    with pytest.raises(StudyError, match="best anywhere"):
        named_arc("wider")


def test_the_curves_have_the_marked_points():
    radii = clearance_of_radius()
    best = radii["inner_radius_m"][radii["bisector_mm"].argmax()]
    assert best == pytest.approx(0.33, abs=0.006)
    assert (radii["free_mm"] >= radii["bisector_mm"] - 1e-6).all()
    zero = np.interp(0.0, -radii["bisector_mm"][100:], radii["inner_radius_m"][100:])
    assert zero == pytest.approx(1.353, abs=1e-3)
    trade = door_trade_off()
    beyond = trade["paper's formulas, centre beyond the wall"]
    assert np.interp(0.9, trade["door_m"], beyond) == pytest.approx(1.86, abs=0.006)
    assert (np.diff(beyond) < 0.0).all()


def test_every_chair_turns_in_its_least_corridor_and_not_in_less():
    for case in chair_cases():
        found = run_chair(case, np.random.default_rng(0))
        assert found["clear_2mm_above"], case
        assert not found["clear_2mm_below"], case
        assert found["bound_m"] < found["one_arc_m"] <= found["bisector_m"] + 1e-9


def test_a_measured_turn_keeps_most_of_the_best_clearance_and_the_papers_touches():
    paper, best = (
        run_turn({"arc": name, "tracker": "linearizing"}, np.random.default_rng(7))
        for name in ARCS[:2]
    )
    assert paper["collided"]
    assert not best["collided"]
    assert best["clearance_mm"] > 40.0
    for turn in (paper, best):
        # 5 mm of noise a reading: centimetres and a degree at most
        assert abs(turn["measured_x_mm"]) < 20.0
        assert abs(turn["measured_y_mm"]) < 20.0
        assert abs(turn["measured_heading_deg"]) < 2.5


def test_the_turn_starts_from_the_measured_pose_and_not_from_the_true_one():
    turn = execute(named_arc(ARCS[1]), np.random.default_rng(1))
    np.testing.assert_allclose(turn.path.start, turn.believed, atol=1e-12)
    np.testing.assert_allclose(turn.record.poses[0], turn.scene.start, atol=1e-12)
    np.testing.assert_allclose(turn.record.estimates[0], turn.believed, atol=1e-12)
    assert np.abs(turn.believed - turn.scene.start).max() > 1e-3


@pytest.mark.slow
def test_the_study_writes_its_tables_pictures_and_findings(tmp_path: Path):
    assert "narrow-arcs" in names()
    report = run("narrow-arcs", tmp_path, drives=3)
    for picture in ("turns", "radius", "door-corridor", "executed"):
        content = (tmp_path / f"{picture}.png").read_bytes()
        assert int.from_bytes(content[16:20], "big") == 1200  # px wide
        assert f"]({picture}.png)" in report.text
    for table in ("chairs", "turns", "clearance-of-radius", "door-corridor"):
        assert (tmp_path / f"{table}.csv").stat().st_size > 200
    assert "| C_n [m] | 0.96 | 0.9569 |" in report.text
    assert "The certificate confirms each" in report.text
    assert "## Failed cases" not in report.text
    again = run("narrow-arcs", tmp_path, drives=3, resume=True)
    assert again.text == report.text
