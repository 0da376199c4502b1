"""Saving what the page shows: into the folder it was started in, by plain names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from viser import GuiApi

from narrows.errors import NarrowsError, TrajectoryError
from narrows.files import write_whole
from narrows.formats import write_trajectory
from narrows.interfaces import Plan
from narrows.simulation.record import write_record

from .page_files import page_file
from .page_jobs import JobRunner
from .page_motion import Motion
from .page_report import Report, Told
from .page_state import SceneState
from .page_words import answer, drive_words, plan_words
from .page_work import Drive
from .replay import Show, replay_html

_KINDS = {
    "Scene": ".yaml",
    "Trajectory": ".csv",
    "Record": ".csv",
    "Picture": ".png",
    "Replay": ".html",
}


@dataclass(frozen=True, eq=False)
class Saved:
    """What there is to save.

    Attributes:
        state: The scene.
        plan: Its plan, or None.
        drive: Its drive, or None.
        motion: What is played, or None.
        layers: Names of the layers that are switched on.
    """

    state: SceneState
    plan: Plan | None
    drive: Drive | None
    motion: Motion | None
    layers: tuple[str, ...] = ()


class SavePanel:
    """A name, a button for each kind of file, and what came of it."""

    def __init__(
        self, gui: GuiApi, folder: Path, runner: JobRunner, current: Callable[[], Saved]
    ) -> None:
        """Add them.

        Args:
            gui: The page.
            folder: Where files go.
            runner: Makes pictures and replays beside the page.
            current: Returns what there is to save.
        """
        self._folder = folder
        self._runner = runner
        self._current = current
        name = current().state.source.stem or "scene"
        self.name = gui.add_text("name", f"{name}-page", hint="Of the file, without its ending")
        self.name.on_update(lambda _: self._name_typed())
        self.replace = gui.add_checkbox("replace", False, hint="A file that is there already")
        for kind, suffix in _KINDS.items():
            gui.add_button(f"{kind} ({suffix})").on_click(self._pressed(kind))
        self.answer = gui.add_html("")
        self._name_typed()

    def _pressed(self, kind: str) -> Callable[[Any], None]:
        return lambda _: self.save(kind)

    def _say(self, text: str, *, good: bool) -> None:
        self.answer.content = answer(text, good=good)

    def _name_typed(self) -> None:
        """Say where files of the name that is typed would go, or why there can be none."""
        try:
            file = page_file(self._folder, str(self.name.value), "", replace=True)
        except NarrowsError as error:
            self._say(str(error), good=False)
        else:
            self._say(f"goes to {file.name}.* in {self._folder}", good=True)

    def save(self, kind: str) -> None:
        """Save one kind of file and say where, or why not."""
        try:
            self._save(kind, self._current())
        except NarrowsError as error:
            self._say(str(error), good=False)

    def _save(self, kind: str, given: Saved) -> None:
        suffix, name = _KINDS[kind], str(self.name.value)
        ending = f"-record{suffix}" if kind == "Record" else suffix
        file = page_file(self._folder, name, ending, replace=bool(self.replace.value))
        if kind == "Scene":
            write_whole(file, given.state.yaml(self._folder))
        elif kind == "Trajectory":
            trajectory = _planned(given).raise_for_status().trajectory
            if trajectory is not None:
                write_trajectory(trajectory, file, vehicle=given.state.scene.vehicle)
        elif kind == "Record":
            if given.drive is None or given.drive.record is None:
                raise TrajectoryError("nothing was driven: press Drive first")
            write_record(given.drive.record, file)
        elif kind == "Picture":
            self._beside(file, save_picture_beside, given, file)
            return
        elif kind == "Replay":
            self._beside(file, save_replay, show_of(given), file)
            return
        else:
            raise TrajectoryError("there is no such kind of file", value=kind)
        self._say(f"written: {file.name}", good=True)

    def _beside(self, file: Path, work: Callable[..., Any], *arguments: Any) -> None:
        def heard(told: Told) -> None:
            if told.kind == "result":
                size = f"{1e-6 * file.stat().st_size:.1f} MB" if file.exists() else ""
                self._say(f"written: {file.name}, {size}", good=True)
            elif told.kind != "progress":
                self._say(str(told.value), good=False)

        self._say(f"writing {file.name} …", good=True)
        self._runner.start(work, *arguments, heard=heard)


def _planned(given: Saved) -> Plan:
    if given.plan is None:
        raise TrajectoryError("there is no plan: press Plan first")
    return given.plan


def show_of(given: Saved) -> Show:
    """Return the replay of what is played.

    Raises:
        TrajectoryError: If nothing is.
    """
    motion, plan, drive = given.motion, given.plan, given.drive
    if motion is not None and drive is not None and drive.judgement is not None:
        words = drive_words(drive.judgement)
    elif motion is not None and plan is not None:
        words = plan_words(plan)
    else:
        raise TrajectoryError("there is nothing to replay: press Plan or Drive first")
    path, certificate = (None, None) if plan is None else (plan.path, plan.certificate)
    return Show(given.state.scene, motion, words, path, certificate, given.layers)


def save_replay(report: Report, show: Show, file: Path) -> None:
    """Write the replay of a motion."""
    write_whole(file, replay_html(report, show))


def save_picture_beside(report: Report, given: Saved, file: Path) -> None:
    """Write the picture of what the page shows, as `narrows plan` and `narrows drive` draw it."""
    from narrows.simulation.contacts import certify_drive
    from narrows.trajectory import Trajectory

    from .charts import TrackingErrors
    from .pictures import drive_picture, plan_picture, save_picture

    scene, drive = given.state.scene, given.drive
    if drive is None or drive.record is None or drive.judgement is None:
        save_picture(plan_picture(scene, _planned(given)), file)
        return
    record = drive.record
    errors = None
    if record.has_reference:
        errors = TrackingErrors(record.times, record.cross_track)
    figure = drive_picture(
        scene,
        Trajectory.from_samples(record.times, record.poses),
        certify_drive(scene.world, scene.vehicle, record.times, record.poses),
        planned=None if given.plan is None else given.plan.path,
        errors=errors,
        text=drive.judgement.reason,
    )
    save_picture(figure, file)
