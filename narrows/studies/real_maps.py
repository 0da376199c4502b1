"""Doors of real buildings: drives known to be possible or not, and what the planner says of them.

`cases.csv` beside the maps lists drives through doors, each with a reason that does not come from
a planner: a straight sweep of the chair is free (`must_succeed`), or the free space of the disc
inside the chair does not join start and goal (`must_fail`).
"""

from __future__ import annotations

import csv
import functools
import io
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import StudyError
from ..interfaces import Plan, PlanStatus
from ..maps import load_map
from ..planners.finish import CERTIFICATE_TOLERANCE
from ..planners.ladder import plan
from ..scene import Goal, Scene
from ..vehicle import Vehicle
from ..world import World
from .case import Case, Scalar
from .report import markdown_table
from .sweep import sweep
from .table import Row, Table

SUMMARY = "doors of real buildings: what must pass is certified, what cannot never is"

SUCCEED, FAIL = "must_succeed", "must_fail"

_POSES = ("start_x", "start_y", "start_yaw", "goal_x", "goal_y", "goal_yaw")
_SIZES = ("chair_width", "chair_length")
_TEXTS = ("folder", "map", "expect", "door_or_task")
_BY_MAP = {
    "map": "map",
    "expect": "expected",
    "pieces": "convex pieces",
    "drives": "drives",
    "certified": "certified",
    "impassable": "impassable",
    "not_found": "not found",
    "unexpected": "not as expected",
    "least_mm": "least clearance [mm]",
    "median_s": "CPU median [s]",
    "most_s": "CPU most [s]",
}
_BY_DRIVE = {
    "map": "map",
    "door_or_task": "door",
    "expect": "expected",
    "chair_width": "width [m]",
    "answer": "answer",
    "clearance_mm": "clearance [mm]",
    "plan_cpu_s": "CPU [s]",
    "said": "reason",
}


def run(
    out: Path,
    *,
    jobs: int,
    resume: bool,
    seed: int,
    data: str | None = None,
    every: int = 1,
) -> str:
    """Run the study into a folder and return its report.

    Writes `drives.csv`, a row for each drive.

    Args:
        out: Folder.
        jobs: Worker processes.
        resume: Keep the drives done before.
        seed: Nothing here is random; kept in the table.
        data: Folder of the maps and of `cases.csv`; by default `$NARROWS_DATA/maps`.
        every: Take each n-th drive of a map only, >= 1.

    Raises:
        StudyError: If no folder is given, or its `cases.csv` cannot be used.
    """
    folder = _folder(data)
    if every < 1:
        raise StudyError(
            "drives are left out by a number", field="every", value=every, allowed=">= 1"
        )
    table = sweep(
        read_drives(folder / "cases.csv", every),
        functools.partial(attempt, data=str(folder.resolve())),
        table=out / "drives.sqlite",
        keys=("map", "expect", "door_or_task"),
        jobs=jobs,
        resume=resume,
        seed=seed,
    )
    table.write_csv(out / "drives.csv")
    return _report(table)


def _folder(data: str | None) -> Path:
    if data is not None:
        return Path(data)
    if "NARROWS_DATA" in os.environ:
        return Path(os.environ["NARROWS_DATA"]) / "maps"
    raise StudyError("no maps", field="--data", allowed="the folder of cases.csv and the maps")


def read_drives(file: Path, every: int = 1) -> list[dict[str, Any]]:
    """Return the drives of a `cases.csv`, poses of the body's centre [m, rad], sizes [m].

    Args:
        file: The file.
        every: Take each n-th drive of a map and expectation only.

    Raises:
        StudyError: If the file cannot be read, lacks a column, or has a cell of the wrong kind.
    """
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or str(error)
        allowed = "the folder given holds cases.csv and the maps"
        raise StudyError(
            f"the drives cannot be read: {why}", file=str(file), allowed=allowed
        ) from error
    table = csv.DictReader(io.StringIO(text))
    missing = {*_TEXTS, *_POSES, *_SIZES} - {*(table.fieldnames or ())}
    if missing:
        raise StudyError("columns are missing", file=str(file), line=1, value=sorted(missing))
    groups: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for row in table:
        drive = _drive(row, file, table.line_num)
        groups.setdefault((drive["map"], drive["expect"]), []).append(drive)
    return [drive for group in groups.values() for drive in group[::every]]


def _drive(row: dict[str, str], file: Path, line: int) -> dict[str, Any]:
    drive: dict[str, Any] = {name: row[name] for name in _TEXTS}
    if drive["expect"] not in (SUCCEED, FAIL):
        allowed = f"{SUCCEED} or {FAIL}"
        raise StudyError(
            "no such expectation", file=str(file), line=line, value=drive["expect"], allowed=allowed
        )
    for name in (*_POSES, *_SIZES):
        try:
            drive[name] = float(row[name])
        except (TypeError, ValueError) as error:
            raise StudyError(
                "not a number", file=str(file), line=line, field=name, value=row[name]
            ) from error
    return drive


