"""The report of the [FuzzyDVZ] study, from its tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from .fuzzy_dvz_figures import file_of
from .fuzzy_dvz_printed import VARIANTS
from .fuzzy_dvz_runs import BLIND, GUARDED
from .fuzzy_dvz_scenes import KINDS
from .report import markdown_table
from .statistics import wilson_interval
from .table import Table

_DRIVE = {
    "outcome": "outcome",
    "clearance_m": "clearance [m]",
    "duration_s": "time [s]",
    "length_m": "way [m]",
    "switches": "switches",
    "zone_share": "zone drives",
    "backing_share": "backs off",
    "guard_share": "guard slows",
}
_FORMATS = {
    "clearance_m": ".2f",
    "duration_s": ".1f",
    "length_m": ".1f",
    "zone_share": ".0%",
    "backing_share": ".0%",
    "guard_share": ".0%",
}


def paper_text(table: Table) -> str:
    """Return the section of the paper's runs."""
    rows = table.where(variant=GUARDED).rows
    good = sum(row["outcome"] == "arrived" for row in rows)
    blind = table.where(variant=BLIND).rows
    hit = sum(row["outcome"] == "collision" for row in blind)
    names = [str(row["scene"]) for row in rows]
    figures = "\n\n".join(f"![{name}]({file_of(name)})" for name in names)
    return (
        "## The paper's runs\n\n"
        "A chair of 1.0 x 0.65 x 1.0 m, as high as the paper's zone; places beside the way are "
        f"ours. The navigator arrives in {good} of {len(rows)} runs; the goal controller alone "
        f"hits something in {hit} of {len(blind)}. Clearance is that of the swept body, proven.\n\n"
        + markdown_table(rows, {"scene": "run", **_DRIVE}, _FORMATS)
        + "\n\n"
        + figures
        + "\n\nWith the paper's zone in place of ours, without a guard, and the goal controller "
        "alone:\n\n"
        + markdown_table(
            [row for row in table.rows if row["variant"] != GUARDED],
            {"scene": "run", "variant": "variant", **_short()},
            _short_formats(),
        )
    )


def clutter_text(table: Table) -> str:
    """Return the section of the random cluttered worlds."""
    rows = table.where(variant=GUARDED).rows
    likely = [row for row in rows if row["plausible"]]
    hits = sum(int(str(row["collisions"])) for row in rows)
    reached = sum(row["outcome"] == "arrived" for row in likely)
    groups = [
        _summed("all worlds", rows),
        _summed("a path plausibly exists", likely),
        _summed("others", [row for row in rows if not row["plausible"]]),
    ]
    missed = [row for row in likely if row["outcome"] != "arrived"]
    reasons = "\n".join(f"- world {row['world']}: {row['outcome']}, {row['why']}" for row in missed)
    return (
        f"## {len(rows)} random cluttered worlds\n\n"
        "Six to twelve things on a chair's way of 8 m: standing, boards at 0.75 m, and hanging "
        "higher than the chair (1.2 x 0.7 x 1.3 m). A path plausibly exists where the disc that "
        "holds the chair (0.69 m) finds a way at most 1.3 times the straight line in a grid.\n\n"
        f"Collisions: {hits}. Arrived where a path plausibly exists: {reached} of {len(likely)} "
        f"({wilson_interval(reached, len(likely))}).\n\n"
        + _groups(groups)
        + (f"\n\nNot arrived although a path plausibly exists:\n\n{reasons}" if missed else "")
        + "\n\n![random worlds](worlds.png)"
    )


def people_text(table: Table) -> str:
    """Return the section of the worlds with people."""
    groups = []
    for knows, text in ((0, ""), (1, ", velocities known")):
        part = [row for row in table.rows if int(bool(row["knows"])) == knows]
        for kind in KINDS:
            rows = [row for row in part if row["kind"] == kind]
            if rows:
                groups.append(_summed(kind + text, rows))
    unknown = [row for row in table.rows if not row["knows"]]
    hits = sum(int(str(row["collisions"])) for row in unknown)
    walked = sum(int(str(row["walked_into"])) for row in unknown)
    return (
        f"## {len(unknown)} worlds with walking people\n\n"
        "Four things and three people of 0.25 m radius, 0.5 to 1.3 m/s, there and back; they walk "
        "their lines whatever the chair does, through it too. A chair that has stood for half a "
        "second when somebody comes has not collided: it was walked into.\n\n"
        f"Contacts while the chair moves: {hits}. Walked into while it stood: {walked}.\n\n"
        + _groups(groups)
    )


