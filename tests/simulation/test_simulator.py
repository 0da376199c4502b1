"""Drives from end to end: judged on the truth, recorded, reproducible."""

import math
from dataclasses import replace
from pathlib import Path as FilePath

import numpy as np
import pytest

from narrows.clearance import certify
from narrows.errors import ShapeError, TrajectoryError
from narrows.formats import read_trajectory
from narrows.path import Path
from narrows.planners.timing import time_path
from narrows.scene import Goal, Scene
from narrows.se2 import Array, compose
from narrows.simulation.judge import judge
from narrows.simulation.localisation import EncoderOdometry, NoisyPose
from narrows.simulation.plant import PlantOptions
from narrows.simulation.record import RECORD_COLUMNS, Record, read_record, write_record
from narrows.simulation.simulator import SimulationOptions, reference_errors, simulate
from narrows.tracking.lookahead import LookaheadTracker
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

CHAIR = Vehicle.rectangle(1.0, 0.6, 0.3)
BEND = Path.from_poses([[0, 0, 0], [1.5, 0, 0], [2.5, 1.0, math.pi / 2], [2.5, 1.8, math.pi / 2]])
SHUNT = Path.from_poses([[0, 0, 0], [1.5, 0, 0], [0.7, -0.3, 0.7174], [1.7, 0.5726, 0.7174]])
DISTURBED = SimulationOptions(
    plant=PlantOptions(slip=0.03, latency=0.1, left_radius_error=0.005),
    localisation=NoisyPose(0.01, math.radians(0.5)),
)


def scene(path: Path, *solids: Solid) -> Scene:
    return Scene(CHAIR, World(solids), path.start, Goal(path.goal))


def driven(path: Path, *solids: Solid, seed: int = 0, **changes: object) -> tuple[Scene, Record]:
    options = changes.pop("options", SimulationOptions())
    place, trajectory = scene(path, *solids), time_path(path, CHAIR)
    tracker = LookaheadTracker(trajectory, CHAIR)
    rng = np.random.default_rng(seed)
    return place, simulate(
        place,
        tracker,
        reference=trajectory,
        options=options,
        rng=rng,
        **changes,  # type: ignore[arg-type]
    )


@pytest.mark.parametrize("path", [BEND, SHUNT])
def test_a_nominal_drive_reaches_the_goal_within_millimetres_of_the_path(path: Path) -> None:
    judgement = judge(*driven(path))
    assert judgement.reached, judgement.reason
    assert judgement.contacts == ()
    assert judgement.max_cross_track_error is not None
    assert judgement.max_cross_track_error < 3e-3
    assert judgement.final_position_error < 3e-3
    assert judgement.length == pytest.approx(path.length, abs=5e-3)
    assert judgement.peak_acceleration <= 1.1 * CHAIR.limits.acceleration
    assert judgement.peak_jerk <= 1.5 * CHAIR.limits.jerk


def test_a_judgement_has_the_contracts_figures_in_their_order() -> None:
    figures = judge(*driven(BEND)).figures()
    assert list(figures) == [
        "reached",
        "collisions",
        "min_clearance_m",
        "max_cross_track_error_m",
        "final_position_error_m",
        "final_heading_error_deg",
        "duration_s",
        "length_m",
    ]
    assert figures["min_clearance_m"] is None  # an empty world: JSON has no infinity
    assert figures["collisions"] == 0


def test_the_clearance_is_the_certificates() -> None:
    wall = Solid.polygon([[-1, -0.5], [3, -0.5], [3, -0.4], [-1, -0.4]], name="wall")
    judgement = judge(*driven(BEND, wall))
    # before the bend 0.1 m; in it the rear right corner swings out: R = hypot(1.3, 0.3)
    swing = math.hypot(1.3, 0.3) - 1.0 - 0.3
    assert judgement.reached
    assert judgement.min_clearance == pytest.approx(0.1 - swing, abs=2e-3)


def test_nothing_is_reached_through_a_wall() -> None:
    sheet = Solid.polygon([[2, 1.999], [3, 1.999], [3, 2.001], [2, 2.001]], name="sheet")
    judgement = judge(*driven(BEND, sheet))
    assert not judgement.reached
    assert len(judgement.contacts) == 1
    assert judgement.final_position_error < 3e-3  # it is there, and still has not reached it
    assert judgement.figures()["collisions"] == 1
    assert "sheet" in judgement.reason


def test_time_up_on_the_way_is_not_reached() -> None:
    judgement = judge(*driven(BEND, options=SimulationOptions(time_limit=3.0)))
    assert not judgement.reached
    assert "from the goal" in judgement.reason


def test_rolling_over_the_goal_is_not_reached() -> None:
    place, record = driven(BEND)
    rolling = np.array(record.wheel_speeds)
    rolling[-1] = 0.1
    judgement = judge(place, replace(record, wheel_speeds=rolling))
    assert not judgement.reached
    assert "moving" in judgement.reason


@pytest.mark.parametrize("path", [BEND, SHUNT])
def test_the_same_seed_drives_the_same_and_another_does_not(path: Path) -> None:
    records = [driven(path, seed=seed, options=DISTURBED)[1] for seed in (7, 7, 8)]
    assert (records[0].poses == records[1].poses).all()
    assert len(records[0].times) != len(records[2].times) or not np.allclose(
        records[0].poses, records[2].poses, atol=1e-6
    )


