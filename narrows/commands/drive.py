"""`narrows drive`: plan, track in the simulator, record, judge."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

from ..errors import InputError, ShapeError
from ..files import check_can_be_written
from ..formats import check_suffix, read_trajectory, write_trajectory
from ..interfaces import Plan
from ..path import Path
from ..scene import Scene, load_scene
from ..simulation.contacts import certify_drive
from ..simulation.judge import Judgement, judge
from ..simulation.record import Record, write_record
from ..simulation.simulator import simulate
from ..tracking.registry import make_tracker, tracker_names
from ..trajectory import Trajectory
from ..verification import verify
from .controllers import Fitted, check_controller, make_controller
from .outcome import NOT_FOUND, OK, Outcome, lines, millimetres
from .plan import check_picture, describe_plan, exit_code


@dataclass(frozen=True)
class DriveFiles:
    """Where a drive's results go; None: nowhere.

    Attributes:
        trajectory: The trajectory planned, .csv or .json.
        record: The drive in rows, .csv.
        picture: .png or .svg.
    """

    trajectory: str | None = None
    record: str | None = None
    picture: str | None = None

    def check(self) -> None:
        """Say early that one of them cannot be written."""
        if self.trajectory is not None:
            check_suffix(self.trajectory)
        if self.record is not None and not self.record.lower().endswith(".csv"):
            raise InputError("records are written as CSV", file=self.record, allowed=".csv")
        for file in (self.trajectory, self.record):
            if file is not None:
                check_can_be_written(file)
        check_picture(self.picture)

    @property
    def named(self) -> str:
        """The files there are, for people."""
        return ", ".join(f for f in (self.trajectory, self.record, self.picture) if f is not None)


def run_drive(
    scene_file: str,
    *,
    tracker: str,
    planner: str,
    given: str | None,
    files: DriveFiles,
    controller: str | None = None,
    driver: str | None = None,
    regions: str | None = None,
    senses: str | None = None,
    silent_from: float | None = None,
    report: Callable[[float], None] | None = None,
) -> Outcome:
    """Plan a scene or take a given trajectory, drive it in the simulator, judge the drive.

    Args:
        scene_file: The scene.
        tracker: One of `tracker_names()`.
        planner: The planner's name, as for `narrows plan`.
        given: A trajectory to drive instead of planning one.
        files: Where results go.
        controller: One of `controller_names()`, which perceives and may stop; None: the tracker
            alone drives, blind.
        driver: Who sits in the chair, with the assistant; None: the steady one.
        regions: File of the chair's safety regions, for the assistant.
        senses: What the navigator perceives with, one of `senses_names()`; None: "ideal".
        silent_from: When the navigator's senses fall silent for good [s]; None: never.
        report: Called with the share of the drive that is done.
    """
    _check_options(tracker, controller, given, files)
    _check_belongings(
        controller,
        {
            "assistant": {"--driver": driver, "--regions": regions},
            "navigator": {"--senses": senses, "--silent-from": silent_from},
        },
    )
    files.check()
    scene = load_scene(scene_file)
    notes: list[str] = []
    if given is None:
        from ..planners import plan

        planned = plan(_foreseen(scene, controller), planner=planner)
        if planned.trajectory is None:
            return _not_planned(scene, planned, files)
        motion: Path | Trajectory = planned.trajectory
        head = describe_plan(scene, planned)
        if files.trajectory is not None:
            write_trajectory(planned.trajectory, files.trajectory, vehicle=scene.vehicle)
    else:
        motion, head, notes = _given(scene, scene_file, given)
    if controller is None:
        follower = make_tracker(tracker, motion, scene.vehicle)
        record = simulate(scene, follower, reference=motion, report=report)
    else:
        make = partial(make_controller, controller, scene, motion, tracker=tracker)
        make = partial(make, driver=driver or "steady", regions=regions)
        make = partial(make, senses="ideal" if senses is None else senses)
        make = partial(make, silent_from=math.inf if silent_from is None else silent_from)
        record, said = _watched(scene, motion, make, report)
        head = lines(head, (controller, said))
    return _judged(scene, motion, record, files, head, notes)


def _check_options(
    tracker: str,
    controller: str | None,
    given: str | None,
    files: DriveFiles,
) -> None:
    """Say early that there is nobody of a name, or that options do not go together."""
    if tracker not in tracker_names():
        allowed = ", ".join(tracker_names())
        raise InputError(
            "there is no such tracker", field="--tracker", value=tracker, allowed=allowed
        )
    if given is not None and files.trajectory is not None:
        raise InputError("--save-trajectory saves what is planned; leave it out with --trajectory")
    if controller is not None:
        check_controller(controller)


def _check_belongings(
    controller: str | None, belongings: Mapping[str, Mapping[str, str | float | None]]
) -> None:
    """Say early that an option belongs to another controller."""
    for owner, options in belongings.items():
        for option, value in options.items():
            if value is not None and controller != owner:
                raise InputError(f"{option} belongs to --controller {owner}", value=value)


def _given(scene: Scene, scene_file: str, file: str) -> tuple[Path | Trajectory, str, list[str]]:
    """Return a motion from a file, what to call it, and what is to be said of it."""
    motion = read_trajectory(file)
    found = verify(scene, motion)
    head = f"{scene.name or scene_file}: {file}, {found.status}"
    if found.problems:
        return motion, head, [f"{file} is {found.status}: {found.reason}"]
    return motion, head, [f"{file}: {note}" for note in found.notes]


def _watched(
    scene: Scene,
    motion: Path | Trajectory,
    make: Callable[..., Fitted],
    report: Callable[[float], None] | None,
) -> tuple[Record, str]:
    """Return the record of a controller's drive, and what it has to say of it."""
    prepared = 0.0  # share of the progress bar that preparations took

    def preparing(share: float) -> None:
        nonlocal prepared
        prepared = 0.5 * share
        if report is not None:
            report(prepared)

    def driving(share: float) -> None:
        if report is not None:
            report(prepared + (1.0 - prepared) * share)

    fitted = make(report=preparing)
    record = simulate(
        scene,
        fitted.controller,
        senses=fitted.senses,
        reference=motion if fitted.follows else None,
        options=fitted.options,
        report=driving,
    )
    return record, fitted.outcome()


