"""The file a study writes into while it runs: one SQLite row a case, committed as it ends.

Three tables: `cases` (one row a case; every key, case and result column is a column, results are
added as they first appear), `columns` (name and kind, in order) and `design` (what the table is a
table of). Integers, floats and texts are stored as they are, infinities as SQLite's, booleans as
0 and 1. NaN becomes NULL, because SQLite has none and NULL is what its aggregates leave out; the
names of the columns that were NaN stand in `nan`, so reading brings them back.
"""

from __future__ import annotations

import contextlib
import json
import math
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import Self

from ..errors import StudyError
from .case import Case, Outcome, Scalar
from .lock import sole_writer
from .provenance import versions
from .table import DONE, FAILED, OUTCOME_COLUMNS, RUN_COLUMNS, Row, Table

_FORMAT = "1"
_OWN_COLUMNS = (*OUTCOME_COLUMNS, *RUN_COLUMNS, "nan")
_ANOTHER = "start anew without --resume (the old table is kept beside it), or give another --out"


@dataclass(frozen=True)
class Design:
    """What a table is a table of; two that differ cannot share a file.

    Attributes:
        keys: Names of the columns that identify a case.
        function: Name of the function that computes a row.
        version: The study's own version.
        seed: The sweep's seed.
    """

    keys: tuple[str, ...]
    function: str
    version: str
    seed: int

    def described(self) -> dict[str, str]:
        """Return the parts as texts by name, as they are stored."""
        return {
            "format": _FORMAT,
            "keys": ", ".join(self.keys),
            "function": self.function,
            "version": self.version,
            "seed": str(self.seed),
        }


class Store:
    """A study's table on disk, open for writing; use it in a `with` block."""

    def __init__(self, file: Path, design: Design, *, resume: bool) -> None:
        """Open the file, or begin it.

        Args:
            file: The SQLite file; folders on the way are made.
            design: What the table is to be a table of.
            resume: Continue a table that is there; otherwise it is renamed to
                `NAME.previous` (replacing an earlier one) and a new one begun.

        Raises:
            StudyError: If the file cannot be used, is being written by another process, or
                holds a table of another design.
        """
        self._file = file
        self._design = design
        with contextlib.ExitStack() as opened:
            opened.enter_context(_explained(file))
            file.parent.mkdir(parents=True, exist_ok=True)
            opened.enter_context(sole_writer(file))
            if not resume:
                _set_aside(file)
            self._connection = sqlite3.connect(file, timeout=30.0, isolation_level=None)
            opened.callback(self._connection.close)
            self._begin()
            self._opened = opened.pop_all()

    def __enter__(self) -> Self:
        """Return the store."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the file and let others write it."""
        self._opened.__exit__(kind, error, trace)

    def write(self, case: Case, outcome: Outcome) -> Outcome:
        """Write the row of one case, replacing the one it has; return the outcome written.

        An outcome whose columns clash with the table's is written as a failure that says so.
        """
        clash = self._clash(case, outcome.values or {})
        if clash:
            reason = f"result column {clash!r} has the name of another column"
            outcome = replace(outcome, values=None, reason=reason)
        with _explained(self._file), self._connection:
            self._connection.execute("BEGIN IMMEDIATE")
            self._add_columns(case, "case")
            self._add_columns(outcome.values or {}, "result")
            row = {**case, **(outcome.values or {}), **self._bookkeeping(outcome)}
            row["nan"] = json.dumps([name for name, value in row.items() if _is_nan(value)])
            names = ", ".join(f'"{name}"' for name in row)
            marks = ", ".join("?" for _ in row)
            values = [None if _is_nan(value) else value for value in row.values()]
            self._connection.execute(
                f"INSERT OR REPLACE INTO cases ({names}) VALUES ({marks})", values
            )
        return outcome

    def table(self) -> Table:
        """Return all rows in the file."""
        with _explained(self._file):
            return _read(self._connection)

    def _begin(self) -> None:
        """Make the three tables, or check that they are ours and of this design."""
        execute = self._connection.execute
        # Write-ahead log: a killed process loses nothing committed, readers never wait.
        execute("PRAGMA journal_mode = WAL")
        execute("PRAGMA synchronous = NORMAL")
        with self._connection:
            execute("BEGIN IMMEDIATE")
            if _table_names(self._connection):
                _check_design(self._connection, self._design, self._file)
                return
            keys = ", ".join(f'"{name}" NOT NULL' for name in self._design.keys)
            primary = ", ".join(f'"{name}"' for name in self._design.keys)
            own = ", ".join(_OWN_COLUMNS)
            execute(f"CREATE TABLE cases ({keys}, {own}, PRIMARY KEY ({primary}))")
            execute("CREATE TABLE columns (name PRIMARY KEY, kind NOT NULL)")
            execute("CREATE TABLE design (name PRIMARY KEY, value NOT NULL)")
            write_many = self._connection.executemany
            write_many("INSERT INTO design VALUES (?, ?)", self._design.described().items())
            write_many("INSERT INTO columns VALUES (?, 'key')", [(k,) for k in self._design.keys])

    def _add_columns(self, values: Iterable[str], kind: str) -> None:
        """Add the columns the table does not have yet."""
        known = _kinds(self._connection)
        for name in values:
            if name not in known:
                self._connection.execute(f'ALTER TABLE cases ADD COLUMN "{name}"')
                self._connection.execute("INSERT INTO columns VALUES (?, ?)", (name, kind))

    def _clash(self, case: Case, values: Mapping[str, Scalar]) -> str:
        """Return a result column that cannot be one, or an empty text."""
        kinds = _kinds(self._connection)
        taken = {name.lower(): name for name, kind in kinds.items() if kind == "result"}
        others = {name.lower() for name in (*case, *_OWN_COLUMNS)}
        others |= {name.lower() for name, kind in kinds.items() if kind != "result"}
        for name in values:
            if name.lower() in others or taken.setdefault(name.lower(), name) != name:
                return name
        return ""

    def _bookkeeping(self, outcome: Outcome) -> Row:
        return {
            "status": DONE if outcome.is_done else FAILED,
            "reason": outcome.reason,
            "seed": self._design.seed,
            "started": outcome.started,
            "wall_s": outcome.wall_s,
            "cpu_s": outcome.cpu_s,
            "machine": outcome.machine,
            "versions": json.dumps(versions()),
        }


