"""What happened on a drive: rows over time, written and read as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from types import MappingProxyType

import numpy as np

from ..errors import ShapeError, TrajectoryError
from ..files import write_whole
from ..formats.columns import column_indices, number, read_text
from ..se2 import Array

_WIDTHS = {
    "times": 0,
    "poses": 3,
    "estimates": 3,
    "commands": 2,
    "wheel_speeds": 2,
    "progress": 0,
    "cross_track": 0,
    "heading_error": 0,
}

RECORD_COLUMNS = (
    "t",
    "x",
    "y",
    "heading",
    "x_believed",
    "y_believed",
    "heading_believed",
    "v_command",
    "omega_command",
    "v_left",
    "v_right",
    "progress",
    "cross_track_error",
    "heading_error",
)
"""The first columns of the CSV; SI and radians. `t,x,y,heading` are the true motion, as in a
trajectory; a controller's signals follow by their names."""


@dataclass(frozen=True, eq=False)
class Record:
    """A drive in rows, the first at its start, the last when the chair stood or time was up.

    Attributes:
        times: Times, shape (N,), increasing from 0, [s].
        poses: True poses, shape (N, 3), [m, m, rad], headings unwrapped; between rows the chair
            moves at a constant twist.
        estimates: Poses the chair believed, shape (N, 3), each held for a control period.
        commands: Commands [v, omega] sent last, shape (N, 2), [m/s, rad/s].
        wheel_speeds: Rim speeds [v_left, v_right] by the nominal radius, shape (N, 2), [m/s].
        progress: Progress along the reference the controller claimed, shape (N,).
        cross_track: Distance of the true pose to the leg of the reference being driven, shape
            (N,), [m]; positive: the reference lies to the left, seen along the travel. On a turn
            on the spot: distance from the spot. NaN where there was no reference.
        heading_error: Heading of the reference there less the true one, shape (N,), [rad]; 0
            within a turn on the spot; NaN where there was no reference.
        signals: What the controller told of itself, by name, each of shape (N,), held for a control
            period; NaN and infinities as it told them.
    """

    times: Array
    poses: Array
    estimates: Array
    commands: Array
    wheel_speeds: Array
    progress: Array
    cross_track: Array
    heading_error: Array
    signals: Mapping[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the shapes; keep read-only copies."""
        count = len(np.atleast_1d(self.times))
        for name, width in _WIDTHS.items():
            rows = np.array(getattr(self, name), dtype=float)
            shape = (count, width) if width else (count,)
            if rows.shape != shape or count < 1:
                raise ShapeError(f"{name} must have shape {shape}, got {rows.shape}")
            rows.setflags(write=False)
            object.__setattr__(self, name, rows)
        if (np.diff(self.times) <= 0.0).any():
            raise ShapeError("the times of a record must increase")
        object.__setattr__(self, "signals", _checked_signals(self.signals, count))

    @property
    def duration(self) -> float:
        """Time from the first to the last row [s]."""
        return float(self.times[-1] - self.times[0])

    @property
    def length(self) -> float:
        """Distance the body origin travelled [m]."""
        step = np.diff(self.poses[:, :2], axis=0)
        return float(np.hypot(step[:, 0], step[:, 1]).sum())

    @property
    def has_reference(self) -> bool:
        """Whether a reference was followed."""
        return not bool(np.isnan(self.cross_track).any())


def write_record(record: Record, file: FilePath | str) -> None:
    """Write a record as CSV of ten decimals, whole or not at all.

    The header is `RECORD_COLUMNS`, then the names of the signals.

    Raises:
        InputError: If the file cannot be written there.
        TrajectoryError: If a signal's name would be taken for a column of the motion.
    """
    header = [*RECORD_COLUMNS, *record.signals]
    column_indices(header, str(file), None)
    parts = [getattr(record, name) for name in _WIDTHS]
    table = np.column_stack([*parts, *record.signals.values()])
    table = np.round(table, 10) + 0.0  # + 0.0: no negative zeros
    rows = [",".join(f"{value:.10f}" for value in row) for row in table.tolist()]
    write_whole(file, "\n".join([",".join(header), *rows]) + "\n")


def read_record(file: FilePath | str) -> Record:
    """Return the record in a CSV file written by `write_record`, with signals or without.

    Raises:
        TrajectoryError: If the file cannot be used; says file, line, field, value.
    """
    name = str(file)
    reader = csv.reader(io.StringIO(read_text(file)))
    rows: list[list[float]] = []
    try:
        header = next(reader, [])
        if tuple(header[: len(RECORD_COLUMNS)]) != RECORD_COLUMNS:
            allowed = ",".join(RECORD_COLUMNS)
            raise TrajectoryError("this is no record of a drive", file=name, allowed=allowed)
        names = header[len(RECORD_COLUMNS) :]
        if len(set(names)) < len(names):
            raise TrajectoryError("a signal is there twice", file=name, value=",".join(names))
        for cells in reader:
            if len(cells) != len(header):
                raise TrajectoryError(
                    "the row and the header differ in length",
                    file=name,
                    line=reader.line_num,
                    value=f"{len(cells)} values",
                    allowed=f"{len(header)}",
                )
            rows.append(_numbers(cells, header, name, reader.line_num))
    except csv.Error as error:
        problem = f"this is not CSV: {error}"
        raise TrajectoryError(problem, file=name, line=reader.line_num) from error
    table = np.array(rows).reshape(-1, len(header))
    fixed, rest = np.split(table, [len(RECORD_COLUMNS)], axis=1)
    ends = np.cumsum([max(width, 1) for width in _WIDTHS.values()])
    parts = [
        part if width else part[:, 0]
        for part, width in zip(np.split(fixed, ends[:-1], axis=1), _WIDTHS.values(), strict=True)
    ]
    times, poses, estimates, commands, wheels, progress, cross_track, heading_error = parts
    try:
        return Record(
            times,
            poses,
            estimates,
            commands,
            wheels,
            progress,
            cross_track,
            heading_error,
            dict(zip(names, rest.T, strict=True)),
        )
    except ShapeError as error:
        raise TrajectoryError(f"the rows are no drive: {error}", file=name) from error


def _numbers(cells: list[str], header: list[str], file: str, line: int) -> list[float]:
    """Return a row's numbers; errors may be `nan`: no reference; signals also infinite."""
    without, fixed = RECORD_COLUMNS[-2:], len(RECORD_COLUMNS)
    return [
        float(cell)
        if (cell == "nan" and (column in without or index >= fixed))
        or (cell in ("inf", "-inf") and index >= fixed)
        else number(cell, "x", file, line, field=column)
        for index, (cell, column) in enumerate(zip(cells, header, strict=True))
    ]


def _checked_signals(signals: Mapping[str, Array], count: int) -> Mapping[str, Array]:
    """Return read-only copies of signals (N,) by names that can be columns."""
    kept: dict[str, Array] = {}
    for name, values in signals.items():
        if not name.isidentifier() or name in RECORD_COLUMNS:
            raise ShapeError(f"a signal needs a name of its own, such as 'intrusion', got '{name}'")
        rows = np.array(values, dtype=float)
        if rows.shape != (count,):
            raise ShapeError(f"signal {name} must have shape ({count},), got {rows.shape}")
        rows.setflags(write=False)
        kept[name] = rows
    return MappingProxyType(kept)
