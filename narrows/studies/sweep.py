"""The engine of every study: cases times a function, into a table that survives what happens."""

from __future__ import annotations

import contextlib
import functools
import json
import logging
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from tqdm import tqdm

from ..errors import StudyError
from .case import Case, CaseFunction, Scalar, Task, case_identity, plain_case
from .executors import Executor, InProcess, LocalProcesses
from .provenance import versions
from .store import Design, Store, reserved_columns
from .table import DONE, Row, Table

_log = logging.getLogger(__name__)


def sweep(
    cases: Sequence[Mapping[str, Any]],
    function: CaseFunction,
    *,
    table: Path,
    keys: Sequence[str],
    jobs: int = 1,
    seed: int = 0,
    resume: bool = True,
    retry_failures: bool = True,
    timeout_s: float | None = None,
    version: str = "1",
    progress: bool = True,
    executor: Executor | None = None,
) -> Table:
    """Run a function on every case and return the table of results, one row a case.

    Each row is committed to an SQLite file as its case ends, so a run that is killed loses only
    the cases it had not finished. A case that raises, whose worker dies or that runs out of time
    is a row too, with `status` failed and the reason; the other cases are not touched by it.

    A case's random generator depends on the seed and the case's keys alone, so the results are
    the same in any order, with any number of jobs, in one go or resumed.

    Args:
        cases: The cases, columns by name; values are numbers, texts, booleans or None.
        function: Called with a case and its `numpy.random.Generator`; returns the result
            columns by name, scalars too. With workers it must stand at the top level of a module.
        table: The SQLite file.
        keys: Names of the columns that identify a case.
        jobs: Worker processes; 1 runs in this process unless there is a time limit.
        seed: Seed of every case's random generator, >= 0.
        resume: Continue the table that is there: cases that are done, with the same other
            columns, are not run again. Otherwise the old file is renamed to `NAME.previous`.
        retry_failures: Whether resuming runs the failed cases again.
        timeout_s: Wall time after which a case is stopped and fails [s], or None.
        version: The study's own version; raise it when the results change their meaning.
        progress: Show a bar on standard error once the run takes longer than two seconds.
        executor: Runs the cases instead of this process or its workers (`jobs` and `timeout_s`
            are then its own business).

    Returns:
        The rows of these cases; the file may hold more, from earlier runs with other cases.

    Raises:
        StudyError: If the cases or options are wrong, or the table in the file is of other
            keys, another function, version or seed.
    """
    keys = tuple(keys)
    _check_options(keys, jobs, seed, timeout_s)
    wanted = _identified(cases, keys)
    task = Task(function, keys, seed)
    run = executor or _default_executor(jobs, timeout_s)
    design = Design(keys, _function_name(function), version, seed)
    with Store(table, design, resume=resume) as store:
        waiting = _unfinished(wanted, store.table(), retry_failures)
        with (
            _progress_bar(len(wanted), len(waiting), progress) as bar,
            contextlib.closing(run.outcomes(task, waiting)) as outcomes,
        ):
            for index, outcome in outcomes:
                store.write(waiting[index], outcome)
                bar.update()
        found = store.table().select(lambda row: case_identity(row, keys) in wanted)
    _warn(found)
    return found


def _check_options(keys: tuple[str, ...], jobs: int, seed: int, timeout_s: float | None) -> None:
    if not keys or len(set(keys)) != len(keys):
        raise StudyError("a sweep needs key columns, each once", field="keys", value=keys)
    if jobs < 1:
        raise StudyError("no process to run on", field="jobs", value=jobs, allowed=">= 1")
    if seed < 0:
        raise StudyError("the seed is negative", field="seed", value=seed, allowed=">= 0")
    if timeout_s is not None and not timeout_s > 0.0:
        raise StudyError("no time", field="timeout_s", value=timeout_s, allowed="> 0 or None")


def _identified(
    cases: Sequence[Mapping[str, Any]], keys: tuple[str, ...]
) -> dict[str, dict[str, Scalar]]:
    """Return the cases as plain scalars by their identity, in their order."""
    identified: dict[str, dict[str, Scalar]] = {}
    for number, given in enumerate(cases):
        case = plain_case(given)
        taken = sorted({name.lower() for name in case} & {*reserved_columns()})
        if taken:
            raise StudyError("the table needs this column itself", field=taken[0])
        identity = case_identity(case, keys)
        if identity in identified:
            named = {name: case[name] for name in keys}
            raise StudyError(f"case {number} has the keys of an earlier one", value=named)
        identified[identity] = case
    return identified


def _unfinished(
    wanted: Mapping[str, Mapping[str, Scalar]], stored: Table, retry_failures: bool
) -> list[Case]:
    """Return the cases that have no row to keep, in their order."""
    rows = {case_identity(row, stored.keys): row for row in stored.rows}
    kept = {
        identity
        for identity, case in wanted.items()
        if identity in rows
        and _has_values(rows[identity], case)
        and (rows[identity]["status"] == DONE or not retry_failures)
    }
    return [case for identity, case in wanted.items() if identity not in kept]


def _has_values(row: Row, case: Mapping[str, Scalar]) -> bool:
    """Whether a row was computed from exactly this case; NaN equals NaN here."""
    return all(name in row and repr(row[name]) == repr(_stored(case[name])) for name in case)


def _stored(value: Scalar) -> Scalar:
    """Return a value as it comes back from the table: booleans as 0 and 1."""
    return int(value) if isinstance(value, bool) else value


def _default_executor(jobs: int, timeout_s: float | None) -> Executor:
    """Return this process for one job, workers for more or where a case must be stopped."""
    if jobs == 1 and timeout_s is None:
        return InProcess()
    return LocalProcesses(jobs, timeout_s)


def _function_name(function: Callable[..., Any]) -> str:
    while isinstance(function, functools.partial):
        function = function.func
    return getattr(function, "__qualname__", type(function).__qualname__)


def _progress_bar(total: int, waiting: int, progress: bool) -> tqdm[Any]:
    """Return a bar over all cases, begun at those that are done already."""
    return tqdm(
        total=total,
        initial=total - waiting,
        disable=not progress,
        file=sys.stderr,
        unit="case",
        delay=2.0,
        mininterval=0.5 if sys.stderr.isatty() else 10.0,
        dynamic_ncols=True,
    )


def _warn(found: Table) -> None:
    """Log how many cases failed, and whether rows come from other versions than these."""
    failed = found.failed
    if failed:
        row = failed.rows[0]
        named = ", ".join(f"{name}={row[name]}" for name in found.keys)
        _log.warning(
            "%d of %d cases failed, first %s: %s", len(failed), len(found), named, row["reason"]
        )
    others = {row["versions"] for row in found.rows} - {json.dumps(versions())}
    if others:
        _log.warning("some rows were made with other versions: %s", "; ".join(map(str, others)))
