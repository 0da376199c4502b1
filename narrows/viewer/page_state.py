"""The scene a page works on: a document of the scene format, edited, checked, written.

The page keeps what a scene file says, not what came of it, so that everything typed goes through
the same reader, the same checks and the same messages as a file.
"""

from __future__ import annotations

import copy
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from narrows.errors import InputError, SceneError
from narrows.scene import Scene, read_scene
from narrows.scene_text import decode, read_source
from narrows.scene_write import pose_entry, to_yaml, vehicle_entry

DEFAULT = """
name: chair through a 0.90 m door
vehicle: {preset: narrow-arcs, limits: {curvature: 2.5, reverse_speed: 0}}
doorway: {corridor_width: 1.6, door_width: 0.9, door_position: 1.6, wall_thickness: 0.1, room: [4.0, 3.0]}
start: {x: -0.6, y: 0.8, heading_deg: 0}
goal: {x: 1.6, y: 3.5, heading_deg: 90}
"""  # noqa: E501
"""The scene of a page that is given none."""

FORMS = ("doorway", "corridor", "map")
Step = str | int


@dataclass(frozen=True, eq=False)
class SceneState:
    """A document and the scene it makes.

    Attributes:
        document: What a scene file would say.
        source: The file it came from; maps are named relative to it.
        scene: The last scene that could be used: that of the document if `problem` is empty.
        problem: Why the document cannot be used; empty: it can.
        field: Dotted path of the field the problem is about.
    """

    document: Mapping[str, Any]
    source: Path
    scene: Scene
    problem: str = ""
    field: str = ""

    @property
    def form(self) -> str:
        """The short form of the walls, `doorway`, `corridor` or `map`, or empty."""
        return next((name for name in FORMS if self.document.get(name) is not None), "")

    @property
    def first_thing(self) -> int:
        """Index among the world's solids of the first that the document lists itself."""
        return len(self.scene.world.solids) - len(self.listed_solids)

    @property
    def listed_solids(self) -> Sequence[Mapping[str, Any]]:
        """Entries of `world.solids`."""
        world = self.document.get("world")
        return [] if world is None else world.get("solids", [])

    @property
    def vehicle(self) -> dict[str, Any]:
        """The chair, all numbers spelled out."""
        given = self.document["vehicle"]
        spelled = isinstance(given, dict) and "track" in given and "preset" not in given
        if spelled and "limits" in given and ("body" in given or "layers" in given):
            return copy.deepcopy(given)
        return vehicle_entry(self.scene.vehicle)

    def pose(self, end: str) -> dict[str, float]:
        """Return {x, y, heading_deg} of `start` or `goal`, given or by the short form."""
        given = self.document.get(end)
        if given is not None:
            return {name: float(given[name]) for name in ("x", "y", "heading_deg")}
        return pose_entry(self.scene.start if end == "start" else self.scene.goal.pose)

    def edited(self, changes: Mapping[tuple[Step, ...], Any]) -> SceneState:
        """Return the state after changes, by paths into the document; None takes away."""
        document = copy.deepcopy(dict(self.document))
        for path, value in changes.items():
            _put(document, path, value)
        return self.with_document(document)

    def with_document(self, document: Mapping[str, Any]) -> SceneState:
        """Return the state of another document."""
        try:
            scene = scene_of(document, self.source)
        except SceneError as error:
            field = error.field or ""
            return SceneState(document, self.source, self.scene, complaint(error), field)
        return SceneState(document, self.source, scene)

    def yaml(self, folder: Path) -> str:
        """Return the text of a scene file in a folder.

        Raises:
            SceneError: If the document cannot be used.
        """
        if self.problem:
            raise SceneError(self.problem)
        document = copy.deepcopy(dict(self.document))
        if document.get("map") is not None:
            place = self.source.parent / document["map"]["file"]
            document["map"]["file"] = Path(os.path.relpath(place, folder)).as_posix()
        return to_yaml(_given(document))


def load_state(file: Path | str | None) -> SceneState:
    """Return the state of a scene file; None: of the default scene.

    Raises:
        SceneError: If the file cannot be used.
    """
    if file is None:
        text, source = DEFAULT, Path("door.yaml")
    else:
        source = Path(file)
        try:
            text = decode(source.read_bytes(), str(source))
        except OSError as error:
            why = f"the file cannot be read: {error.strerror}"
            raise SceneError(why, file=str(source)) from error
    scene = read_scene(text, source)
    root = read_source(text, str(source)).root
    return SceneState({} if root is None else root.value, source, scene)


def scene_of(document: Mapping[str, Any], source: Path) -> Scene:
    """Return the checked scene of a document.

    Raises:
        SceneError: If it cannot be used.
    """
    return read_scene(json.dumps(document), source)


def complaint(error: InputError) -> str:
    """Return an error for people who see the field, not the file."""
    bare = InputError(error.problem, field=error.field, value=error.value, allowed=error.allowed)
    return str(bare)


def _put(document: dict[str, Any], path: tuple[Step, ...], value: Any) -> None:
    *parents, last = path
    here: Any = document
    for step in parents:
        if isinstance(here, dict) and here.get(step) is None:
            here[step] = {}
        here = here[step]
    if value is None and isinstance(here, list):
        here.pop(int(last))
    elif value is None:
        here.pop(last, None)
    elif isinstance(here, list) and last == len(here):
        here.append(value)
    else:
        here[last] = value


def _given(value: Any) -> Any:
    """Return a document without the entries that say nothing."""
    if isinstance(value, dict):
        kept = {key: _given(entry) for key, entry in value.items() if entry is not None}
        return {key: entry for key, entry in kept.items() if entry not in ({}, [])}
    if isinstance(value, list):
        return [_given(entry) for entry in value]
    return value
