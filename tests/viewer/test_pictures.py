"""Pictures: right size, the same in every run, truthful about what is not certified."""

import io
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
import shapely
from matplotlib.text import Text
from PIL import Image

from narrows.clearance import certify
from narrows.errors import InputError
from narrows.interfaces import Plan, PlanStatus
from narrows.path import Path
from narrows.planners.finish import finished_plan
from narrows.planners.passage import passable
from narrows.planners.timing import time_path
from narrows.scene import Goal, Scene, read_scene
from narrows.vehicle import Vehicle
from narrows.verification import verify
from narrows.viewer.charts import TrackingErrors
from narrows.viewer.motion_drawing import swept_area
from narrows.viewer.pictures import (
    drive_picture,
    plan_picture,
    save_picture,
    verification_picture,
)
from narrows.viewer.scene_drawing import outline_of
from narrows.viewer.verdict_pictures import verdict_picture
from narrows.viewer.view_box import view_box
from narrows.world import Door, MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.66, 0.25)
WALL = Solid.polygon([[-1, 1], [5, 1], [5, 1.1], [-1, 1.1]], name="wall")
SHELF = Solid.polygon([[1, -1], [2, -1], [2, 0.2], [1, 0.2]], z=(1.5, 1.7), name="shelf")
STOOL = Solid.circle(4.5, 0.0, 0.2, z=(0.0, 0.5), name="stool")
PERSON = MovingSolid(0.25, np.array([[0.0, 4.0, -3.0], [5.0, 3.0, -3.0]]), name="Anna")
DOOR = Door((2.0, 1.05), 0.9, np.pi / 2)
WORLD = World((WALL, SHELF, STOOL), (-1.5, -3.5, 5.5, 1.5), (PERSON,), (DOOR,))
SCENE = Scene(CHAIR, WORLD, np.zeros(3), Goal(np.array([3.0, 0.0, 0.0])), name="a room")
MOTION = Path.from_poses(
    [[0, 0, 0], [2, 0.2, 0.2], [2, 0.2, -0.2], [1.5, 0.3, -0.2], [1.5, 0.3, 0], [3, 0.3, 0]]
)


def texts(figure) -> str:
    """Return all that is written in a figure."""
    found = [figure.get_suptitle()]
    for axes in figure.axes:
        found += [axes.get_title(), *(text.get_text() for text in axes.texts)]
    for legend in figure.legends:
        found += [text.get_text() for text in legend.get_texts()]
    return "\n".join(found)


@pytest.fixture(scope="module")
def plan() -> Plan:
    path = Path.from_poses([[0, 0, 0], [3, 0, 0]])
    plan = finished_plan(SCENE, path, planner="doorway")
    assert plan.status is PlanStatus.CERTIFIED
    return plan


@pytest.mark.slow
def test_a_png_is_1200_px_wide_and_the_same_twice(tmp_path, plan):
    for name in ("a.png", "b.png"):
        save_picture(plan_picture(SCENE, plan), tmp_path / name)
    content = (tmp_path / "a.png").read_bytes()
    assert content == (tmp_path / "b.png").read_bytes()
    image = Image.open(io.BytesIO(content))
    assert image.width == 1200
    assert 600 < image.height < 1600
    assert b"Software" not in content


@pytest.mark.slow
def test_an_svg_is_valid_and_the_same_twice(tmp_path, plan):
    for name in ("a.svg", "b.svg"):
        save_picture(plan_picture(SCENE, plan), tmp_path / name)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert ElementTree.parse(tmp_path / "a.svg").getroot().tag.endswith("svg")


def test_a_certified_plan_shows_its_proven_clearance(plan):
    shown = texts(plan_picture(SCENE, plan))
    assert "a room: certified (doorway planner)" in shown
    least = 1e3 * plan.certificate.clearance
    assert f"{least:.0f} mm to {plan.certificate.against}" in shown
    assert "not certified" not in shown


def test_a_refused_motion_is_called_so_and_dashed():
    refused = Path.from_poses([[0, 0, 0], [4, 0, 0]])
    figure = verification_picture(SCENE, refused, verify(SCENE, refused))
    shown = texts(figure)
    assert "a room: not certified" in shown
    assert "swept body, not certified" in shown
    assert "mm inside stool" in shown
    lines = [line for line in figure.axes[0].get_lines() if "drive axle" in str(line.get_label())]
    assert lines
    assert all(line.is_dashed() for line in lines)