def sensed_text(table: Table) -> str:
    """Return the section of the chair's own senses."""
    columns = {"scene": "run", "senses": "senses", **_short(), "why": "why"}
    return (
        "## The paper's runs by a chair's own senses\n\n"
        "Scanners 0.12 m above the floor and a depth camera 1 m above it, 57 degrees wide, with "
        "noise and delay, into an obstacle map. What no ray has passed is unknown, and the guard "
        "never takes it for free: a camera alone sees nothing beside the chair, so that it may not "
        "turn. Scanners alone see nothing of what hangs above them. What the camera saw of "
        "somebody stays where it cannot see again.\n\n"
        + markdown_table(table.rows, columns, _short_formats())
    )


def odd_text(table: Table) -> str:
    """Return the section of the trap and the glass table."""
    columns = {"case": "case", **_short(), "why": "why"}
    return (
        "## A trap and a glass table\n\n"
        "A U of walls 2.4 m wide and 1 to 3 m deep. A table whose glass top sends nothing back: "
        "what no sensor tells of is not avoided; only who sees it, or is told that it is unknown, "
        "keeps off.\n\n" + markdown_table(table.rows, columns, _short_formats())
    )


def dropout_text(table: Table) -> str:
    """Return the section of the silent sensors."""
    rows = table.rows
    known = [row for row in rows if row["stopped_after_m"] is not None]
    hits = sum(int(str(row["collisions"])) for row in rows)
    over = sum(float(str(r["stopped_after_m"])) > float(str(r["allowed_m"])) for r in known)
    ways = [float(str(row["stopped_after_m"])) for row in known]
    speeds = [float(str(row["speed_then_m_s"])) for row in known]
    text = (
        f"## Silence\n\nThe senses of {len(rows)} drives through random worlds go silent for a "
        "while every few seconds, and for good at the end. "
        f"Collisions: {hits}."
    )
    if not known:
        return text
    return (
        f"{text} From the last silence on the chair goes on for {max(ways):.2f} m at most "
        f"(at {max(speeds):.2f} m/s at most, median way {np.median(ways):.2f} m); further than "
        f"the way until the silence is noticed and the braking distance: {over} of {len(known)}."
    )


def printed_text(table: Table) -> str:
    """Return the section of the printed equations."""
    worlds = {row["world"] for row in table.rows if row["variant"] in VARIANTS}
    groups = [
        _summed(variant, [r for r in table.where(variant=variant).rows if r["world"] in worlds])
        for variant in (*VARIANTS, GUARDED)
    ]
    return (
        f"## The printed equations, on {len(worlds)} of the cluttered worlds\n\n"
        'The paper\'s zone without a guard: "as printed"; with its long end put ahead and the '
        "printed sign of J_alpha, one mistake mended; and with the right equations. A zone alone, "
        "right as it is, does not know the chair's body; the guard does.\n\n" + _groups(groups)
    )


def _short() -> dict[str, str]:
    names = ("outcome", "collisions", "clearance_m", "duration_s", "switches")
    return {name: _DRIVE.get(name, name) for name in names}


def _short_formats() -> dict[str, str]:
    return {"clearance_m": ".2f", "duration_s": ".1f"}


def _summed(name: str, rows: Sequence[Any]) -> dict[str, Any]:
    """Return one row about many drives."""
    outcomes = Counter(row["outcome"] for row in rows)
    done = [row for row in rows if row["outcome"] == "arrived"]

    def mean(column: str) -> float | None:
        return float(np.mean([row[column] for row in rows])) if rows else None

    cleared = [row["clearance_m"] for row in rows if row["clearance_m"] is not None]
    return {
        "name": name,
        "drives": len(rows),
        "arrived": outcomes["arrived"],
        "gave_up": outcomes["gave up"],
        "timeout": outcomes["timeout"],
        "collided": outcomes["collision"],
        "clearance_m": min(cleared) if cleared else None,
        "duration_s": float(np.median([row["duration_s"] for row in done])) if done else None,
        "switches": mean("switches"),
        "zone_share": mean("zone_share"),
        "backing_share": mean("backing_share"),
        "guard_share": mean("guard_share"),
    }


def _groups(groups: Sequence[dict[str, Any]]) -> str:
    columns = {
        "name": "",
        "drives": "drives",
        "arrived": "arrived",
        "gave_up": "gave up",
        "timeout": "timeout",
        "collided": "collided",
        "clearance_m": "least clearance [m]",
        "duration_s": "median time [s]",
        "switches": "switches",
        "zone_share": "zone drives",
        "backing_share": "backs off",
        "guard_share": "guard slows",
    }
    formats = {
        "clearance_m": ".3f",
        "duration_s": ".1f",
        "switches": ".1f",
        "zone_share": ".0%",
        "backing_share": ".0%",
        "guard_share": ".0%",
    }
    return markdown_table(groups, columns, formats)
