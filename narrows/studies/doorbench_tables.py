"""From the rows of DoorBench, one a plan, to what is said of each planner and level."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .statistics import Interval, quantile_interval, wilson_interval
from .table import Row, Table

ALL = "all"

MEDIANS = {
    "plan_cpu_s": "CPU [s]",
    "length_m": "length [m]",
    "max_curvature": "max curvature [1/m]",
    "integral_k2": "integral of curvature² [1/m]",
    "curvature_jump": "curvature jump in 2 cm [1/m]",
    "clearance_mm": "clearance [mm]",
    "duration_s": "duration [s]",
    "peak_jerk": "peak jerk [m/s³]",
}
"""Columns whose median over the valid paths is told, with their headings."""


def summarise(
    table: Table, planners: Sequence[str], levels: Sequence[str], *, seed: int
) -> list[dict[str, Any]]:
    """Return one row for each planner and level, and one for each planner over all levels.

    Counts are exact. `valid_low` and `valid_high` are Wilson's interval of the share of valid
    plans; every median `NAME` of the valid ones comes with `NAME_low` and `NAME_high` (95 %,
    percentile bootstrap), None where fewer than two plans are valid. The CPU time is that of every
    attempt, successful or not, with its ninetieth percentile `plan_cpu_s_p90`.

    Args:
        table: Rows of the study.
        planners: Planners in the order of the rows wanted.
        levels: Levels, likewise.
        seed: Seed of the bootstrap.
    """
    rows = table.done.rows
    rng = np.random.default_rng(seed)
    summary = []
    for planner in planners:
        own = [row for row in rows if row["planner"] == planner]
        for level in [*levels, ALL] if len(levels) > 1 else levels:
            chosen = [row for row in own if level in (ALL, row["level"])]
            if chosen:
                summary.append({"planner": planner, "level": level, **_summary(chosen, rng)})
    return summary


def _summary(rows: Sequence[Row], rng: np.random.Generator) -> dict[str, Any]:
    valid = [row for row in rows if row["is_valid"]]
    share = wilson_interval(len(valid), len(rows))
    result: dict[str, Any] = {
        "scenes": len(rows),
        "claimed": sum(bool(row["is_claimed"]) for row in rows),
        "valid": len(valid),
        "invalid": sum(bool(row["is_claimed"]) and not row["is_valid"] for row in rows),
        "impassable": sum(str(row["answer"]).startswith("impassable") for row in rows),
        "valid_low": share.low,
        "valid_high": share.high,
    }
    for name in MEDIANS:
        chosen = rows if name == "plan_cpu_s" else valid
        values = [float(v) for row in chosen if (v := row[name]) is not None]
        middle = _quantile(values, rng, 0.5)
        result |= _columns(name, middle)
        if name == "plan_cpu_s":
            result |= _columns("plan_cpu_s_p90", _quantile(values, rng, 0.9))
    return result


def _quantile(values: Sequence[float], rng: np.random.Generator, quantile: float) -> Interval:
    if len(values) < 2:
        only = values[0] if values else np.nan
        return Interval(only, np.nan, np.nan, 0.95)
    return quantile_interval(values, rng=rng, quantile=quantile, resamples=2000)


def _columns(name: str, interval: Interval) -> dict[str, float | None]:
    ends = {name: interval.estimate, f"{name}_low": interval.low, f"{name}_high": interval.high}
    return {key: None if np.isnan(value) else value for key, value in ends.items()}


def with_interval(row: dict[str, Any], name: str, digits: str) -> str | None:
    """Return an estimate with its interval as a text, or None if there is none."""
    if row[name] is None:
        return None
    text = format(row[name], digits)
    if row[f"{name}_low"] is None:
        return text
    return f"{text} [{row[f'{name}_low']:{digits}}, {row[f'{name}_high']:{digits}}]"


def compare(table: Table, first: str, others: Sequence[str]) -> list[dict[str, Any]]:
    """Return medians of a planner and of others over the scenes that both solve.

    Args:
        table: Rows of the study.
        first: The planner compared.
        others: Those it is compared with.
    """
    solved = {
        planner: {row["scene"]: row for row in table.done.rows if _is_solved(row, planner)}
        for planner in (first, *others)
    }
    rows = []
    for other in others:
        common = sorted(solved[first].keys() & solved[other].keys(), key=str)
        if not common:
            continue
        row: dict[str, Any] = {"with": other, "scenes": len(common)}
        for name in ("integral_k2", "curvature_jump", "clearance_mm", "length_m", "duration_s"):
            for label, planner in (("ours", first), ("theirs", other)):
                values = [solved[planner][scene][name] for scene in common]
                known = [float(v) for v in values if v is not None]
                row[f"{name}_{label}"] = float(np.median(known)) if known else None
        rows.append(row)
    return rows


def _is_solved(row: Row, planner: str) -> bool:
    return row["planner"] == planner and bool(row["is_valid"])
