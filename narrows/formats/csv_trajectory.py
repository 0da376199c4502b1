"""Trajectories as CSV: `t,x,y,heading,v,omega,v_left,v_right`, SI and radians."""

from __future__ import annotations

import csv
import io
from pathlib import Path as FilePath

import numpy as np

from ..errors import TrajectoryError
from ..files import write_whole
from ..path import Path
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from .columns import COLUMNS, as_motion, column_indices, number, read_text, written_rows

_SEPARATORS = (",", ";", "\t")


def read_csv(file: FilePath | str) -> Trajectory | Path:
    """Return the motion in a CSV file; a trajectory if it has a column `t`, else a path.

    Commas, semicolons or tabs separate; lines that begin with `#` and empty ones are skipped.

    Raises:
        TrajectoryError: If the file cannot be used; says file, line, field, value.
    """
    name = str(file)
    reader = csv.reader(io.StringIO(text := read_text(file)), delimiter=_separator(text))
    header: list[str] = []
    wanted: dict[str, int] = {}
    rows: list[list[float]] = []
    lines: list[int] = []
    try:
        for cells in reader:
            if not cells or not "".join(cells).strip() or cells[0].lstrip().startswith("#"):
                continue
            line = reader.line_num
            if not header:
                header, wanted = cells, column_indices(cells, name, line)
                continue
            if len(cells) != len(header):
                raise TrajectoryError(
                    "the row and the header differ in length",
                    file=name,
                    line=line,
                    value=f"{len(cells)} values",
                    allowed=f"{len(header)}",
                )
            rows.append([number(cells[at], column, name, line) for column, at in wanted.items()])
            lines.append(line)
    except csv.Error as error:
        problem = f"this is not CSV: {error}"
        raise TrajectoryError(problem, file=name, line=reader.line_num) from error
    if not header:
        raise TrajectoryError("there is no header", file=name, allowed=",".join(COLUMNS))
    return as_motion(np.array(rows), list(wanted), name, lines)


def write_csv(trajectory: Trajectory, file: FilePath | str, *, vehicle: Vehicle) -> None:
    """Write a trajectory's rows as CSV of ten decimals, whole or not at all.

    Raises:
        InputError: If the file cannot be written there.
    """
    rows = [",".join(row) for row in written_rows(trajectory, vehicle)]
    write_whole(file, "\n".join([",".join(COLUMNS), *rows]) + "\n")


def _separator(text: str) -> str:
    """Return what separates the values: what the header holds most of."""
    lines = (line.strip() for line in io.StringIO(text))
    header = next((line for line in lines if line and not line.startswith("#")), "")
    return max(_SEPARATORS, key=header.count)
