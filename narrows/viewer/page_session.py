"""One page in one browser tab: its own scene, its own plan, its own drawing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from viser import ClientHandle

from narrows.interfaces import Plan, PlanStatus
from narrows.se2 import Array
from narrows.tracking.registry import tracker_names

from . import page_work
from .page_chair import ChairPanel
from .page_controllers import CommandControllers, Protected, drive_controller
from .page_drive import DrivePanel
from .page_guard import Guard
from .page_jobs import JobRunner
from .page_layers import Layers
from .page_motion import Motion, driven_motion, planned_motion
from .page_places import EndPanel, WallsPanel
from .page_playback import Playback
from .page_plots import Plots
from .page_save import Saved, SavePanel
from .page_stage import Stage
from .page_state import SceneState
from .page_task import Task
from .page_things import ThingsPanel
from .page_words import Words, answer, drive_words, passage_words, plan_words

_READY = Words("quiet", "not planned yet", "", "Press Plan, or change the chair or the scene.")


class Session:
    """What one browser tab shows and is asked; every callback holds the session's lock."""

    def __init__(
        self,
        client: ClientHandle,
        state: SceneState,
        runner: JobRunner,
        folder: Path,
        commanded: CommandControllers,
    ) -> None:
        """Build the page for a client."""
        self.client = client
        self.state = state
        self.plan: Plan | None = None
        self.drive: page_work.Drive | None = None
        self._runner = runner
        self._commanded = commanded
        self._guard = Guard()
        self._protected: Protected | None = None
        gui = client.gui
        self._words = gui.add_html("")
        self._plan_button = gui.add_button("Plan", color="blue")
        self._plan_button.on_click(self._locked(self.ask_plan))
        self._pass_button = gui.add_button("Can it pass?", color="teal")
        self._pass_button.on_click(self._locked(self.ask_passage))
        self._task = Task(gui, self._guard, runner, self.say, self._chair_seen, self._drive_ended)
        self._build_tabs(folder)
        self.say(_READY)
        self.stage = Stage(client, state, self.edit)
        self.redraw()

    def _build_tabs(self, folder: Path) -> None:
        gui, state = self.client.gui, self.state
        tabs = gui.add_tab_group()
        with tabs.add_tab("Drive"):
            self.driving = DrivePanel(
                gui,
                self._guard,
                self._commanded.names,
                self._locked(self.ask_drive),
                self._task.tell,
            )
            self.playback = Playback(gui, self._show_motion, lambda at: self.plots.show(at))
            self.layers = Layers(gui, self.client.scene)
            self.plots = Plots(gui)
        with tabs.add_tab("Chair"):
            self._chair_answer = gui.add_html("")
            self.chair = ChairPanel(gui, self._guard, self._edit_chair)
        with tabs.add_tab("Scene"):
            self._scene_answer = gui.add_html("")
            with gui.add_folder("Walls and margin"):
                self.walls = WallsPanel(gui, self._guard, state, self.edit)
            with gui.add_folder("Start"):
                self.start = EndPanel(gui, self._guard, "start", self.edit)
            with gui.add_folder("Goal"):
                self.goal = EndPanel(gui, self._guard, "goal", self.edit)
            with gui.add_folder("Things"):
                self.things = ThingsPanel(gui, self._guard, self.edit)
            self.again = gui.add_checkbox(
                "plan at changes", False, hint="Plan again after every change of chair or scene"
            )
        with tabs.add_tab("Save"):
            self.saving = SavePanel(gui, folder, self._runner, self.saved)

    def _chair_seen(self, pose: Array, time: float, state: str) -> None:
        self.stage.show_chair(pose, time, state)
        self.playback.tell(state)

    def _drive_ended(self) -> None:
        self.driving.hold_stick(on=False)

    def saved(self) -> Saved:
        """Return what there is to save."""
        return Saved(self.state, self.plan, self.drive, self.playback.motion, self.layers.names)

    def close(self) -> None:
        """End what is under way: the tab is gone."""
        with self._guard.lock:
            self._task.end()
            self.playback.pause()

    def _locked(self, function: Callable[[], None]) -> Callable[[Any], None]:
        return self._guard(lambda _: function())

    # What is asked

    def ask_plan(self) -> None:
        """Plan; a newer request replaces an older one."""
        if self._usable():
            self._task.ask("planning", page_work.plan_scene, (self.state.scene,), self._planned)

    def ask_passage(self) -> None:
        """Decide whether anything can pass."""
        if self._usable():
            self._task.ask("can it pass?", page_work.pass_scene, (self.state.scene,), self._decided)

    def ask_drive(self) -> None:
        """Drive the plan; plan first if there is none."""
        if self._usable():
            scene, who = self.state.scene, self.driving.who
            if who in tracker_names():
                given = (scene, self.plan, who)
                self._task.ask("driving", page_work.drive_scene, given, self._driven)
                return
            told = (scene, self.plan, who, self.driving.driver, self._protected, self._commanded)
            self._task.ask("driving", drive_controller, told, self._driven)
            if self.driving.by_hand:
                self.driving.hold_stick(on=True)
                self._play(None)
                self.stage.clear("drive")

    def _usable(self) -> bool:
        """Return whether the scene can be used; if not, say why."""
        if self._complaint():
            self._task.end()
            text = f"{self._complaint()}. Mend that first."
            self.say(Words("bad", "the scene cannot be used", "", text))
            return False
        return True

    # What comes back

    def _planned(self, plan: Plan) -> None:
        self._take_plan(plan)
        self.say(plan_words(plan))
        if plan.status is PlanStatus.IMPASSABLE:
            self._task.also(page_work.pass_scene, (self.state.scene,), self._mark_passage)

    def _take_plan(self, plan: Plan) -> None:
        """Show a plan: its motion and narrowest place, if it is certified; else neither."""
        self.plan, self.drive = plan, None
        self.stage.show_plan(plan)
        made = plan.trajectory
        self._play(None if made is None else planned_motion(self.state.scene, made))

    def _play(self, motion: Motion | None) -> None:
        self.playback.load(None)  # nothing follows the time while the others change
        self.layers.load(motion)
        self.plots.load(motion)
        self.playback.load(motion)

    def _decided(self, verdict: Any) -> None:
        self.say(passage_words(verdict, self.state.scene))
        self._mark_passage(verdict)

    def _mark_passage(self, verdict: Any) -> None:
        self.stage.mark(verdict.narrowest, passage_words(verdict, self.state.scene))

    def _driven(self, drive: page_work.Drive) -> None:
        if drive.plan is not None and self.plan is None:
            self._take_plan(drive.plan)
        self.drive = drive
        self._protected = drive.protected or self._protected
        motion = driven_motion(drive)
        if motion is None or drive.judgement is None:
            if drive.plan is not None:
                self.say(plan_words(drive.plan))
            return
        self.stage.show_drive(motion)
        self.say(drive_words(drive.judgement))
        self._play(motion)

    # What is changed

    def edit(self, changes: Any) -> None:
        """Change the document, by paths."""
        with self._guard.lock:
            self._take_state(self.state.edited(changes))

    def _edit_chair(self, entry: Any) -> None:
        with self._guard.lock:
            self._take_state(self.state.edited({("vehicle",): entry}))

    def _take_state(self, state: SceneState) -> None:
        """Take a changed scene: what was planned for another one is no plan for this."""
        self.state = state
        self._task.end()
        self.plan = self.drive = None
        self._play(None)
        self.stage.clear("plan", "drive", "mark")
        self.redraw()
        if self._complaint():
            self.say(Words("bad", "the scene cannot be used", "", self._complaint()))
        elif self.again.value:
            self.ask_plan()
        else:
            self.say(Words("quiet", "changed", "", "Press Plan: nothing is proven any more."))

    def _complaint(self) -> str:
        """Return what is wrong with the first thing typed that makes no sense, or nothing."""
        typed = (self.chair, self.walls.fields, self.start.fields, self.goal.fields)
        return next((p.complaint for p in typed if p.complaint), "") or self.state.problem

    def redraw(self) -> None:
        """Show the state: fields, answers, world, chair, ends."""
        state = self.state
        with self.client.atomic():
            for panel in (self.chair, self.walls, self.start, self.goal, self.things):
                panel.show(state)
            in_chair = state.field.startswith("vehicle")
            of_chair = self.chair.complaint or (state.problem if in_chair else "")
            of_scene = "" if in_chair else state.problem
            for panel in (self.walls, self.start, self.goal, self.things):
                of_scene = panel.fields.complaint or of_scene
            self._chair_answer.content = answer(of_chair)
            self._scene_answer.content = answer(of_scene)
            self.stage.draw(state)

    def _show_motion(self, motion: Motion, at: float) -> None:
        self.stage.show_chair(motion.pose(at), at, motion.state(at))
        self.layers.show(at)

    def say(self, words: Words) -> None:
        """Say a verdict in large words."""
        self._words.content = words.html()
