"""The YAML file of a map_server map: which picture, how large its cells are, what they mean."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import SceneError
from ..scene_source import Source, Step
from ..scene_text import decode, read_source
from .map_file import read_map_file

MODES = ("trinary", "scale")
FARTHEST = 1e7  # m; beyond, coordinates lose their micrometres
_LARGEST_FILE = 65_536  # bytes; such files have ten lines


@dataclass(frozen=True)
class Settings:
    """What the YAML file of a map says.

    Attributes:
        image: The picture's file.
        resolution: Side of a cell [m].
        origin: Pose of the lower left corner of the picture [m, m, rad].
        negate: Whether white means occupied.
        occupied_threshold: Occupancy above which a cell is occupied, 0..1.
        free_threshold: Occupancy below which a cell is free, 0..1.
        mode: `trinary` or `scale`.
    """

    image: Path
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_threshold: float
    free_threshold: float
    mode: str


def read_settings(file: Path) -> Settings:
    """Read the YAML file of a map; every field but `mode` must be there, others are left alone.

    Raises:
        SceneError: If the file or a field of it cannot be used; says where and what is allowed.
    """
    fields = _Fields(_read(file))
    mode = fields.get("mode", "trinary")
    if mode not in MODES:
        raise fields.error(("mode",), "maps of this mode cannot be used", mode, " or ".join(MODES))
    negate = fields.get("negate")
    if negate not in (0, 1):
        raise fields.error(("negate",), "must be a switch", negate, "0 (black is occupied) or 1")
    occupied = fields.number(("occupied_thresh",), 0.0, 1.0)
    free = fields.number(("free_thresh",), 0.0, 1.0)
    if free > occupied:
        allowed = f"at most occupied_thresh, {occupied:g}"
        raise fields.error(("free_thresh",), "the thresholds are swapped", free, allowed)
    return Settings(
        fields.picture(file.parent),
        fields.number(("resolution",), 1e-3, 10.0),
        fields.origin(),
        bool(negate),
        occupied,
        free,
        str(mode),
    )


def _read(file: Path) -> Source:
    """Return what the file says, known to be a mapping."""
    place = str(file)
    content = read_map_file(file, _LARGEST_FILE)
    source = read_source(decode(content, place), place)
    if source.root is None or not isinstance(source.root.value, dict):
        allowed = "image, resolution, origin, negate, occupied_thresh, free_thresh"
        raise SceneError("this is no map", file=place, allowed=allowed)
    return source


@dataclass(frozen=True, eq=False)
class _Fields:
    """Fields of the file, checked as they are asked for.

    Attributes:
        source: The file, its root a mapping.
    """

    source: Source

    def get(self, name: str, default: Any = None) -> Any:
        """Return a field's value; without a default it must be there."""
        values = self.source.root.value if self.source.root is not None else {}
        if name not in values and default is None:
            raise self.error((name,), "this field is missing", None, None)
        return values.get(name, default)

    def number(self, path: tuple[Step, ...], low: float, high: float) -> float:
        """Return the number at a path, from low to high."""
        value = self.get(str(path[0]))
        for step in path[1:]:
            value = value[step]
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or not low <= value <= high:  # NaN is within no range
            raise self.error(path, "must be a number in range", value, f"{low:g} to {high:g}")
        return float(value)

    def origin(self) -> tuple[float, float, float]:
        """Return the pose of the picture's lower left corner."""
        origin = self.get("origin")
        if not isinstance(origin, list) or len(origin) != 3:
            raise self.error(("origin",), "must be three numbers", origin, "[x, y, yaw]")
        x, y = (self.number(("origin", k), -FARTHEST, FARTHEST) for k in (0, 1))
        return x, y, self.number(("origin", 2), -math.tau, math.tau)

    def picture(self, folder: Path) -> Path:
        """Return the picture's file, known to be there."""
        name = self.get("image")
        allowed = "a PGM, PNG or BMP file, its path relative to the YAML file's folder"
        if not isinstance(name, str):
            raise self.error(("image",), "must be the name of a file", name, allowed)
        try:
            is_there = (folder / name).is_file()
        except OSError:  # longer than the file system takes
            is_there = False
        if not is_there:
            raise self.error(("image",), "there is no such file", name, allowed)
        return folder / name

    def error(
        self, path: tuple[Step, ...], problem: str, value: Any, allowed: str | None
    ) -> SceneError:
        """Return the error that names the field at a path."""
        return self.source.error(path, problem, value=value, allowed=allowed)
