"""The plant: exact arcs, motors with a closed-form answer, encoders, seeded disturbances."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import ShapeError
from narrows.simulation.localisation import EncoderOdometry, ExactPose, NoisyPose
from narrows.simulation.noise import GaussMarkov
from narrows.simulation.plant import CastorFlip, Plant, PlantOptions, wheel_motion
from narrows.vehicle import Vehicle

CHAIR = Vehicle.rectangle(1.0, 0.6, 0.3, track=0.5)
IDEAL = {"motor_lag": 0.0, "wheel_acceleration": math.inf}


def plant(seed: int = 0, pose: tuple[float, float, float] = (0, 0, 0), **options: object) -> Plant:
    return Plant(CHAIR, pose, PlantOptions(**options), np.random.default_rng(seed))  # type: ignore[arg-type]


def drive(chair: Plant, v: float, omega: float, steps: int, dt: float = 0.01) -> np.ndarray:
    """Return the poses after each step under one command."""
    chair.command(v, omega)
    poses = []
    for _ in range(steps):
        chair.step(dt)
        poses.append(chair.pose)
    return np.array(poses)


def test_a_straight_line_is_exact() -> None:
    poses = drive(plant(**IDEAL, pose=(1.0, 2.0, 0.5)), 0.4, 0.0, 250)
    np.testing.assert_allclose(
        poses[-1], [1 + math.cos(0.5), 2 + math.sin(0.5), 0.5], rtol=0, atol=1e-12
    )


@pytest.mark.parametrize("dt", [0.01, 0.5])
def test_a_full_circle_ends_where_it_began_at_any_step(dt: float) -> None:
    v, omega = 0.4, 2 * math.pi / 10.0  # radius 0.64 m, ten seconds
    poses = drive(plant(**IDEAL), v, omega, round(10.0 / dt), dt)
    np.testing.assert_allclose(poses[-1], [0, 0, 2 * math.pi], atol=1e-11)
    center = [0.0, v / omega]
    np.testing.assert_allclose(np.linalg.norm(poses[:, :2] - center, axis=1), v / omega, atol=1e-11)


def test_a_lagging_motor_answers_a_step_as_an_exponential() -> None:
    lag, v = 0.2, 0.5
    chair = plant(motor_lag=lag, wheel_acceleration=math.inf)
    poses = drive(chair, v, 0.0, 100)
    t = 0.01 * np.arange(1, 101)
    # x(t) = v (t - lag (1 - exp(-t / lag)))
    np.testing.assert_allclose(poses[:, 0], v * (t - lag * (1 - np.exp(-t / lag))), atol=1e-12)
    assert chair.wheel_speeds[0] == pytest.approx(v * (1 - math.exp(-1.0 / lag)), abs=1e-12)


def test_a_limited_motor_ramps() -> None:
    chair = plant(motor_lag=0.0, wheel_acceleration=1.0)
    poses = drive(chair, 0.5, 0.0, 100)
    assert poses[49, 0] == pytest.approx(0.5 * 0.5**2)  # half a second at 1 m/s^2
    assert poses[-1, 0] == pytest.approx(0.125 + 0.5 * 0.5)


@given(
    speed=st.floats(-2, 2),
    target=st.floats(-2, 2),
    lag=st.floats(0, 1),
    acceleration=st.floats(0.1, 10),
    cut=st.floats(0.01, 0.99),
)
@settings(deadline=None, max_examples=200)
def test_a_wheel_moves_the_same_in_one_step_and_in_two(
    speed: float, target: float, lag: float, acceleration: float, cut: float
) -> None:
    whole = wheel_motion(speed, target, 0.3, lag=lag, acceleration=acceleration)
    first = wheel_motion(speed, target, 0.3 * cut, lag=lag, acceleration=acceleration)
    second = wheel_motion(first[0], target, 0.3 * (1 - cut), lag=lag, acceleration=acceleration)
    assert second[0] == pytest.approx(whole[0], abs=1e-9)
    assert first[1] + second[1] == pytest.approx(whole[1], abs=1e-9)
    assert abs(whole[0] - speed) <= acceleration * 0.3 + 1e-9
    assert min(speed, target) - 1e-12 <= whole[0] <= max(speed, target) + 1e-12


def test_wheel_limits_are_kept() -> None:
    chair = plant(motor_lag=0.02, wheel_speed=0.6, wheel_acceleration=1.5)
    rims = []
    for v, omega in ((1.0, 2.0), (-1.0, 0.0), (0.2, -3.0)):
        chair.command(v, omega)
        for _ in range(60):
            chair.step(0.01)
            rims.append(chair.wheel_speeds)
    speeds = np.array(rims)
    assert np.abs(speeds).max() <= 0.6 + 1e-12
    assert np.abs(speeds).max() == pytest.approx(0.6, abs=1e-6)
    assert np.abs(np.diff(speeds, axis=0)).max() <= 1.5 * 0.01 + 1e-12


@pytest.mark.parametrize("latency", [0.1, 0.25])
def test_latency_shifts_the_motion_in_time(latency: float) -> None:
    prompt = drive(plant(), 0.5, 0.3, 100)
    late = drive(plant(latency=latency), 0.5, 0.3, 100)
    steps = round(latency / 0.01)
    assert (late[:steps] == 0.0).all()
    np.testing.assert_allclose(late[steps:], prompt[:-steps], atol=1e-12)


def test_a_wheel_radius_error_bends_a_straight_line() -> None:
    poses = drive(plant(**IDEAL, left_radius_error=0.01), 0.5, 0.0, 200)
    # omega = (v - 1.01 v) / track
    assert poses[-1, 2] == pytest.approx(-0.01 * 0.5 * 2.0 / CHAIR.track)


def test_a_track_error_scales_the_turn() -> None:
    poses = drive(plant(**IDEAL, track_error=0.05), 0.0, 0.5, 200)
    assert poses[-1, 2] == pytest.approx(1.0 / 1.05)


def test_the_mirrored_command_drives_the_mirrored_motion() -> None:
    options = {"motor_lag": 0.1, "wheel_speed": 0.5}
    left, right = plant(**options), plant(**options)
    flip = np.array([1.0, -1.0, -1.0])
    for v, omega in ((0.4, 0.7), (-0.2, 1.3), (0.6, -0.2)):
        one, other = drive(left, v, omega, 50), drive(right, v, -omega, 50)
        np.testing.assert_allclose(other, one * flip, atol=1e-12)


def test_ticks_count_whole_millimetres_of_rim() -> None:
    chair = plant(**IDEAL, tick=0.002)
    drive(chair, 0.1, 0.0, 50)
    assert chair.ticks == (25, 25) or chair.ticks == (24, 24)  # 50 mm, but for rounding
    drive(chair, -0.1, 0.0, 105)
    assert chair.ticks[0] in (-28, -27)


@given(
    commands=st.lists(
        st.tuples(st.floats(-0.6, 0.6), st.floats(-1.0, 1.0)), min_size=1, max_size=12
    )
)
@settings(deadline=None, max_examples=30)
def test_odometry_is_wrong_by_a_tick_at_most_in_travel_and_heading(
    commands: list[tuple[float, float]],
) -> None:
    chair = plant()
    odometry = EncoderOdometry().start(CHAIR, PlantOptions(), np.zeros(3), np.random.default_rng(0))
    for v, omega in commands:
        drive(chair, v, omega, 20)
        believed = odometry.estimate(chair, 0.02)
        # each wheel's counts are short by up to a tick
        assert abs(believed[2] - chair.pose[2]) <= 0.002 / CHAIR.track + 1e-12
    assert np.hypot(*(believed - chair.pose)[:2]) < 0.05  # twelve coarse arcs of 0.2 s


def test_odometry_of_a_straight_line_is_short_by_less_than_a_tick() -> None:
    chair = plant()
    odometry = EncoderOdometry().start(CHAIR, PlantOptions(), chair.pose, np.random.default_rng(0))
    for _ in range(40):
        pose = drive(chair, 0.37, 0.0, 2)[-1]
        assert 0.0 <= pose[0] - odometry.estimate(chair, 0.02)[0] < 0.002


def test_odometry_does_not_see_slip_or_a_wrong_radius() -> None:
    options = PlantOptions(left_radius_error=0.02, right_radius_error=0.02)
    chair = Plant(CHAIR, np.zeros(3), options, np.random.default_rng(0))
    odometry = EncoderOdometry().start(CHAIR, options, chair.pose, np.random.default_rng(0))
    pose = drive(chair, 0.5, 0.0, 400)[-1]
    assert odometry.estimate(chair, 0.02)[0] == pytest.approx(pose[0] / 1.02, abs=0.002)


def test_odometry_misses_what_unequal_wheels_and_a_wrong_track_do_to_the_heading() -> None:
    bent = PlantOptions(left_radius_error=0.01)
    chair = Plant(CHAIR, np.zeros(3), bent, np.random.default_rng(0))
    odometry = EncoderOdometry().start(CHAIR, bent, chair.pose, np.random.default_rng(0))
    turned = drive(chair, 0.5, 0.0, 200)[-1, 2]
    assert turned == pytest.approx(-0.01 * chair.ticks[0] * 0.002 / CHAIR.track, abs=1e-4)
    assert odometry.estimate(chair, 0.02)[2] == pytest.approx(0.0, abs=0.002 / CHAIR.track)
    wide = PlantOptions(track_error=0.05)
    chair = Plant(CHAIR, np.zeros(3), wide, np.random.default_rng(0))
    odometry = EncoderOdometry().start(CHAIR, wide, chair.pose, np.random.default_rng(0))
    turned = drive(chair, 0.0, 0.5, 400)[-1, 2]
    assert odometry.estimate(chair, 0.02)[2] == pytest.approx(1.05 * turned, abs=0.009)


def test_castors_turn_the_chair_once_after_reversing() -> None:
    flip = CastorFlip(angle=0.05, distance=0.2)
    chair = plant(**IDEAL, castor_flip=flip)
    assert (drive(chair, 0.4, 0.0, 100)[:, 2] == 0.0).all()  # nothing has turned round yet
    back = drive(chair, -0.4, 0.0, 100)[:, 2]
    assert abs(back[-1]) == pytest.approx(0.05, abs=1e-12)
    assert abs(back[24]) == pytest.approx(0.025, abs=1e-9)  # half after half the distance
    assert (back[51:] == back[51]).all()  # done after 0.2 m


def test_slip_is_the_seeds_and_nothing_elses() -> None:
    one, same, other = (drive(plant(seed, slip=0.1), 0.5, 0.2, 100) for seed in (3, 3, 4))
    assert (one == same).all()
    assert not np.allclose(one[-1], other[-1], atol=1e-4)
    assert np.linalg.norm(one[-1] - drive(plant(), 0.5, 0.2, 100)[-1]) > 1e-4


def test_coloured_noise_has_its_deviation_and_its_memory() -> None:
    noise = GaussMarkov(0.5, 0.2, np.random.default_rng(1))
    values = np.array([noise.step(0.05) for _ in range(20000)])
    assert values.std() == pytest.approx(0.5, rel=0.03)  # about 4 sigma of 20000 / 8 draws
    lagged = np.corrcoef(values[:-4], values[4:])[0, 1]
    assert lagged == pytest.approx(math.exp(-1.0), abs=0.04)


def test_noisy_poses_have_the_deviation_asked_for() -> None:
    chair, rng = plant(), np.random.default_rng(5)
    noisy = NoisyPose(0.03, 0.02).start(CHAIR, PlantOptions(), chair.pose, rng)
    seen = np.array([noisy.estimate(chair, 0.02) for _ in range(4000)])
    np.testing.assert_allclose(seen.std(axis=0), [0.03, 0.03, 0.02], rtol=0.05)
    exact = ExactPose().start(CHAIR, PlantOptions(), chair.pose, rng)
    assert (exact.estimate(chair, 0.02) == chair.pose).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"latency": -0.1}, "latency must be a finite number >= 0, got -0.1"),
        ({"tick": 0.0}, "tick must be positive, got 0.0"),
        ({"track_error": 0.7}, "track_error must lie between -0.5 and 0.5, got 0.7"),
    ],
)
def test_senseless_options_are_refused(options: dict[str, float], message: str) -> None:
    with pytest.raises(ShapeError, match=message):
        PlantOptions(**options)  # type: ignore[arg-type]
