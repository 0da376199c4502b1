"""The experiments of [NarrowArcs] again: its numbers, the best radius, and turns executed."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..files import write_whole
from ..planners.arc_geometry import contact_radii, door_outer_radius, door_radius, paper_turn
from ..planners.corridor_turn import Corner
from ..planners.door_space import door_needed
from ..se2 import Array
from .narrow_arcs_cases import (
    ARCS,
    DOOR,
    DOORS,
    SPEED,
    WIDTH,
    certify_arc,
    chair_cases,
    named_arc,
    paper_body,
    run_chair,
    run_turn,
)
from .narrow_arcs_figures import clearance_of_radius, door_trade_off, draw
from .report import markdown_table
from .statistics import wilson_interval
from .sweep import sweep
from .table import Table

SUMMARY = "the arcs of [NarrowArcs]: its numbers, best radii, least corridors and doors, drives"


def run(out: Path, *, jobs: int, resume: bool, seed: int, drives: int = 60) -> str:
    """Run the study into a folder and return its report.

    Writes `chairs.csv`, `turns.csv`, `clearance-of-radius.csv`, `door-corridor.csv` and four
    figures.

    Args:
        out: Folder.
        jobs: Worker processes.
        resume: Keep the cases done before.
        seed: Of the executed turns.
        drives: Turns executed for each arc.
    """
    fitted = sweep(
        chair_cases(),
        run_chair,
        table=out / "chairs.sqlite",
        keys=("chair",),
        jobs=jobs,
        resume=resume,
        seed=seed,
    )
    fitted.write_csv(out / "chairs.csv", with_runs=False)
    turned = sweep(
        [{"arc": arc, "drive": k, "tracker": "linearizing"} for arc in ARCS for k in range(drives)],
        run_turn,
        table=out / "turns.sqlite",
        keys=("arc", "drive", "tracker"),
        jobs=jobs,
        resume=resume,
        seed=seed,
    )
    turned.write_csv(out / "turns.csv", with_runs=False)
    radii, trade = clearance_of_radius(), door_trade_off()
    _write_csv(out / "clearance-of-radius.csv", radii)
    _write_csv(out / "door-corridor.csv", trade)
    draw(out, radii, trade, turned.done, seed)
    return _report(fitted, turned)


def _write_csv(file: Path, columns: Mapping[str, Array]) -> None:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    rows = np.column_stack(list(columns.values())).tolist()
    writer.writerows([f"{value:.9g}" for value in row] for row in rows)
    write_whole(file, stream.getvalue())


def _report(fitted: Table, turned: Table) -> str:
    parts = [
        "# Arcs in narrow places, again",
        _experiments(),
        "## The best radius",
        _radius_text(),
        "![turns](turns.png)",
        "![clearance over the radius](radius.png)",
        "## What chairs need",
        _chairs(fitted),
        "![doors and corridors](door-corridor.png)",
        "## The turn executed",
        _executed(turned.done),
        "![executed turns](executed.png)",
    ]
    failed = [f"{row['reason']}" for table in (fitted, turned) for row in table.failed.rows]
    if failed:
        parts.append("## Failed cases\n\n" + "\n".join(failed))
    return "\n\n".join(parts) + "\n"


def _experiments() -> str:
    """Return the paper's numbers beside ours."""
    body = paper_body()
    d, w = body.front, body.width
    radii = contact_radii(d, w, WIDTH) or (0.0, 0.0)
    turn = paper_turn(d, w, WIDTH, radii[1])
    space = door_needed(body, door_radius(d, w, DOOR), 0.0)
    rows: list[dict[str, object]] = [
        {"what": f"corridor L = {WIDTH:.2f} m: r [m]", "paper": 1.35, "ours": turn.inner_radius},
        {"what": "R [m]", "paper": 2.02, "ours": turn.outer_radius},
        {"what": "C_r [m]", "paper": 0.40, "ours": turn.side_gap},
        {"what": "C_n [m]", "paper": 0.96, "ours": turn.axle_gap},
        {"what": f"door D = {DOOR:.2f} m: r [m]", "paper": 1.39, "ours": door_radius(d, w, DOOR)},
        {"what": "R [m]", "paper": 2.06, "ours": door_outer_radius(d, w, DOOR)},
        {"what": "corridor before the door [m]", "paper": None, "ours": space.corridor},
        {"what": "speed [m/s]", "paper": 0.168, "ours": SPEED},
    ]
    columns = {"what": "experiment", "paper": "paper", "ours": "ours"}
    table = markdown_table(rows, columns, {"paper": ".3g", "ours": ".4f"})
    return (
        "Chair 1.00 x 0.67 m, its drive axle at its back. C_r with the parentheses restored "
        "(as printed it would be 1.00 m). The paper does not say that its door arc needs a "
        "corridor of 2.06 m in front.\n\n" + table
    )