def _judged(
    scene: Scene,
    motion: Path | Trajectory,
    record: Record,
    files: DriveFiles,
    head: str,
    notes: list[str],
) -> Outcome:
    """Return the outcome of a drive; write what was asked for."""
    verdict = judge(scene, record)
    if files.record is not None:
        write_record(record, files.record)
    if files.picture is not None:
        _draw(scene, motion, record, verdict, files.picture)
    text = _describe(head, verdict, files.named)
    if verdict.reached:
        return Outcome(OK, verdict.figures(), text, tuple(notes))
    return Outcome(NOT_FOUND, verdict.figures(), text, (*notes, verdict.reason))


def _foreseen(scene: Scene, controller: str | None) -> Scene:
    """Return what is planned for: those who move only where nobody watches for them."""
    if controller is None:
        return scene
    return replace(scene, world=replace(scene.world, moving=()))


def _not_planned(scene: Scene, plan: Plan, files: DriveFiles) -> Outcome:
    """Return the outcome of a drive that had nothing to drive."""
    if files.picture is not None:
        from ..viewer.pictures import plan_picture, save_picture

        save_picture(plan_picture(scene, plan), files.picture)
    names = (
        "collisions",
        "min_clearance_m",
        "max_cross_track_error_m",
        "final_position_error_m",
        "final_heading_error_deg",
        "duration_s",
        "length_m",
    )
    fields = {"reached": False, **dict.fromkeys(names)}
    note = f"nothing was driven, {plan.status.value}: {plan.reason}"
    return Outcome(exit_code(plan), fields, describe_plan(scene, plan), (note,))


def _draw(
    scene: Scene,
    motion: Path | Trajectory,
    record: Record,
    verdict: Judgement,
    file: str,
) -> None:
    from ..viewer.charts import TrackingErrors
    from ..viewer.pictures import drive_picture, save_picture

    try:
        driven = Trajectory.from_samples(record.times, record.poses)
    except ShapeError as error:
        raise InputError("the chair never moved: there is nothing to draw", file=file) from error
    errors = None
    if record.has_reference:
        errors = TrackingErrors(record.times, record.cross_track)
    figure = drive_picture(
        scene,
        driven,
        certify_drive(scene.world, scene.vehicle, record.times, record.poses),
        planned=motion.path if isinstance(motion, Trajectory) else motion,
        errors=errors,
        text=verdict.reason,
    )
    save_picture(figure, file)


def _describe(head: str, verdict: Judgement, written: str) -> str:
    cross = verdict.max_cross_track_error
    return lines(
        head,
        f"driven: {'reached' if verdict.reached else 'not reached'}",
        f"  {verdict.reason}",
        ("proven clearance", millimetres(verdict.min_clearance)),
        ("collisions", f"{len(verdict.collisions)}"),
        "" if cross is None else ("tracking error", f"at most {1e3 * cross:.1f} mm"),
        ("driven", f"{verdict.length:.2f} m in {verdict.duration:.1f} s"),
        ("written", written) if written else "",
    )
