"""What is on its way is known: the pose predicted is the pose that comes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from narrows.errors import ShapeError
from narrows.simulation.plant import Plant, PlantOptions
from narrows.tracking.delay import DelayPrediction, moved


@pytest.mark.parametrize("latency", [0.0, 0.03, 0.1, 0.3])
def test_a_pure_latency_is_predicted_exactly(agile, latency):
    options = PlantOptions(motor_lag=0.0, wheel_acceleration=1e6, latency=latency)
    plant = Plant(agile, [1.0, 2.0, 3.0], options, np.random.default_rng(0))
    prediction = DelayPrediction(latency)
    rng = np.random.default_rng(1)
    predicted = {}
    for k in range(200):
        time = 0.02 * k
        predicted[round(time + latency, 6)] = prediction.predict(time, *plant.pose)
        v, omega = rng.uniform(-1, 1, 2)
        prediction.sent(time, v, omega)
        plant.command(v, omega)
        for _ in range(2):
            now = round(plant.time, 6)
            if now in predicted:
                # the wheels' limited rate leaves a microsecond's travel a command
                assert_allclose(plant.pose, predicted[now], atol=1e-4)
            plant.step(0.01)


def test_a_motor_lag_counts_as_a_delay_once_the_speed_is_steady(agile):
    plant = Plant(agile, [0, 0, 0], PlantOptions(motor_lag=0.05), np.random.default_rng(0))
    prediction = DelayPrediction(0.05)
    for k in range(100):
        ahead = prediction.predict(0.02 * k, *plant.pose)
        prediction.sent(0.02 * k, 0.4, 0.5)
        plant.command(0.4, 0.5)
        plant.step(0.01)
        plant.step(0.01)
    expected = moved(*plant.pose, 0.4, 0.5, 0.05 - 0.02)
    # the wheels first ramped at 3 m/s^2: 0.55 m/s takes 0.18 s, of which the lag explains 0.05
    assert_allclose(ahead, expected, atol=1e-3)


def test_a_negative_delay_is_refused():
    with pytest.raises(ShapeError, match="delay must be a finite number >= 0"):
        DelayPrediction(-0.1)
