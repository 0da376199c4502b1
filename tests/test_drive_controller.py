"""`narrows drive --controller`: the plan is driven by who watches."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from narrows.cli import run
from narrows.commands.controllers import controller_names, make_controller
from narrows.errors import InputError
from narrows.path import Path as DrivenPath
from narrows.reactive.safety_regions import RegionOptions, SafetyRegions
from narrows.scene import Goal, Scene, load_scene
from narrows.simulation.judge import judge
from narrows.simulation.record import read_record
from narrows.simulation.simulator import simulate
from narrows.world import MovingSolid, World

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


@pytest.mark.slow
def test_by_its_own_sensors_it_waits_for_somebody_on_its_way_and_goes_on_when_she_has_gone():
    scene = load_scene(SCENES / "door.yaml")
    x, y, _ = scene.start
    walk = [[0, x + 2.5, y + 1], [1, x + 1.9, y], [2.5, x + 1.9, y], [4, x + 2.5, y + 3]]
    she = MovingSolid(0.25, np.array(walk, dtype=float), (0.0, 1.8), "she")
    path = DrivenPath.from_poses([scene.start, np.add(scene.start, [1.6, 0.0, 0.0])])
    scene = Scene(scene.vehicle, World(moving=(she,)), scene.start, Goal(path.goal))
    fitted = make_controller("navigator", scene, path, senses="sensors")
    options = replace(fitted.options, time_limit=14.0)
    record = simulate(scene, fitted.controller, senses=fitted.senses, options=options)
    assert judge(scene, record).reached
    assert fitted.outcome() == "arrived"
    there = (record.times > 1.0) & (record.times < 2.5)
    assert record.signals["waits"][there].all()
    # Her upper half is out of the camera's view when she has gone: it does not bar the way.
    assert record.times[-1] < 12.0


@pytest.mark.parametrize("senses", ["ideal", "sensors"])
def test_senses_that_fall_silent_stop_the_chair_within_its_braking_distance(senses):
    scene, silent_from = load_scene(SCENES / "door.yaml"), 4.0
    path = DrivenPath.from_poses([scene.start, np.add(scene.start, [3.0, 0.0, 0.0])])
    scene = replace(scene, world=World())
    fitted = make_controller("navigator", scene, path, senses=senses, silent_from=silent_from)
    options = replace(fitted.options, time_limit=7.0)
    record = simulate(scene, fitted.controller, senses=fitted.senses, options=options)
    last = np.searchsorted(record.times, silent_from)
    speed = record.wheel_speeds[last].mean()
    assert speed > 0.3
    guard = fitted.controller.guard
    way = record.poses[-1, 0] - record.poses[last, 0]
    assert way <= speed * guard.options.oldest + guard.stopping_distance(speed)
    assert np.abs(record.wheel_speeds[-1]).max() < 1e-3
    assert fitted.outcome() == "waits: the sensors are silent"


def test_a_bend_tighter_than_it_is_long_is_driven_clear_of_the_jambs(capsys):
    """Braking along the arc it drives, instead of along its path, the chair would cut a jamb."""
    words = ["drive", str(SCENES / "tight-door.yaml"), "--controller", "navigator", "--json"]
    assert run(words) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures["collisions"] == 0
    assert figures["min_clearance_m"] > 0.015


@pytest.mark.parametrize(("option", "value"), [("--senses", ""), ("--silent-from", "nan")])
def test_odd_values_are_refused(capsys, option, value):
    assert run(["drive", SOMEBODY, "--controller", "navigator", option, value]) == 2
    assert option in capsys.readouterr().err


def test_unknown_senses_are_refused_with_the_known_ones(capsys):
    words = ["drive", SOMEBODY, "--controller", "navigator", "--senses", "eyes"]
    assert run(words) == 2
    message = capsys.readouterr().err
    assert "--senses" in message
    assert "ideal, sensors" in message


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


@pytest.mark.parametrize(
    ("option", "owner"),
    [
        ("--driver", "assistant"),
        ("--regions", "assistant"),
        ("--senses", "navigator"),
        ("--silent-from", "navigator"),
    ],
)
def test_what_belongs_to_a_controller_is_refused_without_it(capsys, option, owner):
    assert run(["drive", SOMEBODY, option, "1"]) == 2
    assert f"{option} belongs to --controller {owner}" in capsys.readouterr().err


def test_an_unknown_driver_is_refused_with_the_known_ones(capsys, regions):
    words = ["--controller", "assistant", "--driver", "nobody", "--regions", str(regions)]
    assert run(["drive", str(SCENES / "narrow-door.yaml"), *words]) == 2
    message = capsys.readouterr().err
    assert "--driver" in message
    assert "steady" in message


@pytest.mark.parametrize(("scene", "why"), [("narrow-door", ""), ("door", "cannot back off")])
def test_the_assistant_says_how_the_drive_ended_for_the_driver(regions, scene, why):
    place = load_scene(SCENES / f"{scene}.yaml")
    way = DrivenPath.from_poses([place.start, [0.0, 0.8, 0.0]])
    fitted = make_controller("assistant", place, way, regions=str(regions))
    assert "the steady driver did not get there" in fitted.outcome()
    assert fitted.outcome().endswith(why or "in the time")
    record = simulate(place, fitted.controller, senses=fitted.senses, options=fitted.options)
    assert record.duration < 10.0
    assert "let go where they wanted to be" in fitted.outcome()
    assert "the goal asks for 50 mm and 3 degrees" in fitted.outcome()
