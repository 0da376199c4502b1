"""One case of a study: its scalars, its identity, its random numbers, its outcome."""

from __future__ import annotations

import hashlib
import json
import math
import os
import time
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np

from ..errors import StudyError
from .provenance import machine

Scalar = str | int | float | bool | None
Case = Mapping[str, Scalar]
CaseFunction = Callable[[Case, np.random.Generator], Mapping[str, Any]]

_LARGEST_INTEGER = 2**63 - 1  # what a table cell holds


def plain_scalar(name: str, value: Any) -> Scalar:
    """Return a value as a plain Python scalar; NumPy scalars become the Python ones they equal.

    Raises:
        StudyError: If the value is not a number, text, boolean or None, or cannot be stored.
    """
    plain = value.item() if isinstance(value, np.generic) else value
    if plain is None or isinstance(plain, bool):
        return plain
    if isinstance(plain, int) and abs(plain) <= _LARGEST_INTEGER:
        return int(plain)
    if isinstance(plain, float):
        return float(plain)
    if isinstance(plain, str) and _is_unicode(plain):
        return str(plain)
    raise StudyError(
        "a column holds one scalar",
        field=name,
        value=value,
        allowed="a number (integers up to 64 bits), a text, a boolean or None",
    )


def plain_case(values: Mapping[str, Any]) -> dict[str, Scalar]:
    """Return named values as plain scalars.

    Raises:
        StudyError: If it is not a mapping, a name is no identifier or a value no scalar.
    """
    if not isinstance(values, Mapping):
        raise StudyError("expected columns by name", value=values, allowed="a mapping")
    for name in values:
        if not (isinstance(name, str) and name.isidentifier() and name.isascii()):
            raise StudyError(
                "a column's name must read like a variable's", value=name, allowed="clearance_m"
            )
    return {name: plain_scalar(name, value) for name, value in values.items()}


def case_identity(case: Case, keys: tuple[str, ...]) -> str:
    """Return the text that identifies a case: its key columns, whatever their order.

    Numbers that are equal are the same key: 1, 1.0 and True.

    Raises:
        StudyError: If a key column is missing, None or NaN.
    """
    parts = []
    for name in sorted(keys):
        if name not in case:
            raise StudyError("a case lacks a key column", field=name, value=dict(case))
        value = case[name]
        if value is None or (isinstance(value, float) and math.isnan(value)):
            raise StudyError("a key must equal itself", field=name, value=str(value))
        parts.append((name, _canonical(value)))
    return json.dumps(parts)


def case_generator(seed: int, identity: str) -> np.random.Generator:
    """Return the random generator of one case, the same in any order and any process.

    Args:
        seed: The sweep's seed, >= 0.
        identity: The case's, from `case_identity`.
    """
    digest = hashlib.sha256(identity.encode()).digest()
    words = tuple(int.from_bytes(digest[k : k + 4], "big") for k in range(0, 16, 4))
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=words))


@dataclass(frozen=True)
class Outcome:
    """What became of one case.

    Attributes:
        values: The result columns, or None when the case failed.
        reason: Why it failed: the exception's type, message and place, `worker killed ...` or
            `timed out after ...`; empty when it succeeded.
        started: When it started, ISO 8601 in UTC.
        wall_s: How long it took [s].
        cpu_s: Processor time of the process that ran it [s]; None if it took that with it.
        machine: Where it ran.
    """

    values: dict[str, Scalar] | None
    reason: str
    started: str
    wall_s: float
    cpu_s: float | None
    machine: str

    @property
    def is_done(self) -> bool:
        """Whether the case has a result."""
        return self.values is not None


@dataclass(frozen=True)
class Task:
    """A study's function with what every case needs; called in the process that runs the case.

    Attributes:
        function: Called with a case and its random generator; returns the result columns.
        keys: Names of the columns that identify a case.
        seed: The sweep's seed, >= 0.
    """

    function: CaseFunction
    keys: tuple[str, ...]
    seed: int

    def __call__(self, case: Case) -> Outcome:
        """Run one case; whatever it raises becomes the reason of a failed outcome."""
        generator = case_generator(self.seed, case_identity(case, self.keys))
        started, wall, cpu = timestamp(), time.perf_counter(), time.process_time()
        values: dict[str, Scalar] | None = None
        reason = ""
        try:
            values = plain_case(self.function(dict(case), generator))
        except (Exception, SystemExit) as error:
            # The one place where anything may be caught: a case's failure is a row of the table.
            reason = _failure(error)
        return Outcome(
            values=values,
            reason=reason,
            started=started,
            wall_s=time.perf_counter() - wall,
            cpu_s=time.process_time() - cpu,
            machine=machine(),
        )


def timestamp() -> str:
    """Return the time now, ISO 8601 in UTC to the millisecond."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def _failure(error: BaseException) -> str:
    """Return an exception as one line: type, message, and the place it was raised at."""
    text = " ".join(str(error).split()).encode("utf-8", "backslashreplace").decode("utf-8")
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({os.path.basename(frames[-1].filename)}:{frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {text}{place}"


def _canonical(value: Scalar) -> str | int:
    """Return a value such that equal numbers give equal results, exactly."""
    if isinstance(value, str):
        return "text " + value
    if isinstance(value, float) and not value.is_integer():
        return repr(value)
    if isinstance(value, int | float):
        return int(value)
    raise StudyError("a key must be a number, a text or a boolean", value=value)


def _is_unicode(text: str) -> bool:
    """Whether a text can be written as UTF-8 (no lone surrogates)."""
    return text.encode("utf-8", "replace").decode("utf-8") == text
