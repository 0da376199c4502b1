"""The chair's features on the page: by name, or by fields."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from viser import GuiApi

from narrows.scene import vehicle_names

from .page_fields import Field, FieldGroup, by_hand
from .page_guard import Guard
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

    def __init__(self, gui: GuiApi, guard: Guard, apply: Callable[[Any], None]) -> None:
        """Add the fields.

        Args:
            gui: The page.
            guard: Makes callbacks wait for each other.
            apply: Called with the `vehicle` entry of a change.
        """
        self._apply = apply
        self._name = ""
        self._kept: dict[str, Any] = {}  # a body that is no rectangle
        changed = guard(self._changed)
        self.choice: Any = gui.add_dropdown("chair", (OWN, *vehicle_names()), hint="By name")
        self.choice.on_update(by_hand(guard(self._chosen)))
        with gui.add_folder("Body"):
            self._note = gui.add_html("")
            self.body = FieldGroup(gui, BODY, changed)
        with gui.add_folder("Wheels"):
            self.drive = FieldGroup(gui, DRIVE, changed)
        with gui.add_folder("Limits of the drive", expand_by_default=False):
            self.spot: Any = gui.add_checkbox(
                "turns on the spot", True, hint="No limit of the curvature"
            )
            self.spot.on_update(by_hand(changed))
            self.limits = FieldGroup(gui, LIMITS, changed)
        self._turns = True

    @property
    def complaint(self) -> str:
        """What is wrong with the first number that makes no sense, or nothing."""
        return self.body.complaint or self.drive.complaint or self.limits.complaint

    def show(self, state: SceneState) -> None:
        """Show the chair of a state."""
        entry, given, vehicle = state.vehicle, state.document["vehicle"], state.scene.vehicle
        self._name = str(entry.get("name", "chair"))
        names = ("layers",) if "layers" in entry else ("body", "height")
        plain = "layers" not in entry and "polygon" not in entry["body"]
        self._kept = {} if plain else {key: entry[key] for key in names if key in entry}
        sizes = {name: getattr(vehicle, name) for name in ("length", "width", "rear_overhang")}
        height = vehicle.height
        if plain:
            sizes = {name: float(entry["body"][name]) for name in sizes}
            height = float(entry.get("height", height))
        front = sizes["length"] - sizes["rear_overhang"]
        self.body.show({**sizes, "front_overhang": front, "height": height})
        self.body.enable(on=plain)
        kind = "a stack of layers" if "layers" in entry else "a polygon"
        note = f"This body is {kind}: edit its file, or choose a chair by name."
        self._note.content = "" if plain else answer(note, good=True)
        self.drive.show({name: float(entry[name]) for name in ("track", "wheel_radius")})
        limits = {name: float(v) for name, v in entry["limits"].items() if v is not None}
        turns = "curvature" not in limits
        if turns != self._turns:
            self._turns = self.spot.value = turns
        self.limits.show(limits)
        self.limits.enable(on=not turns, names=["curvature"])
        self.choice.value = given if isinstance(given, str) else OWN

    def _entry(self) -> dict[str, Any]:
        """Return the `vehicle` entry that the fields say."""
        body, limits = self.body.known, self.limits.known
        sizes = {name: body[name] for name in ("length", "width", "rear_overhang")}
        shape = self._kept or {"body": sizes, "height": body["height"]}
        if self._turns:
            limits.pop("curvature")
        return {"name": self._name, **shape, **self.drive.known, "limits": limits}

    def _chosen(self, event: Any) -> None:
        if self.choice.value != OWN:
            self._apply(str(self.choice.value))

    def _changed(self, event: Any) -> None:
        """Take what was typed; length, rear and front overhang fit each other."""
        typed = self.body.read()
        others = self.drive.read() | self.limits.read()
        turned = bool(self.spot.value) != self._turns
        if not (typed or others or turned):
            return
        self._turns = bool(self.spot.value)
        body = self.body.known
        if "front_overhang" in typed:
            self.body.show({"length": body["rear_overhang"] + body["front_overhang"]})
        elif typed:
            self.body.show({"front_overhang": body["length"] - body["rear_overhang"]})
        self._apply(self._entry())
