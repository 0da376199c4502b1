"""One page in one browser tab: its own scene, its own plan, its own drawing."""

from __future__ import annotations

import threading
import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from viser import ClientHandle

from narrows.interfaces import Plan, PlanStatus
from narrows.se2 import Array
from narrows.tracking.registry import tracker_names

from . import page_work
from .control_colours import state_colour
from .motion_shapes import nearest_place, spread, thinned
from .page_camera import camera
from .page_chair import ChairPanel
from .page_controllers import CommandControllers, Protected, drive_controller
from .page_drag import Dragging
from .page_drawing import SceneDrawing
from .page_drive import DrivePanel
from .page_guard import Guard
from .page_jobs import Job, JobRunner
from .page_layers import Layers
from .page_motion import Motion, driven_motion, planned_motion
from .page_places import EndPanel, ThingsPanel, WallsPanel
from .page_playback import Playback
from .page_plots import Plots
from .page_report import Told, Work
from .page_save import Saved, SavePanel
from .page_state import SceneState
from .page_words import Words, answer, drive_words, passage_words, plan_words

_TICK = 0.2  # s between words about work under way
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
        self._job: Job | None = None
        self._asked = 0
        self._protected: Protected | None = None
        self.drawing = SceneDrawing(client.scene)
        self.drawing.stage()
        gui = client.gui
        self._words = gui.add_html("")
        self._bar: Any = gui.add_progress_bar(0.0, visible=False, animated=True)
        self._plan_button = gui.add_button("Plan", color="blue")
        self._plan_button.on_click(self._locked(self.ask_plan))
        self._pass_button = gui.add_button("Can it pass?", color="teal")
        self._pass_button.on_click(self._locked(self.ask_passage))
        self._cancel_button = gui.add_button("Cancel", color="red", visible=False)
        self._cancel_button.on_click(self._locked(self.cancel))
        self._build_tabs(folder)
        self.say(_READY)
        self.redraw()
        self.aim()
        client.camera.on_update(self._seen)
        self._seen(client.camera)  # the panel may have made room for itself in between

    def _build_tabs(self, folder: Path) -> None:
        gui, state = self.client.gui, self.state
        tabs = gui.add_tab_group()
        with tabs.add_tab("Drive"):
            self.driving = DrivePanel(
                gui,
                self._guard,
                self._commanded.names,
                self._locked(self.ask_drive),
                self._tell_driver,
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
        self.dragging = Dragging(self.client, self.drawing, self.edit)

    def saved(self) -> Saved:
        """Return what there is to save."""
        return Saved(self.state, self.plan, self.drive, self.playback.motion, self.layers.names)

    def close(self) -> None:
        """End what is under way: the tab is gone."""
        with self._guard.lock:
            self._end_job()
            self.playback.pause()

    def _locked(self, function: Callable[[], None]) -> Callable[[Any], None]:
        return self._guard(lambda _: function())

    # What is asked

    def ask_plan(self) -> None:
        """Plan; a newer request replaces an older one."""
        if self._usable():
            self._ask("planning", page_work.plan_scene, (self.state.scene,), self._planned)

    def ask_passage(self) -> None:
        """Decide whether anything can pass."""
        if self._usable():
            self._ask("can it pass?", page_work.pass_scene, (self.state.scene,), self._decided)

    def ask_drive(self) -> None:
        """Drive the plan; plan first if there is none."""
        if self._usable():
            scene, who = self.state.scene, self.driving.who
            if who in tracker_names():
                given = (scene, self.plan, who)
                self._ask("driving", page_work.drive_scene, given, self._driven)
                return
            told = (scene, self.plan, who, self.driving.driver, self._protected, self._commanded)
            self._ask("driving", drive_controller, told, self._driven)
            if self.driving.by_hand:
                self.driving.hold_stick(on=True)
                self._play(None)
                self.drawing.remove("drive")
                self.drawing.tint(state_colour(""))

    def _tell_driver(self, value: Any) -> None:
        """Pass on what the page's stick says to the drive under way."""
        with self._guard.lock:
            if self._job is not None:
                self._job.tell(value)

    def cancel(self) -> None:
        """End what is under way."""
        self._end_job()
        self.say(Words("quiet", "cancelled", "", "Nothing was changed."))

    def _usable(self) -> bool:
        """Return whether the scene can be used; if not, say why."""
        if self._complaint():
            self._end_job()
            text = f"{self._complaint()}. Mend that first."
            self.say(Words("bad", "the scene cannot be used", "", text))
            return False
        return True

    def _ask(
        self,
        words: str,
        work: Work,
        arguments: tuple[Any, ...],
        done: Callable[[Any], None],
    ) -> None:
        self._end_job()
        self._asked += 1
        number, begun = self._asked, clock.monotonic()
        self._cancel_button.visible = self._bar.visible = True
        self._bar.value = 100.0

        def heard(told: Told) -> None:
            with self._guard.lock:
                if number == self._asked:
                    self._hear(told, done)

        def tick() -> None:
            while True:
                with self._guard.lock:
                    if number != self._asked or self._job is None:
                        return
                    spent = f"{clock.monotonic() - begun:.1f} s"
                    self.say(Words("busy", f"{words} …", spent, "The page stays usable."))
                clock.sleep(_TICK)

        self.say(Words("busy", f"{words} …"))
        self._job = self._runner.start(work, *arguments, heard=heard)
        threading.Thread(target=tick, daemon=True).start()

    def _hear(self, told: Told, done: Callable[[Any], None]) -> None:
        if told.kind == "progress" and isinstance(told.value, dict):
            self.drawing.place(told.value["pose"])
            self.drawing.at_time(self.state.scene, float(told.value["time"]))
            return
        if told.kind == "progress":
            self._bar.animated = False
            self._bar.value = 100.0 * float(told.value)
            return
        self._end_job()
        if told.kind == "result":
            done(told.value)
        else:
            self.say(Words("bad", "no answer", "", str(told.value)))

    def _end_job(self) -> None:
        self._asked += 1
        if self._job is not None:
            self._job.cancel()
        self._job = None
        self.driving.hold_stick(on=False)
        self._cancel_button.visible = self._bar.visible = False
        self._bar.animated = True

    # What comes back

    def _planned(self, plan: Plan) -> None:
        self._take_plan(plan)
        self.say(plan_words(plan))
        if plan.status is PlanStatus.IMPASSABLE:
            self._runner.start(
                page_work.pass_scene, self.state.scene, heard=self._marker(self._asked)
            )

    def _take_plan(self, plan: Plan) -> None:
        """Show a plan: its motion and narrowest place, if it is certified; else neither."""
        self.plan, self.drive = plan, None
        scene = self.state.scene
        self.drawing.remove("drive")
        self.drawing.remove("plan")
        self.drawing.mark(None, "", bad=False)
        if plan.trajectory is None or plan.certificate is None:
            self._play(None)
            return
        self.drawing.motion("plan", scene.vehicle, spread(plan.trajectory.path))
        at, text = nearest_place(scene, plan.trajectory.path, plan.certificate)
        self.drawing.mark(at, text, bad=False)
        self._play(planned_motion(scene, plan.trajectory))

    def _play(self, motion: Motion | None) -> None:
        self.playback.load(None)  # nothing follows the time while the others change
        self.layers.load(motion)
        self.plots.load(motion)
        self.playback.load(motion)

    def _marker(self, number: int) -> Callable[[Told], None]:
        """Return what marks the place where the millimetres are missing, if still asked."""

        def heard(told: Told) -> None:
            with self._guard.lock:
                if number == self._asked and told.kind == "result":
                    self._mark_passage(told.value)

        return heard

    def _decided(self, verdict: Any) -> None:
        self.say(passage_words(verdict, self.state.scene))
        self._mark_passage(verdict)

    def _mark_passage(self, verdict: Any) -> None:
        words = passage_words(verdict, self.state.scene)
        self.drawing.mark(
            verdict.narrowest, words.figure or words.headline, bad=words.tone == "bad"
        )

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
        rows = thinned(motion.poses)
        self.drawing.motion("drive", self.state.scene.vehicle, rows, fault=motion.fault)
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
        self._end_job()
        self.plan = self.drive = None
        self._play(None)
        for group in ("plan", "drive"):
            self.drawing.remove(group)
        self.drawing.mark(None, "", bad=False)
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
        state, scene = self.state, self.state.scene
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
            self.drawing.world(scene)
            self.drawing.chair(scene.vehicle)
            handles = self.drawing.things(scene)
            ends = {}
            for name in ("start", "goal"):
                place = state.pose(name)
                pose = np.array([place["x"], place["y"], np.deg2rad(place["heading_deg"])])
                ends[name] = self.drawing.end(name, scene.vehicle, pose)
            self.drawing.place(_pose_of(state, "start"))
            self.dragging.attach(state, handles, ends)

    def aim(self) -> None:
        """Point the camera so that the whole scene is seen."""
        seen = self.client.camera
        self._aspect = seen.image_width / max(seen.image_height, 1)
        place = camera(self.state.scene, self._aspect)
        self.client.camera.position = place.position
        self.client.camera.look_at = place.look_at

    def _seen(self, seen: Any) -> None:
        """Aim anew when the window has another shape."""
        aspect = seen.image_width / max(seen.image_height, 1)
        if abs(aspect - self._aspect) > 0.02 * self._aspect:
            self.aim()

    def _show_motion(self, motion: Motion, at: float) -> None:
        self.drawing.place(motion.pose(at))
        self.drawing.at_time(self.state.scene, at)
        self.drawing.tint(state_colour(motion.state(at)))
        self.layers.show(at)

    def say(self, words: Words) -> None:
        """Say a verdict in large words."""
        self._words.content = words.html()


def _pose_of(state: SceneState, end: str) -> Array:
    place = state.pose(end)
    return np.array([place["x"], place["y"], np.deg2rad(place["heading_deg"])])
