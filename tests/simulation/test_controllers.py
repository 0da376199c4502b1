"""Controllers drive by what they perceive, and what they tell of themselves is on record."""

import math
from dataclasses import replace

import numpy as np
import pytest

from narrows.errors import ShapeError, TrajectoryError
from narrows.formats import read_trajectory
from narrows.interfaces import Percept
from narrows.scene import Goal, Scene
from narrows.simulation.judge import judge
from narrows.simulation.localisation import EncoderOdometry
from narrows.simulation.plant import PlantOptions
from narrows.simulation.record import RECORD_COLUMNS, read_record, write_record
from narrows.simulation.senses import IdealSenses
from narrows.simulation.simulator import SimulationOptions, simulate
from narrows.vehicle import Vehicle
from narrows.world import MovingSolid, Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.6, 0.3)
FRONT = 0.7
WALL = Solid.polygon([[2, -1], [2.2, -1], [2.2, 1], [2, 1]], name="wall")


class Halting:
    """Drives straight on until something is near ahead; has arrived at a distance."""

    def __init__(self, goal: float = 9.0, keep: float = 0.3) -> None:
        """Take the distance at which it has arrived and the gap it keeps [m]."""
        self.progress, self.finished = 0.0, False
        self.signals: dict[str, float] = {}
        self.percepts: list[tuple[float, np.ndarray, Percept]] = []
        self._goal, self._keep = goal, keep

    def step(self, time, pose, percept):
        self.percepts.append((time, pose, percept))
        gap = math.inf
        if len(percept.points):
            ahead = percept.points[np.abs(percept.points[:, 1]) < 0.4, 0]
            gap = float(ahead[ahead > FRONT].min(initial=math.inf)) - FRONT
        self.progress = max(self.progress, float(pose[0]))
        self.finished = self.progress > self._goal
        self.signals = {"gap": gap, "blocked": float(gap < self._keep)}
        v = 0.0 if gap < self._keep or self.finished else 0.4
        return np.array([v, 0.0])


def scene(*solids: Solid, moving: tuple[MovingSolid, ...] = (), goal: float = 1.0) -> Scene:
    return Scene(CHAIR, World(solids, moving=moving), np.zeros(3), Goal(np.array([goal, 0, 0])))


def drive(place: Scene, controller: Halting, time_limit: float = 6.0, **options):
    chosen = SimulationOptions(time_limit=time_limit, **options)
    return simulate(place, controller, senses=IdealSenses(place.world), options=chosen)


def test_a_controller_stops_before_what_it_perceives():
    place = scene(WALL)
    record = drive(place, Halting())
    verdict = judge(place, record)
    assert verdict.collisions == ()
    assert verdict.reached, verdict.reason  # it stands 0.3 m before the wall, at x = 1.0
    assert record.poses[-1, 0] == pytest.approx(1.0, abs=0.05)
    assert not record.has_reference


def test_signals_are_held_for_a_period_and_told_of_every_row():
    record = drive(scene(WALL), Halting())
    assert list(record.signals) == ["gap", "blocked"]
    gap = record.signals["gap"]
    assert gap.shape == record.times.shape
    np.testing.assert_array_equal(gap[:-1:2], gap[1::2][: len(gap[:-1:2])])  # 0.02 s of 0.01 s
    np.testing.assert_allclose(gap[::2], 2.0 - FRONT - record.poses[::2, 0], atol=1e-9)
    assert record.signals["blocked"][-1] == 1.0


def test_percepts_are_of_the_true_pose_whatever_is_believed():
    """A chair with worn tyres still stops before the wall, and believes to be past it."""
    place, controller = scene(WALL), Halting()
    plant = PlantOptions(left_radius_error=-0.02, right_radius_error=-0.02)
    record = drive(place, controller, plant=plant, localisation=EncoderOdometry())
    assert judge(place, record).reached
    assert record.estimates[-1, 0] == pytest.approx(record.poses[-1, 0] / 0.98, abs=5e-3)
    times = [time for time, _, _ in controller.percepts]
    np.testing.assert_allclose(times, 0.02 * np.arange(len(times)), atol=1e-12)


