"""What the study of [DoorBezier] reports: Table I, where its curves hit, the obstacles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..interfaces import PlanStatus
from ..planners.doorway import DoorwayPlanner
from .door_bezier_cases import (
    HEADINGS_DEG,
    OBSTACLES,
    START,
    TARGETS,
    ObstacleRun,
    paper_chair,
    scene_of,
)
from .report import markdown_table
from .table import Row, Table

_CURVES = {"trajectory": "", "p1_x": "P1 x", "p1_y": "P1 y", "p2_x": "P2 x", "p2_y": "P2 y"}
_RESULTS = {
    "trajectory": "",
    "cost": "J [1/m²]",
    "max_curvature": "max curvature [1/m]",
    "clearance_mm": "clearance, axle [mm]",
    "against": "against (axle)",
    "clearance_middle_mm": "clearance, middle [mm]",
    "against_middle": "against (middle)",
    "max_lookahead_error_mm": "max D_err [mm]",
    "max_cross_track_mm": "max C_err [mm]",
    "max_omega": "max omega [rad/s]",
}


def report_text(table: Table, free: ObstacleRun, avoiding: ObstacleRun) -> str:
    """Return the study's report, Markdown.

    Args:
        table: Table I, a row a trajectory.
        free: The runs without the obstacles.
        avoiding: The runs around them.
    """
    rows = table.done.rows
    chair = paper_chair()
    places = dict.fromkeys(("p1_x", "p1_y", "p2_x", "p2_y"), ".3f")
    formats = {
        "cost": ".3f",
        "max_curvature": ".2f",
        "clearance_mm": ".0f",
        "clearance_middle_mm": ".0f",
        "max_lookahead_error_mm": ".0f",
        "max_cross_track_mm": ".0f",
        "max_omega": ".2f",
    }
    parts = [
        "# Door passing on cubic Bezier curves, again",
        _assumptions(chair.length, chair.width, chair.rear_overhang),
        "## Table I: the free control points [m]",
        markdown_table(rows, _CURVES, places),
        "## Table I: cost, curvature, clearance, tracking",
        markdown_table(rows, _RESULTS, formats),
        _findings(rows),
        "![trajectories](trajectories.png)",
        "![tracking errors](tracking-errors.png)",
        "## Obstacles",
        _obstacle_text(free, avoiding),
        "![obstacles](obstacles.png)",
        "## The same starts and goals with the body in the optimisation",
        _beyond(),
    ]
    failed = [f"{row['trajectory']}: {row['reason']}" for row in table.failed.rows]
    if failed:
        parts.append("## Failed cases\n\n" + "\n".join(failed))
    return "\n\n".join(parts) + "\n"


def _assumptions(length: float, width: float, overhang: float) -> str:
    return (
        "Each trajectory is the smoothest completely convex cubic of [DoorBezier, Eqs. (10), (11)] "
        "between the poses of its Table I, driven by the PID of Eq. (13) with the printed gains in "
        "millimetres. Assumed, because the paper does not print it: the corridor lies at "
        "y = 0.15..1.75 m before a wall 0.10 m thick with P_d in its middle; "
        f"the chair is {length:.2f} x {width:.2f} m with its drive axle {overhang:.2f} m before "
        "its back; 0.4 m/s; look-ahead 0.28 m; control period 0.02 s; wheels that answer at once. "
        "Clearance is certified on the swept body, a proven bound at most 1 mm below what is "
        "attained; negative: it cuts that deep (the shortest shift that would part the two). It is "
        "given for the reference point on the drive axle and in the middle of the chair."
    )


def _findings(rows: Sequence[Row]) -> str:
    """Return where the paper's own curves hit, from the table."""
    lines = [
        "The paper optimises the curve of a point. What its chair does on these curves "
        "(reference point on the drive axle):",
        "",
    ]
    for row in rows:
        clearance = float(row["attained_mm"] or 0.0)
        name, place = row["trajectory"], f"({row['hit_x']:.2f}, {row['hit_y']:.2f})"
        if clearance < 0.0:
            lines.append(
                f"- **{name} cuts {-clearance:.0f} mm into the {row['against']}** when its axle is "
                f"at {place} m."
            )
        else:
            lines.append(f"- {name} stays {clearance:.0f} mm clear of the {row['against']}.")
    sharp = max(rows, key=lambda row: float(row["max_curvature"] or 0.0))
    bend = float(sharp["max_curvature"] or 0.0)
    worst = max(float(r["max_lookahead_error_mm"] or 0.0) for r in rows if r["scenario"] == "A")
    lines += [
        "",
        f"{sharp['trajectory']} bends with {bend:.1f} 1/m, a radius of {1.0 / bend:.2f} m: "
        "convexity alone does not bound the curvature. The joins at the door have one tangent but "
        "a jump in curvature. The greatest look-ahead error of scenario A is "
        f"{worst:.0f} mm (the paper: about 55 mm); the chair itself stays nearer (C_err).",
    ]
    return "\n".join(lines)


def _obstacle_text(free: ObstacleRun, avoiding: ObstacleRun) -> str:
    where = "; ".join(f"({x:g}, {y:g}) m, radius {r:g} m" for x, y, r in OBSTACLES)
    arrived = avoiding.drives[0].arrived
    return (
        f"Two round obstacles, their places ours: {where}. d_r of Eq. (12) is an obstacle's "
        "radius plus half the chair's width, right where the chair passes abeam and too little at "
        f"its corners. Cost without them {free.costs[0]:.2f} + {free.costs[1]:.2f}, around them "
        f"{avoiding.costs[0]:.2f} + {avoiding.costs[1]:.2f} 1/m². The second segment is planned "
        f"from where the chair truly is at the door, ({arrived[0]:.3f}, {arrived[1]:.3f}) m, its "
        f"heading of {np.degrees(arrived[2]):.1f} deg adjusted to the door's normal first. "
        f"Of the whole way the certificate says: {avoiding.certificate.reason}."
    )


def _beyond() -> str:
    """Plan the paper's doors with the planner's defaults and return what comes of it."""
    planner, found = DoorwayPlanner(), []
    for first, second in (("A1", "A3"), ("A2", "A4"), ("B1", "B3"), ("B2", "B4")):
        start = (*START, np.radians(HEADINGS_DEG[first][0]))
        goal = (*TARGETS[first[0]], np.radians(HEADINGS_DEG[second][1]))
        plan = planner.plan(scene_of(start, goal))
        clear = plan.certificate.clearance * 1e3 if plan.certificate is not None else None
        found.append(
            {
                "door": f"{first} - {second}",
                "status": plan.status.value,
                "clearance_mm": clear,
                "max_curvature": plan.statistics.get("max_curvature_1_m")
                if plan.status is PlanStatus.CERTIFIED
                else None,
                "reason": plan.reason,
            }
        )
    columns = {
        "door": "",
        "status": "status",
        "clearance_mm": "clearance [mm]",
        "max_curvature": "max curvature [1/m]",
        "reason": "reason",
    }
    formats = {"clearance_mm": ".0f", "max_curvature": ".2f"}
    return (
        "The default doorway planner keeps the exact body clear, bounds the curvature and makes it "
        "continuous; the join may leave the door's middle. With the paper's starts, half a metre "
        "before the wall and turned away from it, this is what two cubics can do for this chair:"
        "\n\n" + markdown_table(found, columns, formats)
    )
