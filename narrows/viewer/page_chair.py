"""The chair's features on the page: by name, or by fields."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from viser import GuiApi

from narrows.scene import vehicle_names

from .page_fields import Field, FieldGroup, rounded_number
from .page_state import SceneState
from .page_words import answer

OWN = "own numbers"

BODY = (
    Field("length", "length [m]", 0.2, 3.0, 0.01, "overall"),
    Field("width", "width [m]", 0.2, 2.0, 0.01, "overall"),
    Field("rear_overhang", "rear overhang [m]", 0.0, 3.0, 0.01, "body behind the drive axle"),
    Field("front_overhang", "front overhang [m]", 0.0, 3.0, 0.01, "body before the drive axle"),
    Field("height", "height [m]", 0.1, 2.5, 0.01, "top of the chair with its occupant"),
)
DRIVE = (
    Field("track", "track [m]", 0.1, 2.0, 0.01, "between the drive wheels"),
    Field("wheel_radius", "wheel radius [m]", 0.03, 0.5, 0.01, "of the drive wheels"),
)
LIMITS = (
    Field("speed", "speed [m/s]", 0.05, 5.0, 0.05, "forward"),
    Field("reverse_speed", "reverse [m/s]", 0.0, 5.0, 0.05, "0: forward only"),
    Field("acceleration", "accel. [m/s²]", 0.05, 10.0, 0.05, "along the path"),
    Field("jerk", "jerk [m/s³]", 0.05, 100.0, 0.1, "along the path"),
    Field("yaw_rate", "turning [rad/s]", 0.05, 10.0, 0.1, "heading rate"),
    Field("yaw_acceleration", "turning accel. [rad/s²]", 0.05, 100.0, 0.1, "of the heading rate"),
    Field("lateral_acceleration", "sideways [m/s²]", 0.05, 10.0, 0.05, "speed times heading rate"),
    Field("curvature", "curvature [1/m]", 0.05, 100.0, 0.1, "1 / the tightest radius"),
)


class ChairPanel:
    """Fields of the chair; what is typed becomes the document's `vehicle` entry."""

    def __init__(self, gui: GuiApi, apply: Callable[[Any], None]) -> None:
        """Add the fields.

        Args:
            gui: The page.
            apply: Called with the `vehicle` entry of a change.
        """
        self._apply = apply
        self._shown: dict[str, Any] = {}
        self._kept: dict[str, Any] = {}  # a body that is no rectangle
        self.choice: Any = gui.add_dropdown("chair", (OWN, *vehicle_names()), hint="Chairs by name")
        self.choice.on_update(self._chosen)
        with gui.add_folder("Body"):
            self._note = gui.add_html("")
            self.body = FieldGroup(gui, BODY, self._changed)
        with gui.add_folder("Wheels"):
            self.drive = FieldGroup(gui, DRIVE, self._changed)
        with gui.add_folder("Limits of the drive", expand_by_default=False):
            self.spot: Any = gui.add_checkbox(
                "turns on the spot", True, hint="No limit of the curvature"
            )
            self.spot.on_update(self._changed)
            self.limits = FieldGroup(gui, LIMITS, self._changed)

    def show(self, state: SceneState) -> None:
        """Show the chair of a state."""
        entry = state.vehicle
        given = state.document["vehicle"]
        name = given if isinstance(given, str) else OWN
        self._shown = {}  # no change is taken for the user's until all is shown
        self._kept = {}
        if "layers" in entry or "polygon" in entry["body"]:
            names = ("layers",) if "layers" in entry else ("body", "height")
            self._kept = {key: entry[key] for key in names if key in entry}
            self._show_kept(state)
        else:
            body = entry["body"]
            sizes = {key: float(body[key]) for key in ("length", "width", "rear_overhang")}
            front = sizes["length"] - sizes["rear_overhang"]
            height = float(entry.get("height", state.scene.vehicle.height))
            self.body.show({**sizes, "front_overhang": front, "height": height})
        self.body.enable(on=not self._kept)
        kind = "a stack of layers" if "layers" in entry else "a polygon"
        note = f"This body is {kind}: edit its file, or choose a chair by name."
        self._note.content = answer(note, good=True) if self._kept else ""
        self.drive.show({key: float(entry[key]) for key in ("track", "wheel_radius")})
        limits = {key: float(value) for key, value in entry["limits"].items()}
        turns = limits.get("curvature") is None
        self.spot.value = turns
        self.limits.show({key: value for key, value in limits.items() if value is not None})
        self.limits.enable(on=not turns, names=["curvature"])
        self.choice.value = name
        self._shown = self._entry(str(entry.get("name", "chair")))

    def _show_kept(self, state: SceneState) -> None:
        vehicle = state.scene.vehicle
        self.body.show(
            {
                "length": vehicle.length,
                "width": vehicle.width,
                "rear_overhang": vehicle.rear_overhang,
                "front_overhang": vehicle.front_overhang,
                "height": vehicle.height,
            }
        )

    @property
    def complaint(self) -> str:
        """What is wrong with the first number that makes no sense, or nothing."""
        return self.body.complaint or self.drive.complaint or self.limits.complaint

    def _entry(self, name: str) -> dict[str, Any]:
        """Return the `vehicle` entry that the fields say."""
        body = self.body.values
        sizes = {key: body[key] for key in ("length", "width", "rear_overhang")}
        shape = self._kept or {"body": sizes, "height": body["height"]}
        limits = {key: value for key, value in self.limits.values.items()}
        if self.spot.value:
            limits.pop("curvature")
        return {"name": name, **shape, **self.drive.values, "limits": limits}

    def _chosen(self, event: Any) -> None:
        if self._shown and event.client is not None and self.choice.value != OWN:
            self._apply(self.choice.value)

    def _changed(self, event: Any) -> None:
        """Take what was typed; length, rear and front overhang fit each other."""
        if not self._shown or event.client is None:
            return
        before = self._shown.get("body")
        if before is not None:
            self._fit(before)
        entry = self._entry(self._shown["name"])
        if entry != self._shown:
            self._shown = entry
            self.limits.enable(on=not self.spot.value, names=["curvature"])
            self._apply(entry)

    def _fit(self, before: dict[str, float]) -> None:
        """Let the front overhang follow the length, and the length the front overhang."""
        now = self.body.values
        front = rounded_number(before["length"] - before["rear_overhang"])
        typed_front = not math.isclose(now["front_overhang"], front, abs_tol=1e-9)
        if typed_front and np.isclose(now["length"], before["length"]):
            self.body.show({"length": now["rear_overhang"] + now["front_overhang"]})
        else:
            self.body.show({"front_overhang": now["length"] - now["rear_overhang"]})
