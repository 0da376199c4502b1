"""The experiments of [DoorBezier] again, and what its curves do to a chair with a body."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .. import bezier
from ..files import write_whole
from ..planners.doorway import certify_segments, smooth_path
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
from .door_bezier_report import report_text
from .sweep import sweep
from .table import Row, Table

SUMMARY = "the door passing of [DoorBezier]: Table I, tracking, obstacles, and who hits the jamb"

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
    return report_text(table, free, avoiding)


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
