"""What the tracking study says: tables, the margin a plan needs, the budget of every drive."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .report import markdown_table
from .statistics import mean_interval, wilson_interval
from .table import Row, Table
from .tracking_plans import PAPER_PLANS

PAPER_ERROR_MM = 55.0
"""Greatest error published in [DoorBezier]."""

_SUMMARY = {
    "tracker": "tracker",
    "max_cross_mm": "max cross-track [mm]",
    "rms_cross_mm": "r.m.s. [mm]",
    "max_heading_deg": "max heading [deg]",
    "final_position_mm": "final position [mm]",
    "final_heading_deg": "final heading [deg]",
    "peak_wheel_acceleration": "wheel acc. [m/s²]",
    "peak_jerk": "jerk [m/s³]",
    "collisions": "collisions",
    "step_ms": "step [ms]",
    "step_p95_ms": "95 % [ms]",
}
_FORMATS = {
    "max_cross_mm": ".2f",
    "rms_cross_mm": ".2f",
    "max_heading_deg": ".2f",
    "final_position_mm": ".2f",
    "final_heading_deg": ".2f",
    "peak_wheel_acceleration": ".2f",
    "peak_jerk": ".1f",
    "step_ms": ".2f",
    "step_p95_ms": ".2f",
}
_BUDGET = {
    "plan": "plan",
    "disturbance": "disturbance",
    "tracker": "tracker",
    "run": "run",
    "plan_clearance_mm": "plan [mm]",
    "tracking_mm": "- tracking",
    "localisation_mm": "- localisation",
    "budget_mm": "= budget [mm]",
    "driven_clearance_mm": "driven [mm]",
    "collisions": "collisions",
}


def tracking_report(table: Table, seed: int) -> str:
    """Return the report on a table of drives, Markdown."""
    rows = table.done.rows
    paper = [row for row in rows if row["plan"] in PAPER_PLANS]
    narrow = [row for row in rows if row["plan"] not in PAPER_PLANS]
    nominal = [row for row in narrow if row["disturbance"] == "nominal"]
    disturbed = [row for row in narrow if row["tracker"] != "lookahead-paper"]
    parts = [
        "# Who tracks best",
        _SETUP,
        "## Findings",
        _findings(paper, nominal, disturbed),
    ]
    for title, group in (
        ("## Nominal chair, the papers' paths: the worst of all plans", paper),
        ("## Nominal chair, between solids: the worst of all plans", nominal),
    ):
        if group:
            parts += [title, markdown_table(_worst(group), _SUMMARY, _FORMATS)]
    parts += ["![errors along the plans](errors.png)", "## Under disturbances"]
    parts += [_disturbance_table(disturbed, seed), "![deviations](deviations.png)"]
    parts += ["## The margin a plan needs", _MARGIN, _margin_table(disturbed)]
    parts += ["![drives](drives.png)", "## Clearance budget of every drive", _BUDGET_TEXT]
    budget = dict.fromkeys(
        ("plan_clearance_mm", "tracking_mm", "localisation_mm", "budget_mm", "driven_clearance_mm"),
        ".1f",
    )
    parts.append(markdown_table(narrow, _BUDGET, budget))
    if len(table.failed):
        failed = [
            f"- {row['plan']}, {row['tracker']}, {row['disturbance']}: {row['reason']}"
            for row in table.failed.rows
        ]
        parts += ["## Failed drives", "\n".join(failed)]
    return "\n\n".join(parts) + "\n"


_SETUP = """Every tracker drives the same plans with its default gains in the simulator: 10 ms
physics, a command every 20 ms, motors with a lag of 0.05 s that the trackers know of. Cross-track
and heading errors are those of the true pose to the leg the tracker says it drives: with a known
latency it says so up to that latency too early. A *deviation* is how far a corner of the body is
from where the plan has it: heading errors count by the length of the chair. `lookahead-paper` is
the bare law of [DoorBezier] at constant speed, on the nominal chair only. Times are CPU times of
one core in Python. Intervals are 95 %: bootstrap (BCa) for means, Wilson's for rates."""

