"""The study of perception: simulated frames by default, a folder's when there is one."""

import numpy as np
import pytest

from narrows.errors import StudyError
from narrows.studies import run
from narrows.studies.perception_frames import SIMULATED, load_frame
from narrows.studies.perception_times import measure_map_and_openings


@pytest.mark.slow
def test_simulated_frames_show_the_chain_taking_obstacles_away(tmp_path, monkeypatch):
    monkeypatch.delenv("NARROWS_DATA", raising=False)
    text = run("perception", tmp_path).text
    assert "In somebody's back, table top, wall the largest plane is **not a floor**" in text
    assert all(
        (tmp_path / f"{name.replace(' ', '-')}.png").is_file() for name in ("wall", "cartons")
    )
    assert text.count("| seen |") == len(SIMULATED) - 1  # the wall hides the floor


@pytest.mark.slow
def test_a_folder_of_frames_is_read_and_its_counts_shown(tmp_path, frames_folder):
    again = load_frame("rgrgb", frames_folder)
    assert np.array_equal(again.depth, load_frame("cartons", None).depth)
    assert "64508" in run("perception", tmp_path / "out", data=frames_folder).text


@pytest.mark.slow
def test_the_map_finds_the_door_of_the_simulated_drive():
    steps = measure_map_and_openings(np.random.default_rng(0))
    assert steps["seen_doors"] > 20
    assert steps["mean_width_m"] == pytest.approx(0.9, abs=0.01)


def test_the_frames_may_lie_in_a_folder_named_kinect(tmp_path):
    (tmp_path / "kinect").mkdir()
    with pytest.raises(StudyError, match=r"kinect.intrinsics\.json"):
        run("perception", tmp_path / "out", data=tmp_path)


def test_a_folder_that_is_not_there_is_said(tmp_path):
    with pytest.raises(StudyError, match=r"intrinsics\.json"):
        run("perception", tmp_path, data=tmp_path / "nowhere")
