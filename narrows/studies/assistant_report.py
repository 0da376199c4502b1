"""What the driving-assistant study says: Table III beside the paper's, tests, doors, faults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import assistant_texts as texts
from .assistant_doors import HELP
from .assistant_drives import HOSTILE
from .assistant_faults import TROUBLES
from .assistant_paper import (
    ABORTED,
    CONDITIONS,
    PRINTED_DISTANCE_III,
    RUNS,
    TABLE_III,
    column,
    mean,
    mean_speed,
    paired,
)
from .assistant_people import GAPS, WALKS
from .report import markdown_table
from .statistics import mean_interval, wilson_interval
from .table import Row, Table

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
    """Return one drive of each of our drivers in each test run, in the form of Table III."""
    lines: list[dict[str, Any]] = []
    for name in dict.fromkeys(str(row["driver"]) for row in of_run(table, "I")):
        line: dict[str, Any] = {"driver": name}
        for run in RUNS:
            row = next(r for r in of_run(table, run) if r["driver"] == name and r["run"] == 0)
            _fill(line, run, row["time_s"], row["distance_m"], row["collisions"])
            if not row["arrived"]:
                line[f"t{run}"] = f"{line[f't{run}']:.2f}*"
        lines.append(line)
    return _three(lines)


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
            line[letter] = _mean(numbers(rows, name), seed)
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


def _mean(values: Sequence[float], seed: int) -> str:
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
    hits = [_hits(table, runs) for runs in (("I", "III"), ("II", "IV"))]
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


def _hits(table: Table, runs: Sequence[str]) -> list[int]:
    rows = [row for run in runs for row in of_run(table, run)]
    hits = sum(1 for row in rows if row["collisions"])
    return [hits, len(rows) - hits]


def doors_table(table: Table, seed: int) -> str:
    """Return what came of the doors, by how they were driven."""
    lines = []
    for name in HELP:
        rows = [row for row in table.done.rows if row["help"] == name]
        if not rows:
            continue
        through = sum(1 for row in rows if row["succeeded"])
        rate = wilson_interval(through, len(rows))
        done = [row for row in rows if row["succeeded"]]
        lines.append(
            {
                "help": name,
                "success": f"{through} of {len(rows)}, {rate.low:.0%} to {rate.high:.0%}",
                "touched": sum(1 for row in rows if row["collisions"]),
                "time": _mean(numbers(done, "time_s"), seed),
                "distance": _mean(numbers(done, "distance_m"), seed),
                "clearance": float(np.median(numbers(done, "min_clearance_mm"))) if done else None,
                "share": mean(numbers(rows, "share_helped") or [0.0]),
            }
        )
    columns = {
        "help": "driven",
        "success": "through without touching",
        "touched": "touched",
        "time": "time [s]",
        "distance": "distance [m]",
        "clearance": "median least clearance [mm]",
        "share": "share of the time helped",
    }
    return markdown_table(lines, columns, {"clearance": ".0f", "share": ".0%"})


def troubles_table(table: Table) -> str:
    """Return what came of faults."""
    lines = []
    for name in TROUBLES:
        rows = [row for row in table.done.rows if row["trouble"] == name]
        if not rows:
            continue
        lines.append(
            {
                "trouble": name,
                "drives": len(rows),
                "arrived": sum(1 for row in rows if row["arrived"]),
                "touched": sum(1 for row in rows if row["collisions"]),
                "time": mean(numbers(rows, "time_s")),
                "clearance": min(numbers(rows, "min_clearance_mm")),
                "blind": max(numbers(rows, "blind_m")),
                "stands": sum(1 for row in rows if row["stands_at_end"]),
            }
        )
    columns = {
        "trouble": "what is wrong",
        "drives": "drives",
        "arrived": "arrived",
        "touched": "touched",
        "time": "mean time [s]",
        "clearance": "least clearance [mm]",
        "blind": "longest way unseeing [m]",
        "stands": "stood at the end",
    }
    return markdown_table(lines, columns, {"time": ".0f", "clearance": ".0f", "blind": ".2f"})


def people_table(table: Table) -> str:
    """Return what came of people in the way: touched while moving of all, by distance."""
    lines = []
    for walk in WALKS:
        line: dict[str, Any] = {"walk": walk}
        for gap in GAPS:
            rows = [r for r in table.done.rows if r["walk"] == walk and r["gap_m"] == gap]
            hits = sum(1 for row in rows if row["collisions"])
            line[f"gap{gap}"] = f"{hits} of {len(rows)}"
        lines.append(line)
    columns = {"walk": "somebody"} | {f"gap{gap}": f"{gap:g} m ahead" for gap in GAPS}
    return markdown_table(lines, columns)


def found_table(table: Table) -> str:
    """Return how well the drives were found in the map, by test run."""
    lines = []
    for run in RUNS:
        rows = of_run(table, run)
        if not rows:
            continue
        lines.append(
            {
                "run": run,
                "drives": len(rows),
                "mean": mean(numbers(rows, "mean_mm")),
                "p95": max(numbers(rows, "p95_mm")),
                "max": max(numbers(rows, "max_mm")),
                "heading": mean(numbers(rows, "heading_mean_deg")),
                "odometry": mean(numbers(rows, "odometry_mm")),
            }
        )
    columns = {
        "run": "run",
        "drives": "drives",
        "mean": "mean error [mm]",
        "p95": "95 % of the worst drive [mm]",
        "max": "greatest [mm]",
        "heading": "mean heading error [deg]",
        "odometry": "odometry alone, at the end [mm]",
    }
    formats = {"mean": ".0f", "p95": ".0f", "max": ".0f", "heading": ".2f", "odometry": ".0f"}
    return markdown_table(lines, columns, formats)


MISPRINT = f"""The paper prints a mean distance of {PRINTED_DISTANCE_III} m for run III; its table
gives 32.63 m with the aborted half run and {mean(column("III", 1)):.2f} m without. The means here
leave that run out; the changes are paired over the seven who finished both."""
"""What is to be known of the paper's own figures."""


