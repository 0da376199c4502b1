"""The chair: its sizes, its wheels, and what is refused."""

import dataclasses
import math

import numpy as np
import pytest

from narrows.errors import ShapeError
from narrows.vehicle import Layer, Limits, Vehicle


def test_a_rear_drive_rectangle_spans_from_its_overhang_to_its_front():
    chair = Vehicle.rectangle(1.2, 0.7, 0.25)
    assert chair.outline.min(axis=0).tolist() == [-0.25, -0.35]
    assert chair.outline.max(axis=0).tolist() == [0.95, 0.35]
    assert (chair.length, chair.width) == pytest.approx((1.2, 0.7))
    assert (chair.front_overhang, chair.rear_overhang) == pytest.approx((0.95, 0.25))
    assert chair.radius == pytest.approx(math.hypot(0.95, 0.35))
    assert chair.track == pytest.approx(0.85 * 0.7)


def test_the_outline_is_the_hull_of_all_layers():
    low = Layer([[-0.3, -0.3], [0.3, -0.3], [0.3, 0.3], [-0.3, 0.3]], (0.0, 0.5))
    high = Layer([[0.0, -0.1], [0.9, -0.1], [0.9, 0.1], [0.0, 0.1]], (0.5, 1.2))
    chair = Vehicle((low, high))
    assert sorted(map(tuple, chair.outline.tolist())) == [
        (-0.3, -0.3),
        (-0.3, 0.3),
        (0.3, -0.3),
        (0.3, 0.3),
        (0.9, -0.1),
        (0.9, 0.1),
    ]
    assert chair.height == 1.2
    assert chair.radius == pytest.approx(math.hypot(0.9, 0.1))


def test_wheel_speeds_turn_the_chair_as_commanded():
    chair = Vehicle.rectangle(1.0, 0.6, 0.2, track=0.5)
    commands = np.random.default_rng(0).normal(size=(50, 2))
    left, right = np.moveaxis(chair.wheel_speeds(commands), -1, 0)
    np.testing.assert_allclose(0.5 * (left + right), commands[:, 0], atol=1e-15)
    np.testing.assert_allclose((right - left) / chair.track, commands[:, 1], atol=1e-15)


def test_turning_on_the_spot_is_what_unlimited_curvature_allows():
    chair = Vehicle.rectangle(1.0, 0.6, 0.2)
    assert chair.may_turn_on_the_spot
    slower = chair.with_limits(curvature=2.5, speed=0.3)
    assert not slower.may_turn_on_the_spot
    assert slower.limits == dataclasses.replace(chair.limits, curvature=2.5, speed=0.3)
    assert chair.limits == Limits()
    assert slower.layers == chair.layers


def test_the_polygon_is_a_read_only_copy():
    corners = np.array([[0.0, -0.3], [1.0, -0.3], [1.0, 0.3], [0.0, 0.3]])
    layer = Layer(corners, (0.0, 1.0))
    corners[0] = 9.0
    assert layer.polygon.max() == 1.0
    with pytest.raises(ValueError, match="read-only"):
        layer.polygon[0, 0] = 9.0


@pytest.mark.parametrize("name", [field.name for field in dataclasses.fields(Limits)])
@pytest.mark.parametrize("value", [-1.0, math.nan, -math.inf])
def test_no_limit_is_negative_or_no_number(name, value):
    with pytest.raises(ShapeError, match=f"limit {name} must be a finite positive number"):
        Limits(**{name: value})


def test_only_the_reverse_speed_may_be_nothing_and_only_the_curvature_unlimited():
    zero_ok, infinite_ok = [], []
    for field in dataclasses.fields(Limits):
        for value, accepted in ((0.0, zero_ok), (math.inf, infinite_ok)):
            try:
                Limits(**{field.name: value})
            except ShapeError:
                continue
            accepted.append(field.name)
    assert zero_ok == ["reverse_speed"]
    assert infinite_ok == ["curvature"]


@pytest.mark.parametrize("z", [(1.0, 1.0), (-0.1, 1.0), (0.0, math.inf), (0.0, math.nan)])
def test_a_layer_needs_heights_above_the_floor(z):
    with pytest.raises(ShapeError, match="heights"):
        Layer([[0, 0], [1, 0], [0, 1]], z)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"track": 0.0}, "track"),
        ({"wheel_radius": math.nan}, "wheel_radius"),
        ({"layers": ()}, "layer"),
    ],
)
def test_a_chair_needs_a_body_and_wheels(change, message):
    chair = Vehicle.rectangle(1.0, 0.6, 0.2)
    with pytest.raises(ShapeError, match=message):
        dataclasses.replace(chair, **change)


@pytest.mark.parametrize(
    ("length", "width"), [(0.0, 0.6), (-1.0, 0.6), (1.0, 0.0), (1.0, math.inf)]
)
def test_a_rectangle_without_an_extent_is_refused_by_name(length, width):
    name = "length" if length <= 0.0 else "width"
    with pytest.raises(ShapeError, match=f"{name} must be a positive number"):
        Vehicle.rectangle(length, width, 0.2)
