"""What the assistant is told of itself: options that make sense, regions that fit, its delay."""

import math

import numpy as np
import pytest

from narrows.errors import ShapeError
from narrows.reactive.assistant import Assistant
from narrows.reactive.assistant_options import AssistantOptions
from narrows.reactive.assistant_prediction import Prediction
from narrows.reactive.avoidance import AvoidanceOptions
from narrows.reactive.door_blend import DoorBlendOptions
from narrows.reactive.safety_regions import RegionOptions, SafetyRegions
from narrows.se2 import compose
from narrows.simulation.plant import Plant, PlantOptions
from narrows.vehicle import Vehicle

PERIOD = 0.02


@pytest.mark.parametrize("latency", [0.1, 0.24])
def test_the_chair_is_predicted_where_it_is_when_a_command_takes_effect(xeno, latency):
    prediction = Prediction(latency, 0.05)
    plant = Plant(xeno, [0, 0, 0], PlantOptions(latency=latency), np.random.default_rng(0))
    expected = []
    for k in range(150):
        time = PERIOD * k
        left, right = plant.wheel_speeds
        v, omega = 0.5 * (left + right), (right - left) / xeno.track
        pose, *motion = prediction.ahead(time, v, omega)
        expected.append((time + latency, compose(plant.pose, pose), motion))
        command = (0.4 - 0.4 * math.cos(1.4 * time), 0.8 * math.sin(1.3 * time))
        prediction.send(time, *command)
        plant.command(*command)
        while expected and expected[0][0] <= plant.time + 1e-9:
            _, pose, _ = expected.pop(0)
            assert plant.pose == pytest.approx(pose, abs=4e-3)
        plant.step(0.01)
        plant.step(0.01)


def test_options_of_no_sense_are_refused(simulated, xeno):
    with pytest.raises(ShapeError, match="fresh < stale"):
        AssistantOptions(fresh=0.5, stale=0.4)
    with pytest.raises(ShapeError, match="step <= widest"):
        AvoidanceOptions(step=2.0)
    with pytest.raises(ShapeError, match="share"):
        DoorBlendOptions(share=1.5)
    with pytest.raises(ShapeError, match="comfort"):
        AssistantOptions(comfort=1.5)
    weak = RegionOptions(
        deceleration=0.3, directions=8, levels=4, cell=0.1, castor_samples=2, pose_samples=5
    )
    regions = SafetyRegions.compute(xeno, weak)
    with pytest.raises(ShapeError, match="harder than the full braking"):
        Assistant(xeno, regions)


def test_regions_of_another_chair_or_of_too_little_delay_are_refused(xeno, xeno_regions):
    wider = Vehicle.rectangle(1.1, 0.70, 0.25, track=xeno.track)
    with pytest.raises(ShapeError, match=r"another chair.*0.66 m.*0.7 m"):
        Assistant(wider, xeno_regions)
    with pytest.raises(ShapeError, match=r"latency of 0.1 s.*0.15 s"):
        Assistant(xeno, xeno_regions, AssistantOptions(period=0.1))