def read_table(file: Path) -> Table:
    """Return all rows of a study's SQLite file; it may still be running.

    Raises:
        StudyError: If there is no such file, or it is not a study's table.
    """
    if not file.is_file():
        raise StudyError("there is no such table", file=str(file))
    with _explained(file), contextlib.closing(sqlite3.connect(file, timeout=30.0)) as connection:
        if "design" not in _table_names(connection):
            raise StudyError("the file is not a study's table", file=str(file))
        return _read(connection)


def reserved_columns() -> tuple[str, ...]:
    """Return the names that cases and results may not use: the table's own."""
    return _OWN_COLUMNS


def _read(connection: sqlite3.Connection) -> Table:
    kinds = _kinds(connection)
    names = [name for kind in ("key", "case", "result") for name in kinds if kinds[name] == kind]
    names += [*OUTCOME_COLUMNS, *RUN_COLUMNS]
    quoted = ", ".join(f'"{name}"' for name in names)
    rows = []
    for *values, nan in connection.execute(f"SELECT {quoted}, nan FROM cases"):
        row = dict(zip(names, values, strict=True))
        row.update(dict.fromkeys(json.loads(nan), math.nan))
        rows.append(row)
    keys = tuple(name for name in names if kinds.get(name) == "key")
    return Table(keys, tuple(names), tuple(rows))


def _check_design(connection: sqlite3.Connection, design: Design, file: Path) -> None:
    if "design" not in _table_names(connection):
        raise StudyError("the file is not a study's table", file=str(file), allowed=_ANOTHER)
    stored = dict(connection.execute("SELECT name, value FROM design"))
    for name, wanted in design.described().items():
        if stored.get(name) != wanted:
            raise StudyError(
                f"the table was made with {name} {stored.get(name)!r}, not {wanted!r}; {_ANOTHER}",
                file=str(file),
            )


def _table_names(connection: sqlite3.Connection) -> set[str]:
    return {name for (name,) in connection.execute("SELECT name FROM sqlite_master")}


def _kinds(connection: sqlite3.Connection) -> dict[str, str]:
    """Return the kind of each column by name, in the order they were added."""
    return dict(connection.execute("SELECT name, kind FROM columns ORDER BY rowid"))


def _is_nan(value: Scalar) -> bool:
    return isinstance(value, float) and math.isnan(value)


def _set_aside(file: Path) -> None:
    """Rename a table, with the log a killed run leaves beside it, to `NAME.previous`."""
    for ending in ("", "-wal", "-shm"):
        old, kept = Path(f"{file}{ending}"), Path(f"{file}.previous{ending}")
        kept.unlink(missing_ok=True)
        if old.exists():
            old.rename(kept)


@contextlib.contextmanager
def _explained(file: Path) -> Iterator[None]:
    """Turn errors of SQLite and of the file system into a StudyError that names the file."""
    try:
        yield
    except (sqlite3.Error, OSError) as error:
        is_other_file = not isinstance(error, OSError | sqlite3.OperationalError)
        advice = f"; {_ANOTHER}" if is_other_file else ""
        raise StudyError(f"the table cannot be used: {error}{advice}", file=str(file)) from error