@dataclass(frozen=True, eq=False)
class Results:
    """The study's tables.

    Attributes:
        course: Drives there and back.
        doors: Drives through doors.
        faults: Drives with faults.
        people: Meetings with people.
        found: Drives found in the learned map.
        grid: How far that map is wrong.
    """

    course: Table
    doors: Table
    faults: Table
    people: Table
    found: Table
    grid: Mapping[str, float]


def assistant_report(results: Results, seed: int) -> str:
    """Return the report, Markdown.

    Args:
        results: The study's tables.
        seed: Of the bootstrap.
    """
    grid = results.grid
    learned = (
        f"The map was learned on one slow drive; there the chair was {grid['pose_mean_mm']:.0f} mm "
        f"off on average, {grid['pose_max_mm']:.0f} mm at most, where odometry alone ended "
        f"{grid['drift_mm']:.0f} mm off. Half of the occupied cells lie within "
        f"{grid['wall_median_mm']:.0f} mm of a wall's surface, 95 % within "
        f"{grid['wall_95_mm']:.0f} mm."
    )
    parts = [
        "# Assisted driving",
        texts.SETUP,
        "## Findings",
        findings(results),
        "## Test runs, the first drive of each driver",
        table_three(results.course),
        "`*`: did not arrive. Table III of the paper, `*` aborted:",
        paper_three(),
        MISPRINT,
        "## All drives",
        means_table(results.course, seed),
        tests_table(results.course),
        texts.TESTS,
        "## Where they drove",
        "![tracks over the learned map](tracks.png)",
        texts.MAP,
        learned,
        found_table(results.found),
        "## Doors of 0.80 m",
        texts.DOORS,
        doors_table(results.doors, seed),
        "![doors by offset and approach angle](doors.png)",
        "## Faults",
        texts.FAULTS,
        troubles_table(results.faults),
        "## People",
        texts.PEOPLE,
        people_table(results.people),
    ]
    tables = (results.course, results.doors, results.faults, results.people, results.found)
    failed = [f"- {row['reason']}" for table in tables for row in table.failed.rows]
    if failed:
        parts += ["## Failed cases", "\n".join(failed)]
    return "\n\n".join(parts) + "\n"


def findings(results: Results) -> str:
    """Return what the tables say in a few lines."""
    course = results.course.done.rows
    assisted = [row for row in course if row["assisted"]]
    hostile = [row for row in assisted if row["driver"] == HOSTILE]
    helped = [row for row in results.doors.done.rows if row["help"] != "alone"]
    troubled = results.faults.done.rows
    everything = [*assisted, *helped, *troubled]
    hits = sum(1 for row in everything if row["collisions"])
    rate = wilson_interval(hits, len(everything))
    clearance = min(numbers(everything, "min_clearance_mm"))
    alone = _hits(results.course, ("I", "III"))
    lines = [
        f"- Assisted, {hits} of {len(everything)} drives touched anything that stands (95 %: "
        f"at most {rate.high:.2%}): {len(assisted)} on the course, {len(hostile)} of them by the "
        f"hostile driver, {len(helped)} through doors, {len(troubled)} with faults. The least "
        f"clearance of any was {clearance:.0f} mm.",
        f"- Alone, {alone[0]} of {sum(alone)} drives on the course touched "
        f"({alone[0] / sum(alone):.0%}); the paper's subjects 5 of 15 (33 %).",
    ]
    stuck = [row for row in assisted if row["driver"] != HOSTILE and not row["arrived"]]
    people = len(assisted) - len(hostile)
    lines.append(f"- {people - len(stuck)} of {people} assisted drives arrived within 400 s.")
    stays = [row for row in results.people.done.rows if row["walk"] != WALKS[-1]]
    met = sum(1 for row in stays if row["collisions"])
    lines.append(
        f"- Somebody who steps before a chair pushed forward, 0.6 m ahead or more, and stays or "
        f"crosses was touched in {met} of {len(stays)} meetings."
    )
    return "\n".join(lines)
