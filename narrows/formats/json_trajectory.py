"""Trajectories as JSON: `narrows-trajectory/1`, and plain lists of poses."""

from __future__ import annotations

import json
from pathlib import Path as FilePath
from typing import Any, NoReturn

import numpy as np

from ..errors import TrajectoryError
from ..files import write_whole
from ..path import Path
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from .columns import COLUMNS, as_motion, column_indices, number, read_text, written_rows

FORMAT = "narrows-trajectory/1"
_ALLOWED = (
    'an object with "columns" and "rows", a list of [x, y, heading], '
    'or a list of {"x", "y", "heading"}'
)


def read_json(file: FilePath | str) -> Trajectory | Path:
    """Return the motion in a JSON file; a trajectory if it has times, else a path.

    Read are `{"columns": [...], "rows": [[...], ...]}`, lists of `[x, y, heading]`, and lists of
    objects `{"x": ..., "y": ..., "heading": ...}`, with `t` where they have it.

    Raises:
        TrajectoryError: If the file cannot be used; says file, line or field, value.
    """
    name = str(file)
    document = _parse(read_text(file), name)
    if isinstance(document, dict):
        return _from_table(document, name)
    if isinstance(document, list) and document and all(isinstance(r, dict) for r in document):
        return _from_objects(document, name)
    if isinstance(document, list):
        return _from_rows(document, ["x", "y", "heading"], name, "")
    raise TrajectoryError(
        "this JSON is no trajectory", file=name, value=type(document).__name__, allowed=_ALLOWED
    )


def write_json(trajectory: Trajectory, file: FilePath | str, *, vehicle: Vehicle) -> None:
    """Write a trajectory as `narrows-trajectory/1`, one row a line, whole or not at all.

    Raises:
        InputError: If the file cannot be written there.
    """
    head = {"format": FORMAT, "vehicle": vehicle.name, "columns": list(COLUMNS)}
    fields = [f"  {json.dumps(key)}: {json.dumps(value)}," for key, value in head.items()]
    rows = [f"    [{', '.join(row)}]" for row in written_rows(trajectory, vehicle)]
    text = "\n".join(["{", *fields, '  "rows": [', ",\n".join(rows), "  ]", "}"])
    write_whole(file, text + "\n")


def _parse(text: str, name: str) -> Any:
    def refuse(constant: str) -> NoReturn:
        raise TrajectoryError("this number is not finite", file=name, value=constant)

    try:
        return json.loads(text, parse_constant=refuse)
    except json.JSONDecodeError as error:
        problem = f"this is not JSON: {error.msg}"
        raise TrajectoryError(problem, file=name, line=error.lineno) from error
    except TrajectoryError:
        raise
    except (ValueError, RecursionError) as error:  # numbers of thousands of digits, deep nesting
        raise TrajectoryError("this JSON is no trajectory", file=name, allowed=_ALLOWED) from error


def _from_table(document: dict[str, Any], name: str) -> Trajectory | Path:
    known = document.get("format", FORMAT)
    if known != FORMAT:
        problem = "this is another format"
        raise TrajectoryError(problem, file=name, field="format", value=known, allowed=FORMAT)
    columns, rows = document.get("columns"), document.get("rows")
    if not isinstance(columns, list) or not all(isinstance(c, str) for c in columns):
        raise TrajectoryError(
            "the names of the columns are missing",
            file=name,
            field="columns",
            value=columns,
            allowed=f"such as {json.dumps(COLUMNS[:4])}",
        )
    if not isinstance(rows, list):
        raise TrajectoryError("the rows are missing", file=name, field="rows", allowed=_ALLOWED)
    return _from_rows(rows, columns, name, "rows")


def _from_objects(objects: list[dict[str, Any]], name: str) -> Trajectory | Path:
    columns = list(objects[0])
    for index, entry in enumerate(objects):
        if entry.keys() != objects[0].keys():
            raise TrajectoryError(
                "the fields differ from the first row's",
                file=name,
                field=f"[{index}]",
                value=", ".join(entry),
                allowed=", ".join(columns),
            )
    rows = [[entry[column] for column in columns] for entry in objects]
    return _from_rows(rows, columns, name, "")


def _from_rows(rows: list[Any], columns: list[str], name: str, field: str) -> Trajectory | Path:
    wanted = column_indices(columns, name, None)
    table = []
    for index, row in enumerate(rows):
        place = f"{field}[{index}]"
        if not isinstance(row, list) or len(row) != len(columns):
            found = f"{len(row)} values" if isinstance(row, list) else row
            raise TrajectoryError(
                "a row is as long as its columns are many",
                file=name,
                field=place,
                value=found,
                allowed=f"[{', '.join(columns)}]",
            )
        table.append(
            [
                number(row[at], column, name, None, f"{place}.{column}")
                for column, at in wanted.items()
            ]
        )
    return as_motion(np.array(table), list(wanted), name, None)
