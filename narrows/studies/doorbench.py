"""DoorBench: our planners, OBCA and OMPL through the same doors, judged by one certificate."""

from __future__ import annotations

import csv
import functools
import hashlib
import io
import json
import time
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import StudyError
from ..files import write_whole
from ..path import Path as Way
from ..planners.ladder import plan
from .case import Case
from .doorbench_generator import doorbench_rows
from .doorbench_judge import figures_of, window_curvatures
from .doorbench_planners import CONTESTANTS, available
from .doorbench_profile import profile_plans
from .doorbench_report import report_of
from .doorbench_scenes import DoorBenchScene, read_doorbench
from .doorbench_tables import MEDIANS, summarise
from .sweep import sweep
from .table import Table

SUMMARY = "a chair through doors 5 to 30 cm wider: narrows, its search, OBCA and OMPL compared"

_SPACING = 0.01  # m between the poses kept of a path
_PROFILED = 10  # plans
_POSE = ("x", "y", "heading")
_COUNTS = ("starts", "iterations", "solves", "expansions")


def run(
    out: Path,
    *,
    jobs: int,
    resume: bool,
    seed: int,
    scenes: str | None = None,
    planners: Sequence[str] = (),
    per_level: int = 12,
    pictures: bool = True,
) -> str:
    """Run the study into a folder and return its report.

    Writes `plans.csv` (a row for each scene and planner), `summary.csv` (a row for each planner
    and level), `paths/` (every path claimed, as poses), `pictures/` (one for each scene),
    `summary.png`.

    Args:
        out: Folder.
        jobs: Worker processes; one, for CPU times worth reading on a small machine.
        resume: Keep the cases done before.
        seed: Seed of the scenes drawn, without a file, and of the intervals.
        scenes: DoorBench's JSON file; without it, scenes of the same family are drawn.
        planners: Which planners; all that can run here if empty.
        per_level: Scenes drawn of each level.
        pictures: Whether to draw the scenes.

    Raises:
        StudyError: If the file is not one of DoorBench, or there is no planner of a name.
    """
    chosen = _checked(planners)
    file = out / "scenes.json" if scenes is None else Path(scenes)
    if scenes is None:
        drawn = {"seed": seed, "units": "m, rad", "scenes": doorbench_rows(per_level, seed)}
        write_whole(file, json.dumps(drawn) + "\n")
    given = read_doorbench(file)
    digest = hashlib.sha256(file.read_bytes()).hexdigest()[:16]
    cases = [
        {"scene": one.name, "planner": planner, "level": one.level, "scenes": digest}
        for one in given
        for planner in chosen
    ]
    table = sweep(
        cases,
        functools.partial(attempt, file=str(file.resolve()), out=str(out.resolve())),
        table=out / "plans.sqlite",
        keys=("scene", "planner"),
        jobs=jobs,
        seed=seed,
        resume=resume,
    )
    table.write_csv(out / "plans.csv")
    levels = list(dict.fromkeys(one.level for one in given))
    summary = summarise(table, chosen, levels, seed=seed)
    _write_csv(out / "summary.csv", summary)
    profile = profile_plans(plan, [one.scene for one in given[:: max(1, len(given) // _PROFILED)]])
    _draw(out, table, given, chosen, pictures=pictures)
    return report_of(table, summary, profile, chosen, source=_source(scenes, seed))


def attempt(case: Case, rng: np.random.Generator, *, file: str, out: str) -> dict[str, Any]:
    """Return the result columns of one planner in one scene; keep the path it claims.

    The planner runs twice: once to load and compile what it needs, once for the clock. OMPL, which
    compiles nothing and draws anew each time, runs once.
    """
    contestant = CONTESTANTS[str(case["planner"])]
    scene = _scenes(file, contestant.reversing)[str(case["scene"])].scene
    warm = contestant.claim(scene) if contestant.is_repeatable else None
    begun = time.process_time()
    claim = contestant.claim(scene)
    spent = time.process_time() - begun
    columns: dict[str, Any] = {
        "is_claimed": claim.path is not None,
        "answer": claim.reason,
        "plan_cpu_s": spent,
        "is_repeated": None if warm is None else _is_same(warm.path, claim.path),
        **{name: claim.statistics.get(name) for name in _COUNTS},
    }
    if claim.path is None:
        return {**columns, "is_valid": False, **dict.fromkeys(MEDIANS.keys() - {"plan_cpu_s"})}
    folder = Path(out) / "paths" / str(case["planner"])
    _write_poses(folder / f"{case['scene']}.csv", claim.path)
    return columns | figures_of(scene, claim.path).columns


@functools.lru_cache(maxsize=4)
def _scenes(file: str, reversing: bool) -> Mapping[str, DoorBenchScene]:
    return {one.name: one for one in read_doorbench(Path(file), reversing=reversing)}


def _is_same(first: Way | None, second: Way | None) -> bool:
    """Return whether two runs gave the same path, to the last digit."""
    if first is None or second is None:
        return first is second
    return first.span == second.span and bool(np.array_equal(first.goal, second.goal))


def _write_poses(file: Path, path: Way) -> None:
    """Write a path as poses, 1 cm apart and at the ends of its sections."""
    bounds = path.section_bounds
    places = [
        np.linspace(low, high, max(2, int(np.ceil((high - low) / _SPACING)) + 1))
        for low, high in pairwise(bounds.tolist())
    ]
    poses = path(np.unique(np.concatenate(places)))
    _write_csv(file, [dict(zip(_POSE, row, strict=True)) for row in poses.tolist()])


def _write_csv(file: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    stream = io.StringIO()
    writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_whole(file, stream.getvalue())


def _read_path(file: Path) -> Way | None:
    """Return a path kept by `attempt`, or None if there was none."""
    if not file.exists():
        return None
    with file.open(encoding="utf-8") as stream:
        rows = [
            [float(row[name]) for name in ("x", "y", "heading")] for row in csv.DictReader(stream)
        ]
    return Way.from_poses(rows)


def _checked(planners: Sequence[str]) -> tuple[str, ...]:
    """Return the planners asked for, or all that can run.

    Raises:
        StudyError: If there is no planner of a name.
    """
    for name in planners:
        if name not in CONTESTANTS:
            allowed = ", ".join(CONTESTANTS)
            raise StudyError("there is no such planner", value=name, allowed=allowed)
    return tuple(planners) or available()


def _source(scenes: str | None, seed: int) -> str:
    if scenes is None:
        return f"drawn from seed {seed}"
    return f"of `{Path(scenes).name}`"


def _draw(
    out: Path,
    table: Table,
    given: Sequence[DoorBenchScene],
    planners: Sequence[str],
    *,
    pictures: bool,
) -> None:
    """Draw the summary, and every scene with what each planner claims."""
    from ..viewer.doorbench_pictures import DrawnWay, scene_figure, summary_figure
    from ..viewer.pictures import save_picture

    levels = list(dict.fromkeys(one.level for one in given))
    save_picture(summary_figure(table.done.rows, planners, levels), out / "summary.png")
    if not pictures:
        return
    for one in given:
        rows = {row["planner"]: row for row in table.done.where(scene=one.name).rows}
        ways = []
        for planner in planners:
            path = _read_path(out / "paths" / planner / f"{one.name}.csv")
            row = rows.get(planner)
            if path is None or row is None or not row["is_claimed"]:
                continue
            ways.append(
                DrawnWay(
                    planner,
                    path,
                    *window_curvatures(path),
                    bool(row["is_valid"]),
                    float(row["clearance_mm"] or 0.0),
                    float(row["integral_k2"] or 0.0),
                )
            )
        ours = rows.get(planners[0])
        text = f"{planners[0]}: {ours['answer']}" if ours is not None else ""
        save_picture(
            scene_figure(one.scene, ways, planners, text), out / "pictures" / f"{one.name}.png"
        )
