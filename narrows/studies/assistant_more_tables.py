"""The driving-assistant study's tables besides the course: doors, faults, people, the map."""

from __future__ import annotations

from typing import Any

import numpy as np

from .assistant_doors import HELP
from .assistant_faults import TROUBLES
from .assistant_paper import RUNS, mean
from .assistant_people import GAPS, WALKS
from .assistant_tables import mean_of, numbers, of_run
from .report import markdown_table
from .statistics import wilson_interval
from .table import Table


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
                "time": mean_of(numbers(done, "time_s"), seed),
                "distance": mean_of(numbers(done, "distance_m"), seed),
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
