"""The driving-assistant study's tables of the course: Table III beside the paper's, and tests."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .assistant_drives import HOSTILE
from .assistant_paper import (
    ABORTED,
    CONDITIONS,
    RUNS,
    TABLE_III,
    column,
    mean,
    mean_speed,
    paired,
)
from .report import markdown_table
from .statistics import mean_interval, wilson_interval
from .table import Row, Table

_COLUMNS = ("time_s", "distance_m", "collisions")
_FIGURES = (("t", "time_s", "time [s]"), ("d", "distance_m", "distance [m]"))


def of_run(table: Table, run: str) -> list[Row]:
    """Return the rows of a test run, I to IV, without the hostile driver's."""
    device, assisted = CONDITIONS[run]
    return [
        row
        for row in table.done.rows
        if row["device"] == device
        and bool(row["assisted"]) == assisted
        and row["driver"] != HOSTILE
    ]


def numbers(rows: Sequence[Row], name: str) -> list[float]:
    """Return a column of rows as numbers."""
    return [float(row[name] or 0.0) for row in rows if row[name] is not None]


def table_three(table: Table) -> str:
    """Return one drive of each of our drivers in each test run, in the form of Table III.

    The last line has the means of the drives above it.
    """
    lines: list[dict[str, Any]] = []
    means: dict[str, Any] = {"driver": "mean"}
    for name in dict.fromkeys(str(row["driver"]) for row in of_run(table, "I")):
        line: dict[str, Any] = {"driver": name}
        for run in RUNS:
            row = next(r for r in of_run(table, run) if r["driver"] == name and r["run"] == 0)
            _fill(line, run, row["time_s"], row["distance_m"], row["collisions"])
            if not row["arrived"]:
                line[f"t{run}"] = f"{line[f't{run}']:.2f}*"
        lines.append(line)
    for run in RUNS:
        first = [row for row in of_run(table, run) if row["run"] == 0]
        _fill(means, run, *(mean(numbers(first, name)) for name in _COLUMNS))
    return _three([*lines, means])


def paper_three() -> str:
    """Return Table III of the paper, the means recomputed."""
    lines: list[dict[str, Any]] = []
    for name, row in TABLE_III.items():
        line: dict[str, Any] = {"driver": name}
        for run, (time, distance, hits) in zip(RUNS, row, strict=True):
            _fill(line, run, time, distance, hits)
            if (name, run) == ABORTED:
                line |= {f"t{run}": f"{time}*", f"d{run}": f"{distance}*", f"c{run}": None}
        lines.append(line)
    means: dict[str, Any] = {"driver": "mean, recomputed"}
    for run in RUNS:
        _fill(means, run, *(mean(column(run, which)) for which in range(3)))
    return _three([*lines, means])


def _fill(line: dict[str, Any], run: str, time: Any, distance: Any, hits: Any) -> None:
    line |= {f"t{run}": time, f"d{run}": distance, f"c{run}": hits}


def _three(lines: Sequence[dict[str, Any]]) -> str:
    columns = {"driver": "driver"}
    formats: dict[str, str] = {}
    for run in RUNS:
        columns |= {f"t{run}": f"t{run} [s]", f"d{run}": f"d{run} [m]", f"c{run}": f"c{run}"}
        formats |= {f"t{run}": ".2f", f"d{run}": ".2f", f"c{run}": ".3g"}
    return markdown_table(lines, columns, formats)


def means_table(table: Table, seed: int) -> str:
    """Return the means of all drives with intervals, the paper's recomputed beside them."""
    lines = []
    for run in RUNS:
        rows = of_run(table, run)
        hits = sum(1 for row in rows if row["collisions"])
        rate = wilson_interval(hits, len(rows))
        touched = [value > 0 for value in column(run, 2)]
        pairs = zip(numbers(rows, "distance_m"), numbers(rows, "time_s"), strict=True)
        speeds = [way / time for way, time in pairs]
        line: dict[str, Any] = {
            "run": f"{run}: {CONDITIONS[run][0]}, {'assisted' if CONDITIONS[run][1] else 'alone'}",
            "hits": f"{hits} of {len(rows)}, {rate.low:.1%} to {rate.high:.1%}",
            "paper_hits": f"{sum(touched)} of {len(touched)}",
            "arrived": f"{sum(1 for row in rows if row['arrived'])} of {len(rows)}",
            "speed": mean(speeds),
            "paper_speed": mean_speed(run),
        }
        for which, (letter, name, _) in enumerate(_FIGURES):
            line[letter] = mean_of(numbers(rows, name), seed)
            line[f"paper_{letter}"] = mean(column(run, which))
        lines.append(line)
    columns = {
        "run": "run",
        "t": "time [s]",
        "paper_t": "paper",
        "d": "distance [m]",
        "paper_d": "paper",
        "speed": "speed [m/s]",
        "paper_speed": "paper",
        "hits": "drives that touched",
        "paper_hits": "paper",
        "arrived": "arrived",
    }
    formats = {"paper_t": ".2f", "paper_d": ".2f", "speed": ".3f", "paper_speed": ".3f"}
    return markdown_table(lines, columns, formats)


def mean_of(values: Sequence[float], seed: int) -> str:
    """Return a mean with its 95 % interval by bootstrap, for people."""
    if len(values) < 2:
        return f"{values[0]:.4g}" if values else "–"
    return str(mean_interval(values, rng=np.random.default_rng(seed)))


def tests_table(table: Table) -> str:
    """Return what assistance changes, paired by driver, with the tests' p values."""
    from scipy import stats

    lines = []
    for alone, assisted in (("I", "II"), ("III", "IV")):
        for which, (letter, name, title) in enumerate(_FIGURES):
            ours = [_by_driver(table, run, name) for run in (alone, assisted)]
            theirs = paired(alone, assisted, which)
            line = {"what": f"{title}, {letter}{alone} to {letter}{assisted}"}
            for label, (before, after) in (("ours", ours), ("paper", theirs)):
                change = mean(after) / mean(before) - 1.0
                p = float(stats.wilcoxon(before, after).pvalue) if len(before) > 1 else np.nan
                line |= {label: f"{change:+.1%}", f"{label}_p": f"{p:.3f}"}
            lines.append(line)
    hits = [hits_of(table, runs) for runs in (("I", "III"), ("II", "IV"))]
    p = float(stats.fisher_exact(np.array(hits)).pvalue)
    theirs_p = float(stats.fisher_exact(np.array([[5, 10], [0, 16]])).pvalue)
    lines.append(
        {
            "what": "drives that touched, alone to assisted",
            "ours": f"{hits[0][0]} of {sum(hits[0])} to {hits[1][0]} of {sum(hits[1])}",
            "ours_p": f"{p:.2g}",
            "paper": "5 of 15 to 0 of 16",
            "paper_p": f"{theirs_p:.3f}",
        }
    )
    columns = {"what": "change", "ours": "ours", "ours_p": "p", "paper": "paper", "paper_p": "p"}
    return markdown_table(lines, columns)


def _by_driver(table: Table, run: str, name: str) -> list[float]:
    """Return the mean of a column for each driver, in the drivers' order."""
    rows = of_run(table, run)
    drivers = sorted({str(row["driver"]) for row in rows})
    return [mean(numbers([r for r in rows if r["driver"] == one], name)) for one in drivers]


def hits_of(table: Table, runs: Sequence[str]) -> list[int]:
    """Return how many drives of some test runs touched, and how many did not."""
    rows = [row for run in runs for row in of_run(table, run)]
    hits = sum(1 for row in rows if row["collisions"])
    return [hits, len(rows) - hits]
