"""What the page says is what was found, never rounded to the better side."""

import math
from dataclasses import replace

import numpy as np
import pytest

from narrows.clearance import certify
from narrows.interfaces import Plan, PlanStatus
from narrows.path import Path
from narrows.planners.passage import passable
from narrows.profile import Profile
from narrows.scene import Goal, Scene, load_scene
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle
from narrows.viewer.page_words import Words, answer, passage_words, plan_words
from narrows.world import Solid, World


def beside_a_wall(gap):
    wall = Solid.polygon([[-1, 0.4 + gap], [3, 0.4 + gap], [3, 1], [-1, 1]], name="wall")
    scene = Scene(Vehicle.rectangle(1.0, 0.8, 0.2), World((wall,)), [0, 0, 0], Goal([1, 0, 0]))
    path = Path.from_poses([[0, 0, 0], [1, 0, 0]])
    profile = Profile(np.array([0.0, 2.0]), np.array([[0.0, 0.5, 0.0, 0.0]]))
    certificate = certify(scene.world, scene.vehicle, path)
    trajectory = Trajectory(path, profile)
    return Plan(PlanStatus.CERTIFIED, "test", certificate.reason, path, trajectory, certificate)


def test_a_clearance_is_rounded_down():
    words = plan_words(beside_a_wall(0.0209))
    assert (words.tone, words.headline, words.figure) == (
        "good",
        "certified",
        "20 mm clear, proven",
    )


def test_an_impassable_plan_says_how_much_is_missing():
    plan = Plan(PlanStatus.IMPASSABLE, "passage", "too narrow", statistics={"missing_mm": 20.2})
    words = plan_words(plan)
    assert (words.tone, words.headline, words.figure) == ("bad", "impassable", "20 mm missing")


def test_not_found_is_neither_good_nor_a_proof():
    words = plan_words(Plan(PlanStatus.NOT_FOUND, "search", "tried 3"))
    assert words.tone == "unsure"
    assert "neither a way nor a proof" in words.figure


def test_a_passage_that_asks_for_reversing_is_not_promised_to_a_chair_that_does_not():
    scene = load_scene("examples/scenes/door.yaml")
    verdict = passable(scene)
    assert passage_words(verdict, scene).headline == "it can pass if it may reverse"
    reversing = replace(scene, vehicle=scene.vehicle.with_limits(reverse_speed=0.3))
    words = passage_words(verdict, reversing)
    assert (words.headline, words.figure) == ("it can pass", "230 mm to spare")


def test_a_passage_that_does_not_exist_says_what_is_missing():
    scene = load_scene("examples/scenes/too-narrow.yaml")
    words = passage_words(passable(scene), scene)
    assert (words.headline, words.figure) == ("it cannot pass", "20 mm missing")


@pytest.mark.parametrize("make", [lambda text: Words("bad", text, text, text).html(), answer])
def test_text_from_files_and_people_is_escaped(make):
    assert "<script>" not in make("<script>alert(1)</script>")
    assert "&lt;script&gt;" in make("<script>alert(1)</script>")


def test_an_unknown_tone_is_an_error():
    with pytest.raises(KeyError):
        Words("fine", "").html()


def test_nothing_to_touch_has_no_millimetres():
    plan = beside_a_wall(0.1)
    free = replace(plan.certificate, clearance=math.inf, attained=math.inf)
    assert plan_words(replace(plan, certificate=free)).figure == "nothing to touch"
