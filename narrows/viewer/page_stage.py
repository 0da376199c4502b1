"""What a tab shows in 3-D: its scene, to be dragged, its plan and its drive; and from where."""

from __future__ import annotations

import numpy as np
from viser import ClientHandle

from narrows.interfaces import Plan
from narrows.se2 import Array

from .control_colours import state_colour
from .motion_shapes import nearest_place, spread, thinned
from .page_camera import Camera, camera
from .page_drag import Apply, Dragging
from .page_drawing import SceneDrawing
from .page_motion import Motion
from .page_state import SceneState
from .page_words import Words

_ANEW = 0.1  # of the distance: how far the camera may be from where it would see all


class Stage:
    """The 3-D scene of a tab; its camera is moved only when another would be needed to see all."""

    def __init__(self, client: ClientHandle, state: SceneState, apply: Apply) -> None:
        """Set it up; nothing is drawn yet.

        Args:
            client: The tab.
            state: What it begins with.
            apply: Called with changes to the document that come of dragging, in a thread.
        """
        self._client = client
        self._drawing = SceneDrawing(client.scene)
        self._drawing.stage()
        self._dragging = Dragging(client, self._drawing, apply)
        self._aspect, self._aimed = 0.0, Camera((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        self._scene = state.scene
        client.camera.on_update(lambda _: self._aim())

    def draw(self, state: SceneState) -> None:
        """Draw world, chair and ends of a state anew."""
        drawing, self._scene = self._drawing, state.scene
        drawing.world(state.scene)
        drawing.chair(state.scene.vehicle)
        things, people = drawing.things(state.scene), drawing.people(state.scene)
        poses = {name: _pose(state, name) for name in ("start", "goal")}
        ends = {name: drawing.end(name, state.scene.vehicle, poses[name]) for name in poses}
        drawing.place(poses["start"])
        self._dragging.attach(state, things, people, ends)
        self._aim()

    def clear(self, *groups: str) -> None:
        """Take away `plan`, `drive` or `mark`."""
        for group in groups:
            self._drawing.remove(group)

    def show_plan(self, plan: Plan) -> None:
        """Show a plan and its narrowest place if it is certified, in place of all before."""
        self.clear("plan", "drive", "mark")
        if plan.trajectory is not None and plan.certificate is not None:
            path = plan.trajectory.path
            self._drawing.motion("plan", self._scene.vehicle, spread(path))
            at, text = nearest_place(self._scene, path, plan.certificate)
            self._drawing.mark(at, text, bad=False)

    def show_drive(self, motion: Motion) -> None:
        """Show the way that was driven."""
        rows = thinned(motion.poses)
        self._drawing.motion("drive", self._scene.vehicle, rows, fault=motion.fault)

    def mark(self, at: Array | None, words: Words) -> None:
        """Mark a place by the figure of a verdict."""
        self._drawing.mark(at, words.figure or words.headline, bad=words.tone == "bad")

    def show_chair(self, pose: Array, time: float, state: str = "") -> None:
        """Show chair and people at a time [s], the chair in the colour of who is in control."""
        self._drawing.place(pose)
        self._drawing.at_time(self._scene, time)
        self._drawing.tint(state_colour(state))

    def _aim(self) -> None:
        """Aim anew where another scene or another shape of the window needs it."""
        seen = self._client.camera
        aspect = seen.image_width / max(seen.image_height, 1)
        place = camera(self._scene, aspect)
        eye, middle = np.array(place.position), np.array(place.look_at)
        moved = np.hypot(
            np.linalg.norm(eye - self._aimed.position),
            np.linalg.norm(middle - self._aimed.look_at),
        )
        shaped = abs(aspect - self._aspect) > 0.02 * self._aspect
        if shaped or moved > _ANEW * np.linalg.norm(eye - middle):
            self._aspect, self._aimed = aspect, place
            seen.position = place.position
            seen.look_at = place.look_at


def _pose(state: SceneState, end: str) -> Array:
    """Return the pose (3,) of `start` or `goal`, also where the scene cannot be used."""
    place = state.pose(end)
    return np.array([place["x"], place["y"], np.deg2rad(place["heading_deg"])])