def test_a_scene_without_a_plan_shows_the_reason():
    reason = "nothing passes: the door is 21 mm too narrow"
    shown = texts(plan_picture(SCENE, Plan(PlanStatus.IMPASSABLE, "passage", reason)))
    assert "a room: impassable" in shown
    assert reason in shown
    assert "start" in shown
    assert "goal" in shown
    assert "swept" not in shown


@pytest.mark.parametrize(
    ("width", "shown", "found"),
    [(0.80, "140 mm to spare", "a way for the body"), (0.60, "60 mm missing", "middle can be")],
)
def test_a_verdict_shows_the_narrowest_place_and_what_was_found(width, shown, found):
    text = f"{{vehicle: adaag, doorway: {{corridor_width: 1.6, door_width: {width}}}}}"
    scene = read_scene(text)
    verdict = passable(scene)
    figure = verdict_picture(scene, verdict)
    assert shown in texts(figure)  # the chair is 0.66 m wide
    assert found in texts(figure)
    cross = next(line for line in figure.axes[0].get_lines() if line.get_marker() == "x")
    assert np.array(cross.get_data()).ravel() == pytest.approx(verdict.narrowest)


def test_every_kind_of_thing_is_in_the_legend():
    trajectory = time_path(MOTION, CHAIR)
    certificate = certify(WORLD, CHAIR, trajectory)
    errors = TrackingErrors(trajectory.times, 0.01 * np.sin(trajectory.times))
    figure = drive_picture(
        SCENE, trajectory, certificate, planned=MOTION, errors=errors, text="it stands at the goal"
    )
    shown = texts(figure)
    for name in (
        "solid",
        "above the chair",
        "moving",
        "swept body",
        "planned",
        "drive axle, forward",
        "drive axle, in reverse",
        "turn on the spot",
        "change of direction",
        "door 0.90 m",
        "tracking error, at most 10.0 mm",
    ):
        assert name in shown


def test_nothing_written_leaves_the_picture_or_covers_another_label():
    refused = Path.from_poses([[0, 0, 0], [4, 0, 0]])
    figure = verification_picture(SCENE, refused, verify(SCENE, refused))
    figure.draw_without_rendering()
    width, height = figure.get_size_inches() * figure.dpi
    boxes = []
    for axes in figure.axes:
        written = [axes.title, axes.xaxis.label, axes.yaxis.label, *axes.texts]
        for text in filter(lambda t: t.get_text(), written):
            box = Text.get_window_extent(text)  # of an annotation: without its arrow
            assert box.x0 >= 0
            assert box.y0 >= 0
            assert box.x1 <= width
            assert box.y1 <= height
            boxes.append(shapely.box(*box.extents))
    for index, box in enumerate(boxes):
        assert not any(box.intersects(other) for other in boxes[:index])


def test_the_area_drawn_as_swept_is_the_bodies_way():
    area = shapely.union_all(swept_area(CHAIR.outline, Path.from_poses([[0, 0, 0], [2, 0, 0]])))
    assert area.area == pytest.approx(3.0 * 0.66, rel=1e-9)
    turn = shapely.union_all(swept_area(CHAIR.outline, Path.from_poses([[0, 0, 0], [0, 0, 3.0]])))
    assert turn.area <= np.pi * CHAIR.radius**2
    assert turn.area >= 0.45 * np.pi * CHAIR.radius**2


def test_holes_stay_open():
    both_counter_clockwise = ([[0, 0], [4, 0], [4, 4], [0, 4]], [[[1, 1], [3, 1], [3, 3], [1, 3]]])
    frame = shapely.Polygon(*both_counter_clockwise)
    outline = outline_of([frame])
    assert outline.contains_point((0.5, 0.5))
    outer, inner = outline.to_polygons()
    assert shapely.Polygon(outer).exterior.is_ccw != shapely.Polygon(inner).exterior.is_ccw


def test_a_large_world_is_cropped_to_the_motion_and_a_small_one_shown_whole():
    far = Solid.polygon([[90, 90], [91, 90], [91, 91], [90, 91]], name="far")
    path = Path.from_poses([[0, 0, 0], [3, 0, 0]])
    large = Scene(CHAIR, World((WALL, far)), np.zeros(3), Goal(np.array([3.0, 0.0, 0.0])))
    box = view_box(large, [path])
    assert box[0] < -0.25
    assert box[2] < 6.0
    x_min, y_min, x_max, y_max = view_box(SCENE, [path])
    assert x_min < -1.5
    assert y_min < -3.5
    assert x_max > 5.5
    assert y_max > 1.5


def test_other_suffixes_are_refused(tmp_path, plan):
    with pytest.raises(InputError, match=r"allowed: \.png or \.svg"):
        save_picture(plan_picture(SCENE, plan), tmp_path / "a.pdf")
