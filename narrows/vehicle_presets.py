"""The chairs that come with narrows: data files whose every number has its source."""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

from .errors import SceneError
from .scene_problems import nearest, validated
from .scene_source import Source
from .scene_text import decode, read_source

if TYPE_CHECKING:
    from .scene_model import PresetEntry


@cache
def vehicle_names() -> tuple[str, ...]:
    """Return the names of the chairs that come with narrows.

    >>> "narrow-arcs" in vehicle_names()
    True
    """
    folder = resources.files("narrows") / "vehicles"
    files = [entry.name for entry in folder.iterdir() if entry.name.endswith(".yaml")]
    return tuple(sorted(name.removesuffix(".yaml") for name in files))


def preset_entry(name: str, source: Source | None = None) -> PresetEntry:
    """Return a chair's data file.

    Args:
        name: One of `vehicle_names()`.
        source: Scene file that asks for it, for the error message.

    Raises:
        SceneError: If there is no such chair; names the nearest.
    """
    names = vehicle_names()
    if name not in names:
        raise (source or Source(None)).error(
            ("vehicle",),
            f"no chair of that name; the nearest is '{nearest(name, names)}'",
            value=name,
            allowed=f"{', '.join(names)}, or a chair's own numbers",
        )
    return _read(name)


@cache
def _read(name: str) -> PresetEntry:
    from .scene_model import PresetEntry

    file = resources.files("narrows") / "vehicles" / f"{name}.yaml"
    source = read_source(decode(file.read_bytes(), str(file)), str(file))
    if source.root is None:
        raise SceneError("the chair's file says nothing", file=str(file))
    return validated(PresetEntry, source, source.root.value)