def test_a_controller_that_has_finished_ends_the_drive():
    record = drive(scene(), Halting(goal=0.5), time_limit=60.0)
    assert record.poses[-1, 0] == pytest.approx(0.5, abs=0.05)
    assert np.isinf(record.signals["gap"]).all()


def test_signals_that_change_their_names_are_refused():
    controller = Halting()
    step = controller.step

    def changing(time, pose, percept):
        command = step(time, pose, percept)
        if time > 0.1:
            controller.signals = {"other": 1.0}
        return command

    controller.step = changing  # type: ignore[method-assign]
    with pytest.raises(ShapeError, match=r"keep their names \('gap', 'blocked'\)"):
        drive(scene(), controller)


def test_a_record_with_signals_is_written_read_and_still_a_motion(tmp_path):
    record = drive(scene(WALL), Halting())
    record = replace(record, signals={**record.signals, "none": np.full(len(record.times), np.nan)})
    file = tmp_path / "record.csv"
    write_record(record, file)
    assert file.read_text().splitlines()[0] == ",".join(RECORD_COLUMNS) + ",gap,blocked,none"
    again = read_record(file)
    for name, values in record.signals.items():
        np.testing.assert_allclose(again.signals[name], values, atol=1e-10)
    np.testing.assert_allclose(again.poses, record.poses, atol=1e-10)
    assert read_trajectory(file).duration == pytest.approx(record.duration)


def test_a_record_without_signals_has_the_columns_it_always_had(tmp_path):
    record = replace(drive(scene(WALL), Halting()), signals={})
    write_record(record, tmp_path / "old.csv")
    assert (tmp_path / "old.csv").read_text().splitlines()[0] == ",".join(RECORD_COLUMNS)
    assert dict(read_record(tmp_path / "old.csv").signals) == {}


@pytest.mark.parametrize("name", ["x", "v_left", "two words", "a,b", ""])
def test_signals_need_names_of_their_own(name):
    record = drive(scene(), Halting(goal=0.2))
    with pytest.raises(ShapeError, match="a name of its own"):
        replace(record, signals={name: record.times})
    with pytest.raises(ShapeError, match="must have shape"):
        replace(record, signals={"gap": record.times[:-1]})


def test_a_signal_that_would_be_taken_for_the_heading_is_not_written(tmp_path):
    record = replace(drive(scene(), Halting(goal=0.2)))
    with pytest.raises(TrajectoryError, match="twice"):
        write_record(replace(record, signals={"yaw": record.times}), tmp_path / "r.csv")


def test_a_signal_told_twice_or_no_number_is_refused(tmp_path):
    record = drive(scene(), Halting(goal=0.2))
    file = tmp_path / "record.csv"
    write_record(record, file)
    text = file.read_text()
    file.write_text(text.replace("gap,blocked", "gap,gap"))
    with pytest.raises(TrajectoryError, match="twice"):
        read_record(file)
    file.write_text(text.replace("inf", "much"))
    with pytest.raises(TrajectoryError, match="not a number"):
        read_record(file)


def test_somebody_who_walks_into_the_standing_chair_is_no_collision_of_its():
    passer = MovingSolid(0.2, np.array([[4.5, 1.2, 2.0], [6.0, 1.2, -2.0]]), name="passer")
    place = scene(WALL, moving=(passer,))
    record = drive(place, Halting(), time_limit=9.0)
    verdict = judge(place, record)
    assert verdict.collisions == ()
    assert len(verdict.walked_into) == 1
    assert verdict.figures()["collisions"] == 0
    assert verdict.reached
    assert "walked into the standing chair" in verdict.reason
    assert verdict.min_clearance < 0.0
