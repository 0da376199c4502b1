"""`narrows drive --controller`: the plan is driven by who watches."""

import json
from pathlib import Path

import numpy as np
import pytest

from narrows.cli import run
from narrows.commands.controllers import controller_names, make_controller
from narrows.errors import InputError
from narrows.path import Path as DrivenPath
from narrows.reactive.safety_regions import RegionOptions, SafetyRegions
from narrows.scene import load_scene
from narrows.simulation.record import read_record

SCENES = Path(__file__).parents[1] / "examples" / "scenes"
SOMEBODY = str(SCENES / "somebody-in-the-door.yaml")


def test_somebody_in_the_door_stops_the_chair_and_a_cleared_door_lets_it_go_on(capsys, tmp_path):
    file = tmp_path / "drive.csv"
    code = run(["drive", SOMEBODY, "--controller", "navigator", "--record", str(file)])
    text = capsys.readouterr().out
    assert code == 0
    assert "navigator             arrived" in text
    assert "driven: reached" in text
    assert "collisions            0" in text
    record = read_record(file)
    inside = (record.times > 5.0) & (record.times < 8.0)
    assert np.abs(record.wheel_speeds[inside]).max() < 1e-3  # she stands in the passage
    assert record.signals["waits"][inside].all()
    assert record.times[-1] > 15.0


def test_without_a_watcher_the_plan_must_foresee_her(capsys):
    assert run(["drive", SOMEBODY, "--json"]) == 4
    assert json.loads(capsys.readouterr().out)["reached"] is False


def test_an_unknown_controller_is_refused_with_the_known_ones(capsys):
    assert run(["drive", SOMEBODY, "--controller", "nobody"]) == 2
    message = capsys.readouterr().err
    assert "--controller" in message
    assert "navigator" in message


def test_controllers_are_made_by_name():
    scene = load_scene(SCENES / "door.yaml")
    path = DrivenPath.from_poses([scene.start, scene.goal.pose])
    assert "navigator" in controller_names()
    fitted = make_controller("navigator", scene, path, tracker="linearizing")
    assert not fitted.controller.finished
    assert fitted.outcome() == "on its way"
    with pytest.raises(InputError, match="no such controller"):
        make_controller("nobody", scene, path, tracker="linearizing")


@pytest.fixture(scope="module")
def regions(tmp_path_factory):
    """Safety regions of the scene's chair, coarse ones that are computed soon."""
    scene = load_scene(SCENES / "narrow-door.yaml")
    options = RegionOptions(directions=120, levels=16, cell=0.04)
    file = tmp_path_factory.mktemp("regions") / "regions.npz"
    SafetyRegions.compute(scene.vehicle, options).save(file)
    return file


@pytest.mark.slow
def test_with_the_assistant_a_driver_touches_nothing(capsys, regions):
    words = ["--controller", "assistant", "--driver", "hasty", "--regions", str(regions)]
    run(["drive", str(SCENES / "narrow-door.yaml"), *words, "--json"])
    figures = json.loads(capsys.readouterr().out)
    assert figures["collisions"] == 0
    assert figures["length_m"] > 1.0
    assert figures["max_cross_track_error_m"] is None  # people follow no path


def test_regions_of_another_chair_are_refused(capsys, regions):
    words = ["--controller", "assistant", "--regions", str(regions)]
    assert run(["drive", str(SCENES / "course.yaml"), *words]) == 2
    assert str(regions) in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--driver", "--regions"])
def test_what_belongs_to_the_assistant_is_refused_without_it(capsys, option):
    assert run(["drive", SOMEBODY, option, "x"]) == 2
    assert f"{option} belongs to --controller assistant" in capsys.readouterr().err


def test_an_unknown_driver_is_refused_with_the_known_ones(capsys, regions):
    words = ["--controller", "assistant", "--driver", "nobody", "--regions", str(regions)]
    assert run(["drive", str(SCENES / "narrow-door.yaml"), *words]) == 2
    message = capsys.readouterr().err
    assert "--driver" in message
    assert "steady" in message