def test_disturbances_cost_millimetres_to_centimetres() -> None:
    calm, rough = judge(*driven(BEND)), judge(*driven(BEND, options=DISTURBED))
    assert calm.max_cross_track_error is not None
    assert rough.max_cross_track_error is not None
    assert 5 * calm.max_cross_track_error < rough.max_cross_track_error < 0.06


def test_dead_reckoning_drifts_where_the_wheels_differ() -> None:
    plant = PlantOptions(left_radius_error=0.01)
    options = SimulationOptions(plant=plant, localisation=EncoderOdometry())
    place, record = driven(BEND, options=options)
    believed = np.linalg.norm(record.estimates[-1, :2] - BEND.goal[:2])
    assert believed < 5e-3  # it thinks that it has arrived
    assert judge(place, record).final_position_error > 0.02


def test_mirrored_scenes_are_driven_mirrored() -> None:
    flip = np.array([1.0, -1.0, -1.0])
    poses = np.array([BEND(s) for s in np.linspace(0, BEND.span, 40)])
    _, one = driven(Path.from_poses(poses))
    _, other = driven(Path.from_poses(poses * flip))
    np.testing.assert_allclose(other.poses, one.poses * flip, atol=1e-9)
    np.testing.assert_allclose(other.cross_track, -one.cross_track, atol=1e-9)


def test_errors_of_a_shifted_copy_are_the_shift() -> None:
    s = np.linspace(0.0, BEND.span, 100)
    aside = compose(BEND(s), [0.0, -0.05, 0.1])  # to the right, so that the path lies left
    across, heading = reference_errors(BEND, aside, s)
    np.testing.assert_allclose(across, 0.05, atol=1e-5)
    np.testing.assert_allclose(heading, -0.1, atol=1e-3)  # the foot sticks to 2 mm rows
    turn = Path.from_poses([[0, 0, 3.0], [0, 0, 4.5]])
    across, heading = reference_errors(turn, np.array([[0.03, 0.04, 4.6], [0, 0, 3.5]]), s[:2])
    np.testing.assert_allclose(across, [0.05, 0.0], atol=1e-12)
    np.testing.assert_allclose(heading, [-0.1, 0.0], atol=1e-9)


class Spinner:
    """A controller without a reference: turns on the spot for a second."""

    progress = 0.0
    finished = False

    def step(self, time: float, pose: Array) -> Array:
        """Turn, then stop."""
        self.finished = time > 1.0
        return np.array([0.0, 0.0 if self.finished else 0.5])


def test_a_drive_without_a_reference_has_no_tracking_errors(tmp_path: FilePath) -> None:
    place = Scene(CHAIR, World(), np.zeros(3), Goal(np.array([0.0, 0.0, 0.51])))
    record = simulate(place, Spinner())
    judgement = judge(place, record)
    assert judgement.reached, judgement.reason
    assert judgement.max_cross_track_error is None
    assert judgement.length == pytest.approx(0.0, abs=1e-12)
    write_record(record, tmp_path / "spin.csv")
    assert not read_record(tmp_path / "spin.csv").has_reference


def test_a_record_survives_its_file(tmp_path: FilePath) -> None:
    place, record = driven(SHUNT, options=DISTURBED)
    file = tmp_path / "drive.csv"
    write_record(record, file)
    again = read_record(file)
    assert file.read_text().splitlines()[0] == ",".join(RECORD_COLUMNS)
    for name in ("times", "poses", "estimates", "commands", "wheel_speeds", "cross_track"):
        np.testing.assert_allclose(getattr(again, name), getattr(record, name), atol=1e-10)
    one, other = judge(place, record), judge(place, again)
    assert other.reached == one.reached
    assert other.final_position_error == pytest.approx(one.final_position_error, abs=1e-9)


def test_a_record_is_a_trajectory_file_that_verifies_alike(tmp_path: FilePath) -> None:
    wall = Solid.polygon([[-1, -0.5], [3, -0.5], [3, -0.4], [-1, -0.4]], name="wall")
    place, record = driven(BEND, wall)
    write_record(record, tmp_path / "drive.csv")
    motion = read_trajectory(tmp_path / "drive.csv")
    assert isinstance(motion, Trajectory)
    certificate = certify(place.world, CHAIR, motion)
    assert certificate.clearance == pytest.approx(judge(place, record).min_clearance, abs=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,x\n1,2\n", "no record of a drive"),
        (",".join(RECORD_COLUMNS) + "\n1,2\n", "differ in length"),
        (",".join(RECORD_COLUMNS) + "\n" + ",".join(["0"] * 13 + ["much"]) + "\n", "not a number"),
        (",".join(RECORD_COLUMNS) + "\n", "the rows are no drive"),
    ],
)
def test_a_broken_record_is_an_error_that_says_where(
    tmp_path: FilePath, text: str, message: str
) -> None:
    file = tmp_path / "broken.csv"
    file.write_text(text)
    with pytest.raises(TrajectoryError, match=message) as caught:
        read_record(file)
    assert "broken.csv" in str(caught.value)


def test_progress_is_reported_up_to_one() -> None:
    shares: list[float] = []
    driven(BEND, report=shares.append)
    assert shares == sorted(shares)
    assert shares[0] == 0.0
    assert shares[-1] == 1.0


def test_senseless_times_are_refused() -> None:
    with pytest.raises(ShapeError, match="multiple of step"):
        SimulationOptions(step=0.01, period=0.025)
    with pytest.raises(ShapeError, match="time_limit must be a finite positive number"):
        SimulationOptions(time_limit=0.0)
