"""What the assistant promises, on simulated drives: the true body among true obstacles."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import ShapeError
from narrows.interfaces import Percept
from narrows.reactive.assistant import Assistant
from narrows.reactive.assistant_options import AssistantOptions, AssistantState
from narrows.reactive.assistant_prediction import Prediction
from narrows.reactive.assistant_view import View
from narrows.reactive.avoidance import AvoidanceOptions
from narrows.reactive.door_blend import DoorBlendOptions
from narrows.reactive.safety_regions import RegionOptions, SafetyRegions
from narrows.reactive.smooth_motion import MotionLimits, Smooth, SmoothMotion
from narrows.se2 import compose, invert, transform
from narrows.simulation.plant import Plant, PlantOptions
from narrows.vehicle import Vehicle

LIMITS = MotionLimits()  # those of the chair
PERIOD = 0.02
NOTHING = np.zeros((0, 2))


def random_room(rng, simulated, vehicle):
    """Return points of a closed room full of boxes, and a start that touches none."""
    polygons = [simulated.box(-2.6, 2.6, -2.6, 2.6)]
    for _ in range(rng.integers(2, 10)):
        half = 0.5 * rng.uniform(0.05, 0.6, 2)
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
        polygons.append(transform([*rng.uniform(-2.5, 2.5, 2), rng.uniform(0, 3)], corners))
    points = simulated.outlines(*polygons)
    for _ in range(1000):
        start = np.array([*rng.uniform(-2.0, 2.0, 2), rng.uniform(-math.pi, math.pi)])
        if simulated.gap(vehicle, start, points) > 0.05:
            return points, start
    return random_room(rng, simulated, vehicle)


def wild_driver(rng):
    """Return a driver of sudden whims, from tremor to long pushes; one in three at full stick."""
    hold = rng.choice([0.02, 0.4, 2.0])
    state = {"until": 0.0, "command": (0.0, 0.0)}

    def command(time, pose):
        if time >= state["until"]:
            state["until"] = time + hold * rng.uniform(0.3, 1.7)
            if rng.random() < 0.33:
                state["command"] = (rng.choice([0.8, -0.4]), rng.choice([-1.2, 0.0, 1.2]))
            else:
                turn = rng.uniform(-1.2, 1.2) * (rng.random() < 0.7)
                state["command"] = (rng.uniform(-0.4, 0.8) * (rng.random() < 0.8), turn)
        return state["command"]

    return command


def wild_drive(seed, simulated, vehicle, latency, seconds):
    rng = np.random.default_rng(seed)
    points, start = random_room(rng, simulated, vehicle)
    return simulated.drive(
        wild_driver(rng),
        points,
        assistant=simulated.assistant(AssistantOptions(latency=latency)),
        seconds=seconds,
        start=start,
        plant=PlantOptions(latency=latency),
    )


def check_promises(drive):
    """Check what holds at every step of every drive."""
    asked, taken, full = drive.arrays()
    before = np.vstack([[0.0, 0.0], taken[:-1]])
    rate = np.diff(np.vstack([[0.0, 0.0], before]), axis=0) / PERIOD
    for k in range(len(taken)):
        v, _ = LIMITS.clipped(*asked[k])
        last, now = before[k, 0], taken[k, 0]
        # Never the other way: what moves against the command only rolls out.
        if now * v < 0.0:
            assert abs(now) <= abs(last) + 1e-9 or full[k] or rate[k, 0] * now > 0.0
            assert now * last > 0.0
        elif abs(now) > abs(v) + 1e-9:
            # Faster than asked only on the way down, as fast as smooth motion goes there.
            known = min(max(rate[k, 0], -LIMITS.acceleration), LIMITS.acceleration)
            slowing = Smooth(last, known).towards(v, LIMITS.acceleration, LIMITS.jerk, PERIOD)
            assert abs(now) <= abs(last if full[k] else slowing.value) + 1e-9
    assert taken[:, 0].max() <= LIMITS.speed + 1e-9
    check_jerk(taken, full)


def check_jerk(taken, full):
    """Check acceleration and jerk wherever there was no full braking in the last two steps."""
    rows = np.vstack([np.zeros((3, 2)), taken])
    braked = np.concatenate([[False] * 3, full])
    for column, most, jerk in (
        (0, LIMITS.acceleration, LIMITS.jerk),
        (1, LIMITS.yaw_acceleration, 10.0),
    ):
        value = rows[:, column]
        rate = np.diff(value) / PERIOD
        assert np.abs(rate[~braked[1:]]).max() <= most + 1e-9
        calm = ~(braked[1:-1] | braked[2:] | np.roll(braked, 1)[1:-1])
        calm &= (value[1:-1] != 0.0) & (value[2:] != 0.0)  # coming to rest may be abrupt
        assert np.abs(np.diff(rate))[calm].max(initial=0.0) <= jerk * PERIOD + 1e-9


@given(seed=st.integers(0, 10_000), latency=st.sampled_from([0.0, 0.1, 0.2]))
@settings(deadline=None, max_examples=6, derandomize=True)
def test_wild_commands_keep_every_promise(simulated, xeno, seed, latency):
    drive = wild_drive(seed, simulated, xeno, latency, 3.0)
    assert drive.gap > 0.01  # of the 25 mm that are to be kept, the plant's lag and noise take some
    check_promises(drive)


@pytest.mark.slow
@given(seed=st.integers(0, 1_000_000), latency=st.sampled_from([0.0, 0.1, 0.2]))
@settings(deadline=None, max_examples=40, derandomize=True)
def test_many_wild_commands_keep_every_promise(simulated, xeno, seed, latency):
    drive = wild_drive(seed, simulated, xeno, latency, 6.0)
    assert drive.gap > 0.01
    check_promises(drive)


STEADY = st.one_of(
    st.tuples(st.floats(-0.4, 0.8), st.floats(-1.2, 1.2)),
    st.tuples(st.floats(0.1, 0.25), st.sampled_from([-1.2, 1.2])),  # nearly on the spot
)


@given(command=STEADY, seed=st.integers(0, 1000))
@settings(deadline=None, max_examples=10, derandomize=True)
def test_from_rest_a_steady_command_is_never_exceeded(simulated, xeno, command, seed):
    points, start = random_room(np.random.default_rng(seed), simulated, xeno)
    v, omega = LIMITS.clipped(*command)
    drive = simulated.drive(
        lambda time, pose: (v, omega),
        points,
        assistant=simulated.assistant(AssistantOptions(restores=False)),
        seconds=2.5,
        start=start,
    )
    _, taken, _ = drive.arrays()
    assert np.abs(taken[:, 0]).max() <= abs(v) + 1e-9
    assert (taken[:, 0] * v >= 0.0).all()


@pytest.mark.parametrize("far", [False, True])
def test_the_user_has_full_control_where_nothing_is_near(simulated, far):
    rng = np.random.default_rng(5)
    driver = wild_driver(rng)
    points = simulated.outlines(simulated.box(40.0, 41.0, 0.0, 1.0)) if far else NOTHING
    drive = simulated.drive(driver, points, assistant=simulated.assistant(), seconds=5.0)
    asked, taken, full = drive.arrays()
    alone = SmoothMotion(LIMITS)
    assert np.array_equal(taken, [alone.step(command) for command in asked])
    assert not full.any()
    assert {row["state"] for row in drive.signals} == {float(AssistantState.FULL_USER_CONTROL)}


def test_who_heads_straight_for_a_wall_gets_there_and_is_not_steered(simulated):
    wall = simulated.outlines(simulated.box(2.0, 2.1, -2.0, 2.0))
    drive = simulated.drive(
        lambda time, pose: (0.8, 0.0), wall, assistant=simulated.assistant(), seconds=6.0
    )
    _, taken, _ = drive.arrays()
    assert np.abs(taken[:, 1]).max() < 1e-9
    assert taken[-1].tolist() == [0.0, 0.0]
    # 25 mm are kept; a cell of 30 mm and its twin at low speed may stand in the way.
    assert 0.02 < drive.gap < 0.08
    assert drive.signals[-1]["state"] == AssistantState.BRAKING


def passing(simulated, indicated, **options):
    """Drive past a post ahead on the right with a bend to the left indicated."""
    post = simulated.outlines(simulated.box(2.1, 2.2, -0.35, 0.1))
    return simulated.drive(
        indicated,
        post,
        assistant=simulated.assistant(AssistantOptions(**options)),
        seconds=9.0,
    )


def test_an_obstacle_is_passed_on_the_side_indicated_and_the_orientation_restored(simulated):
    bend = 0.1
    drive = passing(simulated, lambda time, pose: (0.5, bend))
    states = [row["state"] for row in drive.signals]
    avoided = states.index(AssistantState.OBSTACLE_AVOIDANCE)
    _, taken, _ = drive.arrays()
    assert taken[avoided : avoided + 80, 1].max() > 3.0 * bend
    assert drive.poses[-1][0] > 2.5
    assert AssistantState.RESTORING_ORIENTATION in states[avoided:]
    # The user's own way turns by omega / v for each metre driven.
    way = float(np.abs(taken[avoided:, 0]).sum() * PERIOD)
    turned = drive.poses[-1][2] - drive.poses[avoided][2]
    assert turned == pytest.approx(bend / 0.5 * way, abs=math.radians(4.0))
    assert states[-1] == AssistantState.FULL_USER_CONTROL


def test_nothing_is_restored_for_a_user_who_moves_the_stick(simulated):
    def driver(time, pose):
        return (0.5, 0.1) if pose[0] < 1.0 else (0.3, 0.1)

    drive = passing(simulated, driver)
    states = [row["state"] for row in drive.signals]
    after = next(k for k, pose in enumerate(drive.poses) if pose[0] >= 1.0)
    if AssistantState.OBSTACLE_AVOIDANCE not in states[after:]:
        assert AssistantState.RESTORING_ORIENTATION not in states[after:]


def test_without_steering_only_the_speed_is_limited(simulated):
    drive = passing(simulated, lambda time, pose: (0.5, 0.1), steers=False)
    _, taken, _ = drive.arrays()
    moving = taken[:, 0] > 0.05
    assert np.abs(taken[moving, 1]).max() < 0.1 + 1e-9
    assert drive.gap > 0.01


def test_a_chair_between_the_posts_of_a_door_drives_on(simulated):
    posts = (simulated.box(1.5, 1.6, -2.0, -0.4), simulated.box(1.5, 1.6, 0.4, 2.0))
    drive = simulated.drive(
        lambda time, pose: (0.8, -1.5 * pose[1] - 0.8 * pose[2]),
        simulated.outlines(*posts),
        assistant=simulated.assistant(),
        seconds=8.0,
        start=(0.0, 0.03, 0.0),
    )
    assert drive.poses[-1][0] > 2.0
    assert drive.gap > 0.02


SPOILT = {
    "missing": lambda time, rows: None,
    "not a number": lambda time, rows: Percept(time, np.vstack([rows, [[math.nan] * 3]])),
    "infinite": lambda time, rows: Percept(time, np.array([[math.inf, 0.0, 0.1]])),
    "from the future": lambda time, rows: Percept(time + 1.0, rows),
    "never": lambda time, rows: Percept(-math.inf, rows),
    "too old": lambda time, rows: Percept(time - 0.7, rows),
    "no spread": lambda time, rows: Percept(time, rows, math.nan),
}


@pytest.mark.parametrize("fault", SPOILT)
def test_a_chair_that_perceives_nothing_of_use_stops_before_what_it_saw(simulated, fault):
    def percept(time, rows):
        return SPOILT[fault](time, rows) if time > 1.6 else Percept(time, rows, 0.015)

    wall = simulated.outlines(simulated.box(2.1, 2.2, -2.0, 2.0))
    drive = simulated.drive(
        lambda time, pose: (0.8, 0.0),
        wall,
        assistant=simulated.assistant(),
        seconds=4.5,
        percept=percept,
    )
    _, taken, _ = drive.arrays()
    assert taken[80, 0] > 0.3
    assert (np.diff(taken[81:, 0]) <= 1e-12).all()
    assert (taken[-20:] == 0.0).all()
    assert drive.gap > 0.02
    assert drive.signals[-1]["trust"] == 0.0


def test_a_chair_that_never_saw_anything_never_moves(simulated):
    drive = simulated.drive(
        lambda time, pose: (0.8, 0.5),
        NOTHING,
        assistant=simulated.assistant(),
        seconds=0.5,
        percept=lambda time, rows: None,
    )
    assert (drive.arrays()[1] == 0.0).all()


def test_the_older_the_percept_the_slower_the_chair(simulated):
    def fastest(age):
        drive = simulated.drive(
            lambda time, pose: (0.8, 0.0),
            NOTHING,
            assistant=simulated.assistant(),
            seconds=3.0,
            percept=lambda time, rows: Percept(time - age, rows),
        )
        return drive.arrays()[1][:, 0].max()

    assert fastest(0.25) == pytest.approx(0.8)
    assert fastest(0.425) == pytest.approx(0.4, abs=0.01)  # half-way from 0.25 s to 0.6 s
    assert fastest(0.6) == 0.0


def test_what_appears_all_of_a_sudden_is_braked_for_fully(simulated):
    # Half a metre ahead at 0.8 m/s: full braking needs 0.4 m, a comfortable one 0.7 m.
    wall = simulated.outlines(simulated.box(2.5, 2.6, -1.0, 1.0))
    seen = []

    def percept(time, rows):
        is_near = len(rows) > 0 and rows[:, 0].min() < 0.85 + 0.55
        seen.append(is_near or any(seen[-1:]))
        return Percept(time, rows if seen[-1] else rows[:0], 0.015)

    drive = simulated.drive(
        lambda time, pose: (0.8, 0.0),
        wall,
        assistant=simulated.assistant(),
        seconds=5.0,
        percept=percept,
    )
    _, taken, full = drive.arrays()
    assert taken[:, 0].max() == pytest.approx(0.8)
    assert full.sum() > 5
    assert drive.gap > 0.0
    assert np.abs(taken[:, 1]).max() < 1e-9


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


def test_what_was_seen_last_is_carried_along_by_the_chair_s_motion():
    view = View(0.25, 0.6)
    points = np.array([[1.0, 0.5, 0.1], [2.0, -1.0, 0.2]])
    view.update(0.0, Percept(0.0, points, 0.02, points[:, :2]), np.zeros(3))
    moved = np.array([0.3, 0.1, 0.4])
    view.update(0.02, None, moved)
    assert view.trust == 0.0
    assert view.points[:, :2] == pytest.approx(transform(invert(moved), points[:, :2]))
    assert view.unknown == pytest.approx(view.points[:, :2])
    assert view.points[:, 2] == pytest.approx(points[:, 2])


def test_it_stops_before_places_it_knows_nothing_of(simulated):
    places = simulated.outlines(simulated.box(2.0, 2.5, -2.0, 2.0))

    def drive(**options):
        def percept(time, rows):
            return Percept(time, np.zeros((0, 3)), 0.015, rows[:, :2])

        return simulated.drive(
            lambda time, pose: (0.8, 0.0),
            places,
            assistant=simulated.assistant(AssistantOptions(**options)),
            seconds=7.0,
            percept=percept,
        )

    assert drive().gap > 0.02
    for speed in (0.1, 0.3):
        feeling = drive(unknown_speed=speed)
        assert feeling.gap < 0.0
        taken = feeling.arrays()[1][:, 0]
        inside = [taken[k] for k, pose in enumerate(feeling.poses) if 1.2 < pose[0] < 1.5]
        assert np.array(inside) == pytest.approx(speed, abs=1e-6)


def test_what_reaches_far_beyond_its_points_is_kept_further_off(simulated):
    wall = simulated.outlines(simulated.box(2.0, 2.1, -2.0, 2.0))
    drive = simulated.drive(
        lambda time, pose: (0.8, 0.0),
        wall,
        assistant=simulated.assistant(),
        seconds=6.0,
        percept=lambda time, rows: Percept(time, rows, 0.08),  # the regions allow for 15 mm
    )
    assert 0.08 < drive.gap < 0.15


def test_a_chair_set_down_on_unknown_ground_may_leave_it(simulated):
    places = simulated.outlines(simulated.box(-0.2, 0.8, -0.3, 0.3), step=0.1)
    drive = simulated.drive(
        lambda time, pose: (0.5, 0.0),
        NOTHING,
        assistant=simulated.assistant(),
        seconds=2.0,
        percept=lambda time, rows: Percept(time, rows, 0.015, places),
    )
    assert drive.poses[-1][0] > 0.3


def test_a_chair_beside_a_wall_may_creep_along_it_but_not_into_it(simulated, xeno):
    # 8 mm: less than the margin of 10 mm, more than the quarter of it that creeping needs.
    wall = simulated.outlines(simulated.box(-1.0, 2.0, 0.338, 0.4))

    def end(v, omega):
        drive = simulated.drive(
            lambda time, pose: (v, omega),
            wall,
            assistant=simulated.assistant(),
            seconds=3.0,
            percept=lambda time, rows: Percept(time, rows, 0.0),
        )
        assert drive.gap > 0.002
        return drive.poses[-1]

    assert end(0.4, 0.0)[0] > 0.05
    assert end(-0.4, 0.0)[0] < -0.05
    assert abs(end(0.0, 0.8)[2]) < 0.02  # front into it
    assert abs(end(0.0, -0.8)[2]) < 0.03  # rear into it


def test_what_hangs_above_the_chair_is_passed_under(simulated, xeno):
    wall = simulated.outlines(simulated.box(1.5, 1.6, -1.0, 1.0))

    def percept(time, rows):
        return Percept(time, np.column_stack([rows[:, :2], np.full(len(rows), 2.0)]), 0.015)

    drive = simulated.drive(
        lambda time, pose: (0.8, 0.0),
        wall,
        assistant=simulated.assistant(),
        seconds=3.0,
        percept=percept,
    )
    assert drive.poses[-1][0] > 1.5
    assert xeno.height < 2.0


def test_a_chair_that_runs_faster_than_told_is_braked_fully(simulated):
    assistant = simulated.assistant()
    wall = np.column_stack([np.full(40, 1.2), np.linspace(-0.5, 0.5, 40), np.full(40, 0.1)])
    for k in range(30):
        assistant.step(0.02 * k, [0.2, 0.0], [0.1, 0.0], Percept(0.02 * k, wall, 0.015))
    assistant.step(0.6, [0.2, 0.0], [0.8, 0.0], Percept(0.6, wall, 0.015))
    assert assistant.signals["full_braking"] == 1.0


def test_more_points_than_can_be_looked_at_stop_the_chair(simulated):
    assistant = simulated.assistant()
    rng = np.random.default_rng(0)
    crowd = np.column_stack([rng.uniform(-2.0, 2.0, (200_000, 2)), np.full(200_000, 0.1)])
    for k in range(5):
        taken = assistant.step(0.02 * k, [0.8, 0.0], [0.0, 0.0], Percept(0.02 * k, crowd))
    assert taken.tolist() == [0.0, 0.0]


def test_a_motion_that_is_not_known_stops_the_chair(simulated):
    assistant = simulated.assistant()
    for k in range(150):
        motion = [math.nan, 0.0] if k > 40 else [0.0, 0.0]
        taken = assistant.step(0.02 * k, [0.8, 0.0], motion, Percept(0.02 * k, np.zeros((0, 3))))
        if k == 40:
            assert taken[0] > 0.2
    assert taken[0] == 0.0


def test_steps_are_the_same_in_the_mirror(simulated):
    points = simulated.outlines(simulated.box(1.3, 1.5, 0.1, 0.8))
    ends = []
    for side in (1.0, -1.0):
        drive = simulated.drive(
            lambda time, pose, side=side: (0.5, -0.1 * side),
            points * [1.0, side],
            assistant=simulated.assistant(),
            seconds=3.0,
        )
        ends.append(drive.poses[-1] * [1.0, side, side])
    assert ends[0] == pytest.approx(ends[1], abs=0.02)  # cells lie on one side of their edges


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
