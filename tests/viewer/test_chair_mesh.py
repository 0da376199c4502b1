"""The chair that is drawn lies within the body that plans are made for."""

import numpy as np
import pytest
import shapely

from narrows.scene import load_scene, load_vehicle, vehicle_names
from narrows.vehicle import Layer, Vehicle
from narrows.viewer.chair_mesh import chair_parts


def layered():
    return load_scene("examples/scenes/under-the-table.yaml").vehicle


def odd():
    corners = [[-0.3, 0.0], [0.0, -0.35], [0.6, -0.3], [0.8, 0.0], [0.6, 0.3], [0.0, 0.35]]
    return Vehicle((Layer(np.array(corners), (0.0, 1.2)),), track=0.5)


CHAIRS = {name: load_vehicle(name) for name in vehicle_names()} | {
    "layered": layered(),
    "polygon": odd(),
    "narrow": Vehicle.rectangle(0.5, 0.3, 0.1),
    "low": Vehicle.rectangle(1.0, 0.6, 0.2, height=0.4),
}


@pytest.mark.parametrize("name", CHAIRS)
def test_no_part_sticks_out_of_the_body(name):
    vehicle = CHAIRS[name]
    wheels = {"wheels"}
    for part in chair_parts(vehicle):
        low, high = part.mesh.vertices[:, 2].min(), part.mesh.vertices[:, 2].max()
        assert low >= -1e-9
        assert high <= vehicle.height + 1e-9
        for layer in vehicle.layers:
            rows = part.mesh.vertices
            within = (rows[:, 2] > layer.z[0] + 1e-9) & (rows[:, 2] < layer.z[1] - 1e-9)
            # A wheel's corner may lie outside a slanted body; it is where the drive has it.
            area = shapely.Polygon(layer.polygon).buffer(0.15 if part.name in wheels else 1e-6)
            assert shapely.covers(area, shapely.points(rows[within, :2])).all(), part.name


@pytest.mark.parametrize("name", vehicle_names())
def test_a_chair_has_what_makes_it_unmistakable(name):
    vehicle = load_vehicle(name)
    parts = {part.name: part.mesh.vertices for part in chair_parts(vehicle)}
    assert set(parts) == {"frame", "seat", "wheels", "trunk", "legs", "skin"}
    assert parts["skin"][:, 2].max() == pytest.approx(vehicle.height)  # the head reaches the top
    assert parts["legs"][:, 0].mean() > parts["trunk"][:, 0].mean()  # and one sees where is ahead
    assert abs(parts["wheels"][:, 1]).max() <= 0.5 * vehicle.width + 1e-9