def scene_of(drive: Case, data: Path) -> Scene:
    """Return a drive as a scene: its map, and the chair about its centre, where the poses are.

    Args:
        drive: One of `read_drives`.
        data: Folder of the maps.
    """
    length = float(drive["chair_length"] or 0.0)
    chair = Vehicle.rectangle(length, float(drive["chair_width"] or 0.0), length / 2)
    ends = np.array([drive[name] for name in _POSES], dtype=float).reshape(2, 3)
    world = _world(str(data / str(drive["folder"]) / f"{drive['map']}.json"))
    return Scene(
        chair, world, ends[0], Goal(ends[1]), name=f"{drive['map']} {drive['door_or_task']}"
    )


@functools.lru_cache(maxsize=1)
def _world(file: str) -> World:
    return load_map(Path(file))


def attempt(case: Case, rng: np.random.Generator, *, data: str) -> dict[str, Any]:
    """Return the result columns of one drive."""
    scene = scene_of(case, Path(data))
    pieces = len(scene.world.pieces_between(*scene.vehicle.layers[0].z))  # not on the clock
    begun = time.process_time()
    found = plan(scene)
    spent = time.process_time() - begun
    return {
        "answer": found.status.value,
        "is_expected": _is_expected(str(case["expect"]), found),
        "planner": found.planner,
        "clearance_mm": None if found.certificate is None else 1e3 * found.certificate.clearance,
        "is_below_margin": _is_below_margin(scene, found),
        "missing_mm": found.statistics.get("missing_mm"),
        "length_m": None if found.path is None else found.path.length,
        "direction_changes": None if found.path is None else found.path.direction_changes,
        "plan_cpu_s": spent,
        "pieces": pieces,
        "said": found.reason,
    }


def _is_expected(expect: str, found: Plan) -> bool:
    """Return whether an answer is right: the possible is certified, the impossible is not."""
    return (found.status is PlanStatus.CERTIFIED) == (expect == SUCCEED)


def _is_below_margin(scene: Scene, found: Plan) -> bool:
    """Return whether a plan is certified with less clearance than the scene asks for."""
    if found.certificate is None:
        return False
    return found.certificate.clearance < scene.margin - CERTIFICATE_TOLERANCE


def _report(table: Table) -> str:
    done = table.done.rows
    groups: dict[tuple[Scalar, Scalar], list[Row]] = {}
    for row in done:
        groups.setdefault((row["map"], row["expect"]), []).append(row)
    by_map = [_summary(rows) for rows in groups.values()]
    short = [row for row in done if row["is_below_margin"]]
    wrong = [row for row in done if not row["is_expected"]]
    formats = {"least_mm": ".1f", "median_s": ".2f", "most_s": ".1f"}
    by_drive = {"clearance_mm": ".1f", "plan_cpu_s": ".2f"}
    right = len(done) - len(wrong)
    parts = [
        "# Doors of real buildings",
        f"{right} of {len(table)} drives are answered as they must be. {SUCCEED}: a path is "
        f"certified. {FAIL}: none is; the proof that nothing passes is asked for besides, and a "
        "plan that ends without it says `not_found`. CPU time is that of `plan` alone; the first "
        "one in a process compiles what all use.",
        markdown_table(by_map, _BY_MAP, formats) if by_map else "No drive was done.",
    ]
    for title, rows in (("Not as expected", wrong), ("Certified below the margin", short)):
        if rows:
            parts += [f"## {title}", markdown_table(rows, _BY_DRIVE, by_drive)]
    if table.failed.rows:
        failed = [f"{r['map']} {r['door_or_task']}: {r['reason']}" for r in table.failed.rows]
        parts.append("## Failed\n\n" + "\n".join(failed))
    return "\n\n".join(parts) + "\n"


def _summary(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the report's line on the drives of one map that must end alike."""
    answers = [row["answer"] for row in rows]
    clear = [float(row["clearance_mm"]) for row in rows if row["clearance_mm"] is not None]
    spent = [float(row["plan_cpu_s"] or 0.0) for row in rows]
    return {
        "map": rows[0]["map"],
        "expect": rows[0]["expect"],
        "pieces": rows[0]["pieces"],
        "drives": len(rows),
        **{status.value: answers.count(status.value) for status in PlanStatus},
        "unexpected": sum(not row["is_expected"] for row in rows),
        "least_mm": min(clear, default=None),
        "median_s": float(np.median(spent)),
        "most_s": max(spent),
    }
