"""The columns of a trajectory, by the names people give them, and rows of them as a motion.

============  =====================================  =========
column        also called                            unit
============  =====================================  =========
`t`           time, t_s, time_s                      s
`x`           x_m                                    m
`y`           y_m                                    m
`heading`     theta, yaw, heading_rad, yaw_rad, ...  rad
`heading_deg` theta_deg, yaw_deg                     deg
============  =====================================  =========

`t` may be missing: the motion is then a path. Other columns are left alone: speeds follow from
times and poses.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from ..errors import ShapeError, TrajectoryError
from ..path import Path
from ..se2 import Array
from ..trajectory import Trajectory
from ..vehicle import Vehicle

COLUMNS = ("t", "x", "y", "heading", "v", "omega", "v_left", "v_right")
"""Columns of the trajectories narrows writes; SI and radians."""

_NAMES = {
    "t": ("t", "time", "t_s", "time_s"),
    "x": ("x", "x_m"),
    "y": ("y", "y_m"),
    "heading": ("heading", "theta", "yaw", "heading_rad", "theta_rad", "yaw_rad"),
    "heading_deg": ("heading_deg", "theta_deg", "yaw_deg"),
}
_LARGEST = {"t": 1e12, "x": 1e7, "y": 1e7, "heading": 1e6, "heading_deg": 1e8}
LARGEST_FILE = 200_000_000
"""Size [bytes] beyond which a file is no trajectory: 80 hours at 50 rows a second."""


def written_rows(trajectory: Trajectory, vehicle: Vehicle) -> list[list[str]]:
    """Return the rows of a trajectory as text of ten decimals, in the order of `COLUMNS`.

    Rows whose time would not differ from the one before in ten decimals are left out.
    """
    wheels = vehicle.wheel_speeds(trajectory.commands)
    table = np.column_stack([trajectory.times, trajectory.poses, trajectory.commands, wheels])
    table = np.round(table, 10) + 0.0  # + 0.0: no negative zeros
    kept = np.concatenate([[True], np.diff(table[:, 0]) > 0.0])
    kept[-1] = True
    if len(table) > 1 and table[-1, 0] <= table[kept][-2, 0]:
        kept[np.flatnonzero(kept)[-2]] = False
    return [[f"{value:.10f}" for value in row] for row in table[kept].tolist()]


def column_indices(names: Sequence[str], file: str, line: int | None) -> dict[str, int]:
    """Return where the columns are that make a motion.

    Args:
        names: The header as found.
        file: Name of the file, for messages.
        line: Line of the header, for messages.

    Raises:
        TrajectoryError: If one is missing or there twice.
    """
    found: dict[str, int] = {}
    plain = [name.strip().strip("\"'").lower() for name in names]
    for column, accepted in _NAMES.items():
        places = [index for index, name in enumerate(plain) if name in accepted]
        if len(places) > 1:
            twice = ", ".join(names[index].strip() for index in places)
            raise TrajectoryError("this column is there twice", file=file, line=line, field=twice)
        if places:
            found[column] = places[0]
    if "heading" in found and "heading_deg" in found:
        problem = "the heading is there twice, in radians and in degrees"
        raise TrajectoryError(problem, file=file, line=line, field="heading")
    for column in ("x", "y", "heading"):
        if column not in found and not (column == "heading" and "heading_deg" in found):
            accepted = _NAMES[column] + (_NAMES["heading_deg"] if column == "heading" else ())
            raise TrajectoryError(
                f"there is no column {column}",
                file=file,
                line=line,
                value=", ".join(name.strip() for name in names)[:60],
                allowed=" or ".join(accepted),
            )
    return found


def number(value: Any, column: str, file: str, line: int | None, field: str | None = None) -> float:
    """Return a value as a finite number of sensible size.

    Raises:
        TrajectoryError: If it is none.
    """
    field = field or column
    largest = _LARGEST[column]
    allowed = f"a number between {-largest:g} and {largest:g}, with a decimal point"
    text = value.strip() if isinstance(value, str) else value
    if isinstance(text, bool) or not isinstance(text, (str, int, float)) or "_" in str(text):
        problem = "this is not a number"
        raise TrajectoryError(
            problem, file=file, line=line, field=field, value=value, allowed=allowed
        )
    try:
        result = float(text)
    except (ValueError, OverflowError) as error:
        problem = "this is not a number" if isinstance(text, str) and text else "the value is empty"
        raise TrajectoryError(
            problem, file=file, line=line, field=field, value=text or None, allowed=allowed
        ) from error
    if not math.isfinite(result) or abs(result) > largest:
        problem = "this number is too large or not finite"
        raise TrajectoryError(
            problem, file=file, line=line, field=field, value=text, allowed=allowed
        )
    return result


def as_motion(
    rows: Array, columns: Sequence[str], file: str, lines: Sequence[int] | None
) -> Trajectory | Path:
    """Return rows of numbers as a trajectory, or as a path where they have no times.

    Args:
        rows: Values, shape (N, K).
        columns: What they are, K names out of t, x, y, heading, heading_deg.
        file: Name of the file, for messages.
        lines: Line of each row, or None where rows are counted instead.

    Raises:
        TrajectoryError: If there is no motion in them or times do not increase.
    """
    if len(rows) < 2:
        found = f"{len(rows)} row" if len(rows) == 1 else "none"
        raise TrajectoryError(
            "a motion needs at least two rows", file=file, value=found, allowed="2 or more rows"
        )
    table = {name: rows[:, index] for index, name in enumerate(columns)}
    heading = table["heading"] if "heading" in table else np.deg2rad(table["heading_deg"])
    poses = np.column_stack([table["x"], table["y"], heading])
    times = table.get("t")
    if times is not None and (np.diff(times) <= 0.0).any():
        row = int(np.flatnonzero(np.diff(times) <= 0.0)[0]) + 1
        raise TrajectoryError(
            "times must increase from row to row",
            file=file,
            line=lines[row] if lines is not None else None,
            field="t" if lines is not None else f"rows[{row}].t",
            value=float(times[row]),
            allowed=f"more than {times[row - 1]:g}",
        )
    try:
        return Path.from_poses(poses) if times is None else Trajectory.from_samples(times, poses)
    except ShapeError as error:
        raise TrajectoryError(f"the rows are no motion: {error}", file=file) from error


def read_text(file: FilePath | str) -> str:
    """Return the text of a file.

    Raises:
        TrajectoryError: If it is missing, no text, empty or far too large.
    """
    place = FilePath(file)
    try:
        if place.is_dir():
            raise TrajectoryError("this is a folder, not a trajectory", file=str(file))
        size = place.stat().st_size
        if size > LARGEST_FILE:
            allowed = f"at most {LARGEST_FILE} bytes"
            raise TrajectoryError(
                "the file is too large", file=str(file), value=f"{size} bytes", allowed=allowed
            )
        content = place.read_bytes()
    except FileNotFoundError as error:
        raise TrajectoryError("there is no such file", file=str(file)) from error
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise TrajectoryError(f"the file cannot be read: {why}", file=str(file)) from error
    if not content.strip():
        raise TrajectoryError("the file is empty", file=str(file), allowed="a header and rows")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise _no_text(file, line) from error
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise _no_text(file, line)
    return text


def _no_text(file: FilePath | str, line: int) -> TrajectoryError:
    return TrajectoryError("this is not text", file=str(file), line=line, allowed="text in UTF-8")