_MARGIN = """The greatest deviation [mm] of any drive of any plan: a plan that keeps this clearance
is not touched under the disturbance, as far as these drives show. In brackets the clearance that
was lost in fact, the plan's less the driven one, where that was most: less, because corners
deviate along walls too, and because the worst deviation need not fall where the plan is
narrowest."""

_BUDGET_TEXT = """Budget = the plan's proven clearance - the greatest distance of a corner of the
body from the plan as the chair believed it (tracking) - the greatest distance between the believed
and the true body (localisation). A positive budget excludes contact at the control instants, even
if the two worst cases fall together; the driven clearance is what was really left, proven over the
whole motion."""


def _worst(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return one row per tracker: the greatest of each figure, the median of the step's time."""
    found = []
    for tracker in dict.fromkeys(str(row["tracker"]) for row in rows):
        own = [row for row in rows if row["tracker"] == tracker]
        worst: dict[str, Any] = {"tracker": tracker}
        for name in list(_SUMMARY)[1:]:
            values = _values(own, name)
            worst[name] = float(np.median(values)) if name == "step_ms" else max(values)
        worst["collisions"] = int(sum(int(row["collisions"] or 0) for row in own))
        found.append(worst)
    return found


def _values(rows: Sequence[Row], name: str) -> list[float]:
    values = [row[name] for row in rows]
    return [float(value) for value in values if value is not None]


def spreads_of(
    table: Table, disturbance: str, trackers: Sequence[str], seed: int
) -> list[tuple[str, float, float, float, float]]:
    """Return tracker, mean deviation [mm], ends of its interval and greatest, between solids.

    Args:
        table: The drives.
        disturbance: Its name.
        trackers: Those wanted; one without drives is left out.
        seed: Of the bootstrap.
    """
    spreads = []
    for tracker in trackers:
        own = [
            row
            for row in table.done.rows
            if row["tracker"] == tracker
            and row["disturbance"] == disturbance
            and row["plan"] not in PAPER_PLANS
        ]
        values = _values(own, "deviation_mm")
        if len(values) > 1:
            interval = mean_interval(values, rng=np.random.default_rng(seed))
            spreads.append((tracker, interval.estimate, interval.low, interval.high, max(values)))
        elif values:
            spreads.append((tracker, values[0], values[0], values[0], values[0]))
    return spreads


def _disturbance_table(rows: Sequence[Row], seed: int) -> str:
    """Return a line per disturbance and tracker, errors as means with intervals."""
    lines = []
    for disturbance in dict.fromkeys(str(row["disturbance"]) for row in rows):
        for tracker in dict.fromkeys(str(row["tracker"]) for row in rows):
            own = [
                row
                for row in rows
                if row["disturbance"] == disturbance and row["tracker"] == tracker
            ]
            if not own:
                continue
            hits = sum(1 for row in own if row["collisions"])
            line: dict[str, Any] = {"disturbance": disturbance, "tracker": tracker}
            for name in ("max_cross_mm", "deviation_mm", "final_position_mm"):
                values = _values(own, name)
                interval = (
                    str(mean_interval(values, rng=np.random.default_rng(seed)))
                    if len(values) > 1
                    else f"{values[0]:.4g}"
                )
                line[name] = interval
            line["rms_cross_mm"] = float(np.mean(_values(own, "rms_cross_mm")))
            line["max_heading_deg"] = max(_values(own, "max_heading_deg"))
            line["peak_wheel_acceleration"] = max(_values(own, "peak_wheel_acceleration"))
            line["peak_jerk"] = max(_values(own, "peak_jerk"))
            rate = wilson_interval(hits, len(own))
            line["hit"] = f"{hits} of {len(own)} (<= {rate.high:.0%})"
            lines.append(line)
    columns = {
        "disturbance": "disturbance",
        "tracker": "tracker",
        "max_cross_mm": "max cross-track, mean [mm]",
        "rms_cross_mm": "r.m.s. [mm]",
        "max_heading_deg": "max heading [deg]",
        "deviation_mm": "deviation, mean [mm]",
        "final_position_mm": "final position, mean [mm]",
        "peak_wheel_acceleration": "wheel acc. [m/s²]",
        "peak_jerk": "jerk [m/s³]",
        "hit": "drives that touched",
    }
    formats = {name: _FORMATS[name] for name in ("rms_cross_mm", "max_heading_deg")}
    formats |= {"peak_wheel_acceleration": ".2f", "peak_jerk": ".1f"}
    return markdown_table(lines, columns, formats)


def _margin_table(rows: Sequence[Row]) -> str:
    trackers = list(dict.fromkeys(str(row["tracker"]) for row in rows))
    lines = []
    for disturbance in dict.fromkeys(str(row["disturbance"]) for row in rows):
        line: dict[str, Any] = {"disturbance": disturbance}
        best, least = "", np.inf
        for tracker in trackers:
            own = [
                row
                for row in rows
                if row["disturbance"] == disturbance and row["tracker"] == tracker
            ]
            if not own:
                continue
            needed = max(_values(own, "deviation_mm"))
            line[tracker] = f"{needed:.0f} ({lost_clearance(own):.0f})"
            if needed < least:
                best, least = tracker, needed
        lines.append({**line, "best": best, "margin": least})
    columns = {"disturbance": "disturbance", **{name: name for name in trackers}}
    columns |= {"best": "least by", "margin": "margin [mm]"}
    return markdown_table(lines, columns, {"margin": ".0f"})


def lost_clearance(rows: Sequence[Row]) -> float:
    """Return the most clearance a drive lost against its plan [mm]; 0 without solids."""
    known = [row for row in rows if row["plan_clearance_mm"] is not None]
    pairs = zip(
        _values(known, "plan_clearance_mm"), _values(known, "driven_clearance_mm"), strict=True
    )
    return max((plan - driven for plan, driven in pairs), default=0.0)


def _findings(paper: Sequence[Row], nominal: Sequence[Row], disturbed: Sequence[Row]) -> str:
    lines = []
    if paper:
        worst = {row["tracker"]: row["max_cross_mm"] for row in _worst(paper)}
        best = min(worst, key=lambda name: worst[name])
        below = all(value < PAPER_ERROR_MM for value in worst.values())
        lines.append(
            f"- On the papers' paths the greatest cross-track error of the best tracker, {best}, "
            f"is {worst[best]:.2f} mm; {'every' if below else 'not every'} tracker stays below the "
            f"paper's {PAPER_ERROR_MM:.0f} mm (the worst has {max(worst.values()):.1f} mm)."
        )
    if nominal:
        counts = []
        for bare in (False, True):
            own = [r for r in (*paper, *nominal) if (r["tracker"] == "lookahead-paper") == bare]
            hits = sum(int(value) for value in _values(own, "collisions"))
            counts.append(f"{hits} in {len(own)} drives")
        lines.append(
            f"- Collisions of the nominal chair: {counts[0]}; of the bare law of [DoorBezier]: "
            f"{counts[1]}."
        )
    times = [row for row in (*paper, *nominal) if row["tracker"] == "predictive"]
    if times:
        median = float(np.median(_values(times, "step_ms")))
        late = max(_values(times, "step_p95_ms"))
        lines.append(
            f"- A step of the predictive tracker takes {median:.2f} ms of CPU in the median drive, "
            f"at most {late:.2f} ms in 95 % of the steps of any."
        )
    for disturbance in dict.fromkeys(str(row["disturbance"]) for row in disturbed):
        own = [row for row in disturbed if row["disturbance"] == disturbance]
        needed = {
            str(tracker): max(_values([r for r in own if r["tracker"] == tracker], "deviation_mm"))
            for tracker in dict.fromkeys(row["tracker"] for row in own)
        }
        best = min(needed, key=lambda name: needed[name])
        hits = sum(1 for row in own if row["collisions"])
        lines.append(
            f"- {disturbance}: a plan needs a margin of {needed[best]:.0f} mm with {best}, "
            f"{max(needed.values()):.0f} mm with the worst; {hits} of {len(own)} drives touched."
        )
    return "\n".join(lines)