def _radius_text() -> str:
    corner, half = Corner(WIDTH, WIDTH), 0.5 * paper_body().width
    rows = []
    for name in ARCS:
        arc = named_arc(name)
        proven, attained = certify_arc(paper_body(), corner, arc)
        rows.append(
            {
                "arc": name,
                "r": arc.radius - half,
                "side_gap": arc.side_gap(2.0 * half),
                "axle_gap": arc.axle_gap,
                "form": 1e3 * arc.clearance,
                "proven": 1e3 * proven,
                "attained": 1e3 * attained,
            }
        )
    columns = {
        "arc": "arc",
        "r": "r [m]",
        "side_gap": "C_r [m]",
        "axle_gap": "C_n [m]",
        "form": "closed form [mm]",
        "proven": "proven [mm]",
        "attained": "attained [mm]",
    }
    formats = dict.fromkeys(("r", "side_gap", "axle_gap"), ".3f")
    formats |= dict.fromkeys(("form", "proven", "attained"), ".1f")
    return (
        "Every radius between the roots r- and r+ passes; both roots touch. The best radius on the "
        "bisector is r = d - w. The paper puts the arc's centre on the bisector of the corner; its "
        "chair has no overhang behind the axle, so that the first wall may come nearer: with the "
        "centre free the clearance nearly doubles. The certificate sweeps the body over the same "
        "motion without knowing the formulas.\n\n" + markdown_table(rows, columns, formats)
    )


def _chairs(fitted: Table) -> str:
    columns = {
        "chair": "chair",
        "front": "front [m]",
        "rear": "rear [m]",
        "width": "width [m]",
        "bisector_m": "L corridor, bisector",
        "one_arc_m": "one arc",
        "spin_m": "spin",
        "bound_m": "any motion >=",
    }
    formats = {name: ".3f" for name in columns if name != "chair"}
    corridors = {"chair": "chair"}
    for door in DOORS:
        key = f"corridor_{1e2 * door:.0f}cm_m"
        corridors |= {f"{key}_beyond": f"{door:.2f} m door, beyond", key: "anywhere"}
    doors = {name: ".2f" for name in corridors if name != "chair"}
    tight = all(row["clear_2mm_above"] and not row["clear_2mm_below"] for row in fitted.done.rows)
    confirmed = (
        "The certificate confirms each corridor for one arc: clear with 2 mm more, not with 2 less."
        if tight
        else "**The certificate does not confirm all of them.**"
    )
    return (
        "The narrowest L corridor [m], for one arc with r >= 0 whose centre is on the bisector, "
        "for one arc, for a turn on the spot, and a width below which no rigid motion turns:\n\n"
        + markdown_table(fitted.done.rows, columns, formats)
        + f"\n\n{confirmed}\n\nThe narrowest corridor [m] from which one arc (r >= 0, thin wall) "
        "leads through a door: its centre beyond the wall's plane, as in the paper, or anywhere. A "
        "centre on the corridor's side lets the chair turn before the door.\n\n"
        + markdown_table(fitted.done.rows, corridors, doors)
    )


def _executed(turned: Table) -> str:
    rows = []
    for name in ARCS:
        part = turned.where(arc=name)
        cleared = np.asarray(part.column("clearance_mm"), dtype=float)
        hits = int(np.count_nonzero(np.asarray(part.column("collided"), dtype=float)))
        rows.append(
            {
                "arc": name,
                "planned": 1e3 * named_arc(name).clearance,
                "least": float(cleared.min()),
                "median": float(np.median(cleared)),
                "track": float(np.asarray(part.column("cross_track_mm"), dtype=float).max()),
                "hits": f"{hits} of {len(cleared)}: {wilson_interval(hits, len(cleared))}",
            }
        )
    columns = {
        "arc": "arc",
        "planned": "planned clearance [mm]",
        "median": "median [mm]",
        "least": "least [mm]",
        "track": "max error to the path [mm]",
        "hits": "drives that touch",
    }
    formats = dict.fromkeys(("planned", "median", "least", "track"), ".0f")
    x, y, heading = (
        float(np.std(np.asarray(turned.column(f"measured_{part}"), dtype=float)))
        for part in ("x_mm", "y_mm", "heading_deg")
    )
    return (
        "The chair stands about 1.6 m before the corner, 4 cm and 2 degrees (standard deviation) "
        "off its line, reads sixteen ultrasonic sensors of 3 m once (5 mm noise, cones of 30 "
        "degrees), takes C_r, C_n and its heading from them, and drives from there by its encoders "
        "alone (2 mm ticks, 50 ms motor lag) with the paper's feedback linearisation at "
        f"{SPEED:.3f} m/s. The measured pose is off by {x:.0f} mm along, {y:.0f} mm across and "
        f"{heading:.1f} degrees (standard deviations). Clearance is that of the true drive. The "
        "lines onto which it first aligns cost some of it.\n\n"
        + markdown_table(rows, columns, formats)
    )
