"""The study of sensing: one drive, its pictures, and what the map knew against the truth."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from narrows.errors import StudyError
from narrows.perception.surroundings import Cell
from narrows.scene import Goal, Scene
from narrows.simulation.depth_sensor import DepthSensor, kinect
from narrows.simulation.surfaces import SensedWorld
from narrows.studies import run
from narrows.studies.sensing import CAUSES, why_missing
from narrows.studies.sensing_drive import MOUNTED, Moment, against_truth, living_room
from narrows.vehicle import Vehicle
from narrows.world import MovingSolid, Solid, World


@pytest.mark.slow
def test_the_study_draws_frame_cloud_and_map_and_the_map_frees_no_solid(tmp_path, frames_folder):
    text = run("sensing", tmp_path / "out", data=str(frames_folder)).text
    names = ("frame.png", "cloud.png", "map.png", "real-rgrgb-cloud.png", "real-rgrgb-map.png")
    for name in names:
        with Image.open(tmp_path / "out" / name) as image:
            assert len(image.convert("L").getcolors()) > 100  # shades: something is drawn
        assert f"({name})" in text
    cells = [line.split("|") for line in text.splitlines() if line.startswith(("| 0.4", "| 6.0"))]
    assert len(cells) == 2
    for row in cells:
        assert int(row[2]) > 1000  # occupied
        assert int(row[5]) == 0  # free inside what stands there
    assert int(cells[0][4]) == 0  # occupied where nothing is, before somebody has walked


def test_every_missing_return_has_one_cause_and_no_return_has_one():
    sensor = DepthSensor(kinect(MOUNTED, width=160, height=120))
    world, pose = SensedWorld(living_room().world), np.array([0.9, 1.35, 0.3])
    why = why_missing(sensor, world, pose, 1.0)
    np.testing.assert_array_equal(why == 0, sensor.measure(world, pose, 1.0) > 0)
    assert set(np.unique(why)) == {0, *(CAUSES.index(c) for c in CAUSES[2:])}
    near = DepthSensor(kinect(replace(MOUNTED, x=0.0), width=160, height=120))
    before = SensedWorld(World((Solid.polygon([[0.3, -1], [1, -1], [1, 1], [0.3, 1]]),)))
    why = why_missing(near, before, np.zeros(3), 0.0)
    assert (why == CAUSES.index("too near")).mean() > 0.5


def test_ghosts_and_missed_cells_are_counted():
    wall = Solid.polygon([[1, -1], [1.5, -1], [1.5, 1], [1, 1]])
    somebody = MovingSolid(0.2, np.array([[0.0, -1.0, 0.0]]))
    scene = Scene(
        Vehicle.rectangle(1, 0.6, 0.3),
        World((wall,), moving=(somebody,)),
        [0, 0, 0],
        Goal([0, 0, 0]),
    )
    bands = np.full((1, 40, 40), Cell.UNKNOWN, dtype=np.uint8)  # 0.1 m cells, -2 to 2 m
    bands[0, 30, 20] = Cell.OBSTACLE  # in the wall
    bands[0, 10, 20] = Cell.OBSTACLE  # somebody
    bands[0, 20, 35] = Cell.OBSTACLE  # nothing there
    bands[0, 20, 20] = Cell.FREE
    bands[0, 32, 20] = Cell.FREE  # inside the wall
    moment = Moment(0.0, np.zeros(3), bands, np.array([0.0, 0.2]), (-2.0, 2.0, -2.0, 2.0), {}, 0)
    expected = {"occupied": 3, "free": 2, "ghosts": 1, "missed": 1}
    assert against_truth(scene, moment) == expected


def test_a_folder_that_is_not_there_is_said(tmp_path):
    from narrows.studies.sensing import _real

    with pytest.raises(StudyError, match=r"intrinsics\.json"):
        _real(tmp_path, tmp_path / "nowhere")
