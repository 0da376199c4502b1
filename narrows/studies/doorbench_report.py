"""What DoorBench has to say, rendered from its tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .doorbench_planners import CONTESTANTS
from .doorbench_profile import Profile
from .doorbench_tables import ALL, compare, with_interval
from .provenance import machine, versions
from .report import markdown_table
from .table import Table

_TOUCHING = "narrows-1mm"  # ours with as little clearance as OBCA
_RESULTS = {
    "planner": "planner",
    "level": "level",
    "scenes": "scenes",
    "claimed": "claimed",
    "valid": "valid",
    "share": "valid, share",
    "invalid": "claimed but invalid",
    "impassable": "proven impassable",
}
_COST = {
    "planner": "planner",
    "level": "level",
    "cpu": "CPU median [s]",
    "cpu_p90": "CPU p90 [s]",
}
_QUALITY = {
    "planner": "planner",
    "level": "level",
    "valid": "of",
    "length": "length [m]",
    "bend": "max curvature [1/m]",
    "squares": "∫ curvature² [1/m]",
    "jump": "jump in 2 cm [1/m]",
    "clearance": "clearance [mm]",
    "duration": "duration [s]",
    "jerk": "peak jerk [m/s³]",
}
_COMPARED = {
    "with": "with",
    "scenes": "scenes",
    "integral_k2_ours": "∫ curvature², ours",
    "integral_k2_theirs": "theirs",
    "curvature_jump_ours": "jump, ours",
    "curvature_jump_theirs": "theirs",
    "clearance_mm_ours": "clearance [mm], ours",
    "clearance_mm_theirs": "theirs",
    "length_m_ours": "length [m], ours",
    "length_m_theirs": "theirs",
    "duration_s_ours": "duration [s], ours",
    "duration_s_theirs": "theirs",
}


def report_of(
    table: Table,
    summary: Sequence[Mapping[str, Any]],
    profile: Profile,
    planners: Sequence[str],
    *,
    source: str,
) -> str:
    """Return the report, Markdown.

    Args:
        table: A row for each scene and planner.
        summary: A row for each planner and level.
        profile: Where the time of a plan goes.
        planners: The planners compared, the first one first.
        source: Where the scenes come from.
    """
    scenes = len({row["scene"] for row in table.rows})
    rows = [_row(dict(row)) for row in summary]
    overall = [row for row in rows if row["level"] == ALL] or rows
    parts = [
        f"# DoorBench: {scenes} scenes {source}",
        _introduction(planners),
        "## All levels",
        markdown_table(overall, {k: v for k, v in _RESULTS.items() if k != "level"}),
        "![summary](summary.png)",
        "## What was found, by level",
        markdown_table(rows, _RESULTS),
        "## What it cost, by level",
        markdown_table(rows, _COST),
        "## How good it is, by level",
        "Medians over the valid paths.",
        markdown_table(rows, _QUALITY),
        *_comparisons(table, planners),
        *_unsolved(table, planners),
        *_profile(profile),
        _machine(),
    ]
    failed = [f"- {row['scene']}, {row['planner']}: {row['reason']}" for row in table.failed.rows]
    if failed:
        parts.append("## Cases that failed\n\n" + "\n".join(failed))
    return "\n\n".join(parts) + "\n"


def _introduction(planners: Sequence[str]) -> str:
    named = "\n".join(f"- `{name}`: {CONTESTANTS[name].label}" for name in planners)
    return (
        f"{named}\n\n"
        "A path is valid if `narrows.verify` proves the whole motion clear and inside the bounds, "
        "rolling without slip, within the curvature limit and driven the ways the chair can, and "
        "if it starts and ends where the scene says. Curvature is the change of heading over "
        "windows of 2 cm. Clearance is the proven one. Duration and jerk are those of one timer "
        "for all; where the curvature jumps it must crawl or finds no speed at all. CPU time is "
        "that of planning alone, warm. Brackets: 95 % intervals (Wilson for shares, bootstrap "
        "for quantiles)."
    )


def _row(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row of the summary as texts."""
    names = {
        "cpu": ("plan_cpu_s", ".3f"),
        "cpu_p90": ("plan_cpu_s_p90", ".3f"),
        "length": ("length_m", ".2f"),
        "bend": ("max_curvature", ".2f"),
        "squares": ("integral_k2", ".2f"),
        "jump": ("curvature_jump", ".2f"),
        "clearance": ("clearance_mm", ".1f"),
        "duration": ("duration_s", ".1f"),
        "jerk": ("peak_jerk", ".2f"),
    }
    low, high = row["valid_low"], row["valid_high"]
    share = f"{row['valid'] / row['scenes']:.0%} [{low:.0%}, {high:.0%}]"
    return {**row, "share": share} | {
        key: with_interval(row, name, digits) for key, (name, digits) in names.items()
    }


def _comparisons(table: Table, planners: Sequence[str]) -> list[str]:
    """Return a table for the first planner, and one for ours with as little clearance as OBCA."""
    formats = {
        name: (".1f" if "mm" in name or "_s_" in name else ".2f")
        for name in _COMPARED
        if name not in ("with", "scenes")
    }
    parts = []
    for first in dict.fromkeys((planners[0], *(name for name in planners if name == _TOUCHING))):
        rows = compare(table, first, [name for name in planners if name != first])
        if rows:
            parts += [
                f"## `{first}` and the others, on the scenes both solve",
                "Medians over the same scenes for both.",
                markdown_table(rows, _COMPARED, formats),
            ]
    return parts


def _unsolved(table: Table, planners: Sequence[str]) -> list[str]:
    """Return what our planners say of the scenes they claim no way through."""
    lines = [
        f"- {row['scene']}, `{row['planner']}`: {row['answer']}{_solvers(table, row['scene'])}"
        for row in table.done.rows
        if row["planner"] in planners
        and CONTESTANTS[str(row["planner"])].is_ours
        and not row["is_valid"]
    ]
    return ["## Scenes without a valid path of ours", "\n".join(lines)] if lines else []


def _solvers(table: Table, scene: Any) -> str:
    """Return who has a valid path in a scene."""
    names = [str(row["planner"]) for row in table.done.where(scene=scene).rows if row["is_valid"]]
    return f" (solved by {', '.join(names)})" if names else " (solved by none)"


def _profile(profile: Profile) -> list[str]:
    return [
        "## Where the time of a plan goes",
        f"{profile.plans} plans of `narrows.plan`, {1e3 * profile.mean_s:.0f} ms of CPU time each "
        "without the profiler. Dots: parts of the row above.",
        markdown_table(
            profile.stages,
            {"stage": "stage", "calls": "calls a plan", "share": "share"},
            {"calls": ".1f", "share": ".1%"},
        ),
        "Own time by module:",
        markdown_table(profile.modules, {"module": "module", "share": "share"}, {"share": ".1%"}),
    ]


def _machine() -> str:
    known = ", ".join(f"{name} {version}" for name, version in versions().items())
    return f"Run on {machine()} with {known}."
