"""[DoorBezier] again: the published tracking error, and the jambs its curves hit."""

from pathlib import Path

import numpy as np
import pytest

from narrows import bezier
from narrows.errors import StudyError
from narrows.studies import door_bezier
from narrows.studies.door_bezier_cases import (
    HEADINGS_DEG,
    OBSTACLES,
    certificates,
    drive_curve,
    paper_chair,
    plan_trajectory,
    run_obstacles,
)
from narrows.studies.registry import names, run
from narrows.tracking.lookahead import LookaheadOptions


def test_the_papers_55_mm_is_the_look_ahead_error_of_trajectory_a1() -> None:
    scene, segment = plan_trajectory("A1")
    assert segment.control is not None
    drive = drive_curve(scene, segment.control)
    # "about 55 mm"; 57 by the corrections' own simulation
    assert 1e3 * np.abs(drive.lookahead_error).max() == pytest.approx(57.0, abs=1.5)
    assert np.abs(drive.omega).max() == pytest.approx(0.70, abs=0.01)
    assert 1e3 * np.abs(drive.record.cross_track).max() < 20.0  # C_err is 3-20 mm
    assert drive.parameter[0] == pytest.approx(0.0, abs=0.02)
    assert drive.parameter[-1] == pytest.approx(1.0, abs=0.02)


def test_a_slower_drive_halves_the_look_ahead_error() -> None:
    """The steady error is D = V kappa / kp: half the speed, half the error."""
    scene, segment = plan_trajectory("A1")
    assert segment.control is not None
    full, half = (
        np.abs(
            drive_curve(
                scene, segment.control, options=LookaheadOptions.paper(speed=speed)
            ).lookahead_error
        ).max()
        for speed in (0.4, 0.2)
    )
    assert half == pytest.approx(0.5 * full, rel=0.15)  # the derivative and integral terms


@pytest.mark.parametrize("name", ["A1", "A2", "B1"])
def test_the_papers_first_segments_cut_the_jamb_whichever_the_reference_point(name: str) -> None:
    scene, segment = plan_trajectory(name)
    assert segment.control is not None
    for certificate in certificates(scene, segment.control):
        assert certificate.attained < -0.05
        assert "jamb" in certificate.against


def test_the_chair_is_as_the_study_says() -> None:
    for reference, rear in (("axle", 0.25), ("middle", 0.55)):
        chair = paper_chair(reference=reference)
        assert (chair.length, chair.width, chair.rear_overhang) == pytest.approx((1.1, 0.75, rear))
    with pytest.raises(StudyError, match="'axle' or 'middle', got 'nose'"):
        paper_chair(reference="nose")


def test_both_obstacles_push_the_curves_to_their_distance() -> None:
    free, avoiding = (run_obstacles(with_obstacles=choice) for choice in (False, True))
    for k, (x, y, radius) in enumerate(OBSTACLES):
        asked = radius + 0.375
        near = [
            np.linalg.norm(bezier.evaluate(run.control[k], np.linspace(0, 1, 500)) - [x, y], axis=1)
            for run in (free, avoiding)
        ]
        assert near[0].min() < asked - 0.03
        assert near[1].min() == pytest.approx(asked, abs=5e-4)  # active, between samples
        assert avoiding.costs[k] > free.costs[k]
    arrived = avoiding.drives[0].arrived
    np.testing.assert_allclose(avoiding.control[1, 0], arrived[:2])
    tangent = avoiding.control[1, 1] - avoiding.control[1, 0]
    assert abs(tangent[0]) < 1e-9  # along the door's normal, not the chair's true heading


@pytest.mark.slow
def test_the_study_writes_its_tables_pictures_and_findings(tmp_path: Path) -> None:
    assert "door-bezier" in names()
    report = run("door-bezier", tmp_path)
    for name in HEADINGS_DEG:
        for kind in ("reference", "driven"):
            rows = np.genfromtxt(tmp_path / f"{name}-{kind}.csv", delimiter=",", names=True)
            assert np.isfinite(rows["x"]).all()
            assert len(rows) > 100
    for picture in ("trajectories", "tracking-errors", "obstacles"):
        content = (tmp_path / f"{picture}.png").read_bytes()
        assert int.from_bytes(content[16:20], "big") == 1200  # px wide
        assert f"]({picture}.png)" in report.text
    assert "**A1 cuts 210 mm into the right jamb**" in report.text
    assert "57 mm (the paper: about 55 mm)" in report.text
    again = door_bezier.run(tmp_path, jobs=1, resume=True, seed=0)
    assert again == report.text
