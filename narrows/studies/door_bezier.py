"""The experiments of [DoorBezier] again, and what its curves do to a chair with a body."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .. import bezier
from ..files import write_whole
from ..interfaces import PlanStatus
from ..planners.doorway import DoorwayPlanner, certify_segments, smooth_path
from ..se2 import Array
from .door_bezier_cases import (
    HEADINGS_DEG,
    OBSTACLES,
    START,
    TARGETS,
    Drive,
    ObstacleRun,
    drive_curve,
    paper_chair,
    paper_world,
    plan_trajectory,
    run_obstacles,
    run_trajectory,
    scene_of,
)
from .report import markdown_table
from .sweep import sweep
from .table import Row, Table

SUMMARY = "the door passing of [DoorBezier]: Table I, tracking, obstacles, and who hits the jamb"

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
_CSV_ROWS = 201


def run(out: Path, *, jobs: int, resume: bool, seed: int) -> str:
    """Run the study into a folder and return its report.

    Writes `table-1.csv`, reference and driven rows of the eight trajectories as CSV, and three
    figures.

    Args:
        out: Folder.
        jobs: Worker processes.
        resume: Keep the cases done before.
        seed: Nothing here is random; kept in the table.
    """
    cases = [{"trajectory": name, "scenario": name[0]} for name in HEADINGS_DEG]
    table = sweep(
        cases,
        run_trajectory,
        table=out / "table-1.sqlite",
        keys=("trajectory",),
        jobs=jobs,
        resume=resume,
        seed=seed,
    )
    table.write_csv(out / "table-1.csv", with_runs=False)
    drives = {str(row["trajectory"]): _drive(row) for row in table.done.rows}
    for row in table.done.rows:
        _write_trajectory(out, row, drives[str(row["trajectory"])])
    free, avoiding = (run_obstacles(with_obstacles=choice) for choice in (False, True))
    _draw(out, table, drives, free, avoiding)
    return _report(table, free, avoiding)


def _control(row: Row) -> Array:
    """Return the control points kept in a row, shape (4, 2)."""
    return np.array([[row[f"p{k}_{axis}"] for axis in "xy"] for k in range(4)], dtype=float)


def _drive(row: Row) -> Drive:
    """Drive a row's curve again; the same every time."""
    scene, _ = plan_trajectory(str(row["trajectory"]))
    return drive_curve(scene, _control(row))


def _write_trajectory(out: Path, row: Row, drive: Drive) -> None:
    """Write one trajectory as two CSV files: the reference, and how it was driven."""
    control, name = _control(row), str(row["trajectory"])
    parameter = np.linspace(0.0, 1.0, _CSV_ROWS)
    points, tangent = (bezier.evaluate(control, parameter, order) for order in (0, 1))
    heading = np.arctan2(tangent[:, 1], tangent[:, 0])
    bend = bezier.curvature(control, parameter)
    _write_csv(
        out / f"{name}-reference.csv",
        ("parameter", "x", "y", "heading", "curvature"),
        np.column_stack([parameter, points, heading, bend]),
    )
    record = drive.record
    _write_csv(
        out / f"{name}-driven.csv",
        ("t", "x", "y", "heading", "v", "omega", "cross_track_error"),
        np.column_stack([record.times, record.poses, record.commands, record.cross_track]),
    )


def _write_csv(file: Path, header: Sequence[str], rows: Array) -> None:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([f"{value:.9g}" for value in row] for row in rows.tolist())
    write_whole(file, stream.getvalue())


def _hit(control: Array) -> tuple[Array | None, float]:
    """Return the pose where composite curves (K, 4, 2) cut deepest, and how deep [mm]."""
    scene = scene_of((*START, 0.0), (*TARGETS["A"], 0.0), paper_world(OBSTACLES))
    certificate = certify_segments(scene, control)
    if certificate.attained >= 0.0:
        return None, 0.0
    return smooth_path(control)(certificate.at[0]), -1e3 * certificate.attained


def _draw(
    out: Path, table: Table, drives: dict[str, Drive], free: ObstacleRun, avoiding: ObstacleRun
) -> None:
    """Draw the three figures."""
    from ..viewer.door_bezier_pictures import (
        DrawnTrajectory,
        errors_figure,
        obstacles_figure,
        trajectories_figure,
    )
    from ..viewer.pictures import save_picture

    scenarios: dict[str, list[DrawnTrajectory]] = {}
    for row in table.done.rows:
        name = str(row["trajectory"])
        drive, control = drives[name], _control(row)
        hit, depth = _hit_of(row, control)
        drawn = DrawnTrajectory(
            name,
            control,
            drive.record.poses[:, :2],
            drive.parameter,
            drive.omega,
            drive.lookahead_error,
            hit,
            depth,
        )
        scenarios.setdefault(name[0], []).append(drawn)
    chair = paper_chair()
    save_picture(trajectories_figure(paper_world(), chair, scenarios), out / "trajectories.png")
    save_picture(errors_figure(scenarios["A"]), out / "tracking-errors.png")
    curves = {"planned without the obstacles": free.control, "planned around": avoiding.control}
    driven = np.concatenate([drive.record.poses[:, :2] for drive in avoiding.drives])
    hit, depth = _hit(avoiding.control[:1])
    text = (
        "Two obstacles (places ours): the curves keep d_r = obstacle + half the chair's width;\n"
        f"the real chair cuts {depth:.0f} mm into the {avoiding.certificate.against} all the same"
    )
    figure = obstacles_figure(avoiding.scene.world, chair, curves, driven, hit, text)
    save_picture(figure, out / "obstacles.png")


def _hit_of(row: Row, control: Array) -> tuple[Array | None, float]:
    if float(row["attained_mm"] or 0.0) >= 0.0:
        return None, 0.0
    scene, _ = plan_trajectory(str(row["trajectory"]))
    certificate = certify_segments(scene, control[None])
    return smooth_path(control[None])(certificate.at[0]), -1e3 * certificate.attained


def _report(table: Table, free: ObstacleRun, avoiding: ObstacleRun) -> str:
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
        "Clearance is certified on the swept body; negative: it cuts that deep (the shortest shift "
        "that would part the two). It is given for "
        "the reference point on the drive axle and in the middle of the chair."
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
        f"Certified: {avoiding.certificate.reason}."
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
