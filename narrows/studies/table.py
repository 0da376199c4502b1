"""The results of a study: rows with named columns, in the order of their keys."""

from __future__ import annotations

import csv
import difflib
import io
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import StudyError
from ..files import write_whole
from .case import Scalar

DONE, FAILED = "done", "failed"
OUTCOME_COLUMNS = ("status", "reason")
RUN_COLUMNS = ("seed", "started", "wall_s", "cpu_s", "machine", "versions")

Row = dict[str, Scalar]


@dataclass(frozen=True, eq=False)
class Table:
    """Rows of a study, sorted by their keys; every row has every column, None where it has none.

    Attributes:
        keys: Names of the columns that identify a row.
        columns: All names: keys, other columns of the cases, results, `status` and `reason`,
            then what is known of each run (seed, started, wall_s, cpu_s, machine, versions).
        rows: Rows as dictionaries by column name.
    """

    keys: tuple[str, ...]
    columns: tuple[str, ...]
    rows: tuple[Row, ...]

    def __post_init__(self) -> None:
        """Sort the rows, numbers before texts."""
        ordered = sorted(self.rows, key=lambda row: [_rank(row[name]) for name in self.keys])
        object.__setattr__(self, "rows", tuple(ordered))

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.rows)

    @property
    def done(self) -> Table:
        """The rows that have a result."""
        return self.where(status=DONE)

    @property
    def failed(self) -> Table:
        """The rows that have a reason instead."""
        return self.where(status=FAILED)

    def where(self, **values: Scalar) -> Table:
        """Return the rows whose columns have these values.

        Raises:
            StudyError: If there is no such column.
        """
        for name in values:
            self._check_column(name)
        return self.select(lambda row: all(row[name] == value for name, value in values.items()))

    def select(self, wanted: Callable[[Row], bool]) -> Table:
        """Return the rows for which a function of the row is true."""
        return Table(self.keys, self.columns, tuple(row for row in self.rows if wanted(row)))

    def column(self, name: str) -> NDArray[np.float64] | NDArray[np.object_]:
        """Return one column, shape (N,), in the order of the rows.

        Numbers come as float64 with NaN where a row has none; a column with any text as objects.

        Raises:
            StudyError: If there is no such column.
        """
        self._check_column(name)
        values = [row[name] for row in self.rows]
        if any(isinstance(value, str) for value in values):
            return np.array(values, dtype=object)  # (N,)
        return np.array([math.nan if v is None else float(v) for v in values])  # (N,)

    def write_csv(self, file: Path, *, with_runs: bool = True) -> None:
        """Write the rows as CSV, replacing the file in one step.

        Floats are written so that they read back exactly; an empty cell is None.

        Args:
            file: Where to write.
            with_runs: Also write the columns that differ from run to run (times, machine,
                versions, seed). Without them the same study writes the same bytes again.

        Raises:
            InputError: If the file cannot be written there.
        """
        names = [name for name in self.columns if with_runs or name not in RUN_COLUMNS]
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(names)
        writer.writerows([_cell(row[name]) for name in names] for row in self.rows)
        write_whole(file, stream.getvalue())

    def _check_column(self, name: str) -> None:
        if name not in self.columns:
            near = difflib.get_close_matches(name, self.columns, n=1)
            hint = f"{near[0]}?" if near else ", ".join(self.columns)
            raise StudyError("the table has no such column", value=name, allowed=hint)


def read_csv(file: Path, keys: Sequence[str]) -> Table:
    """Read a table written by `Table.write_csv`.

    CSV knows no types: a cell that reads as a number is one, an empty cell is None.

    Raises:
        StudyError: If the file cannot be read or has no header with these keys.
    """
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise StudyError(f"the table cannot be read: {error}", file=str(file)) from error
    lines = list(csv.reader(io.StringIO(text)))
    header = lines[0] if lines else []
    missing = [name for name in keys if name not in header]
    if missing:
        raise StudyError("the table lacks key columns", file=str(file), line=1, value=missing)
    for number, line in enumerate(lines[1:], start=2):
        if len(line) != len(header):
            problem = f"the row has {len(line)} cells, the header {len(header)}"
            raise StudyError(problem, file=str(file), line=number)
    rows = (_parse_row(header, line) for line in lines[1:])
    return Table(tuple(keys), tuple(header), tuple(rows))


def _rank(value: Scalar) -> tuple[bool, float, str]:
    """Return what a key is sorted by: numbers first, by size, then texts."""
    if isinstance(value, str):
        return True, 0.0, value
    return False, -math.inf if value is None else float(value), ""


def _cell(value: Scalar) -> str:
    """Return a value as it stands in a CSV file."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    return repr(int(value) if isinstance(value, bool) else value)


def _parse_row(header: Iterable[str], cells: Iterable[str]) -> Row:
    return dict(zip(header, map(_parse_cell, cells), strict=True))


def _parse_cell(cell: str) -> Scalar:
    """Return a CSV cell as None, a number or a text."""
    if not cell:
        return None
    for number in (int, float):
        try:
            return number(cell)
        except ValueError:
            continue
    return cell
