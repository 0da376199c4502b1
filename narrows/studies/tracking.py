"""Who tracks best: every tracker on the same plans, nominal and disturbed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..simulation.simulator import SimulationOptions, simulate
from ..tracking.registry import make_tracker
from .case import Scalar
from .sweep import sweep
from .table import Table
from .tracking_plans import NARROW_PLANS, PAPER_PLANS, first_scenes, tracked_plan
from .tracking_report import spreads_of, tracking_report
from .tracking_runs import DISTURBANCES, run_case

SUMMARY = "who tracks best: every tracker on the same plans, nominal and disturbed; margins"

TRACKERS = ("lookahead", "linearizing", "virtual-target", "predictive")
"""The trackers compared; the bare law of [DoorBezier] is driven on the nominal chair only."""

_DRAWN = ("A1", "corner", "S corridor", "shunt")
_SHOWN = "pose drift 5 cm, 2 deg"


def run(
    out: Path,
    *,
    jobs: int,
    resume: bool,
    seed: int,
    seeds: int = 3,
    plans: Sequence[str] = (*PAPER_PLANS, *NARROW_PLANS),
    disturbances: Sequence[str] = tuple(DISTURBANCES),
    scenes: str | None = None,
    scene_names: Sequence[str] = (),
) -> str:
    """Run the study into a folder and return its report.

    Writes `runs.sqlite`, `runs.csv` with a row a drive, and three figures.

    Args:
        out: Folder.
        jobs: Worker processes.
        resume: Keep the drives done before.
        seed: Seed of all disturbances.
        seeds: Drives of each random disturbance, plan and tracker.
        plans: Names of plans; disturbances are tried on those between solids.
        disturbances: Names of disturbances.
        scenes: DoorBench's JSON file, if its scenes are wanted too, planned with reversing.
        scene_names: Names of its scenes; the first of each level if empty.
    """
    if scenes is not None:
        plans = (*plans, *(scene_names or first_scenes(scenes)))
    cases = _cases(plans, disturbances, seeds, scenes or "")
    table = sweep(
        cases,
        run_case,
        table=out / "runs.sqlite",
        keys=("plan", "tracker", "disturbance", "run"),
        jobs=jobs,
        resume=resume,
        seed=seed,
        timeout_s=120.0 if jobs > 1 else None,
    )
    table.write_csv(out / "runs.csv", with_runs=False)
    _draw(out, table, plans, disturbances, seed)
    return tracking_report(table, seed)


def _cases(
    plans: Sequence[str], disturbances: Sequence[str], seeds: int, doorbench: str
) -> list[dict[str, Scalar]]:
    cases: list[dict[str, Scalar]] = []
    for plan in plans:
        for name in disturbances:
            chosen = DISTURBANCES[name]
            wanted = plan in chosen.plans if chosen.plans else plan not in PAPER_PLANS
            if not (wanted or name == "nominal"):
                continue
            trackers = (*TRACKERS, "lookahead-paper") if name == "nominal" else TRACKERS
            for tracker in trackers:
                for number in range(seeds if chosen.is_random else 1):
                    cases.append(
                        {
                            "plan": plan,
                            "tracker": tracker,
                            "disturbance": name,
                            "run": number,
                            "doorbench": doorbench if plan not in PAPER_PLANS else "",
                        }
                    )
    return cases


def _draw(
    out: Path, table: Table, plans: Sequence[str], disturbances: Sequence[str], seed: int
) -> None:
    """Draw the figures there are drives for."""
    from ..viewer.pictures import save_picture
    from ..viewer.tracking_pictures import (
        DrawnDrive,
        Spread,
        drives_figure,
        errors_figure,
        spreads_figure,
    )

    def driven(plan: str, disturbance: str) -> list[DrawnDrive]:
        chosen, tracked = DISTURBANCES[disturbance], tracked_plan(plan)
        options = SimulationOptions(chosen.plant, chosen.localisation, time_limit=120.0)
        drives = []
        for name in TRACKERS:
            tracker = make_tracker(
                name,
                tracked.motion,
                tracked.scene.vehicle,
                speed=tracked.speed,
                delay=chosen.delay,
            )
            record = simulate(
                tracked.scene,
                tracker,
                reference=tracked.motion,
                options=options,
                rng=np.random.default_rng(seed),
            )
            drives.append(DrawnDrive(name, record.poses, record.progress, record.cross_track))
        return drives

    shown = [plan for plan in _DRAWN if plan in plans]
    if shown:
        figure = errors_figure({plan: driven(plan, "nominal") for plan in shown})
        save_picture(figure, out / "errors.png")
    spreads = {
        name: [Spread(*row) for row in spreads_of(table, name, TRACKERS, seed)]
        for name in disturbances
    }
    spreads = {name: several for name, several in spreads.items() if several}
    if spreads:
        save_picture(spreads_figure(spreads), out / "deviations.png")
    narrow = [plan for plan in NARROW_PLANS if plan in plans]
    if narrow:
        several = {
            plan: (tracked_plan(plan).scene, tracked_plan(plan).path, driven(plan, _SHOWN))
            for plan in narrow
        }
        title = f"driven under {_SHOWN}, one seed"
        save_picture(drives_figure(several, title), out / "drives.png")
