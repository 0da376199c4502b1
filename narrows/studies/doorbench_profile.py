"""Where the time of a plan goes: stages by their functions, and modules by their own time."""

from __future__ import annotations

import cProfile
import pstats
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..scene import Scene

STAGES: tuple[tuple[str, str, str], ...] = (
    ("first curves", "guess.py", "forward_guesses"),
    ("search for others", "search.py", "_search"),
    ("making smooth", "refinement.py", "run"),
    ("· evaluations", "refinement_point.py", "evaluate"),
    ("· · contacts", "clearance_rows.py", "rows_along"),
    ("· quadratic programs", "quadratic.py", "minimum_of"),
    ("proof of impassability", "passage.py", "passable"),
    ("certificate", "clearance.py", "certify"),
    ("timing", "timing.py", "timed_path"),
)
"""Name, file and function of each stage; indented ones are parts of the one above."""

_SHOWN = 16


@dataclass(frozen=True)
class Profile:
    """Processor time of plans.

    Attributes:
        plans: How many plans were profiled.
        mean_s: CPU time of a plan without the profiler [s].
        stages: Rows `stage`, `calls` (a plan), `share` (of the time with the profiler on).
        modules: Rows `module`, `share`: own time, the greatest first.
    """

    plans: int
    mean_s: float
    stages: tuple[dict[str, float | str], ...]
    modules: tuple[dict[str, float | str], ...]


def profile_plans(plan: Callable[[Scene], object], scenes: Sequence[Scene]) -> Profile:
    """Return where the CPU time of planning goes, warm.

    The profiler makes Python calls dearer than arithmetic, so the shares lean towards code with
    many small calls; the mean is measured without it.

    Args:
        plan: Plans through a scene.
        scenes: Scenes; planned once before anything is measured.
    """
    for scene in scenes:
        plan(scene)
    begun = time.process_time()
    for scene in scenes:
        plan(scene)
    mean = (time.process_time() - begun) / len(scenes)
    profiler = cProfile.Profile(time.process_time)
    profiler.enable()
    for scene in scenes:
        plan(scene)
    profiler.disable()
    return Profile(len(scenes), mean, *_tables(profiler, len(scenes)))


def _tables(
    profiler: cProfile.Profile, plans: int
) -> tuple[tuple[dict[str, float | str], ...], tuple[dict[str, float | str], ...]]:
    """Return the rows of stages and of modules."""
    entries: dict[tuple[str, int, str], tuple[int, int, float, float, object]]
    entries = pstats.Stats(profiler).stats  # type: ignore[attr-defined]
    total = sum(row[2] for row in entries.values())
    stages: list[dict[str, float | str]] = []
    for stage, file, function in STAGES:
        found = [
            row
            for (where, _, name), row in entries.items()
            if name == function and Path(where).name == file and "narrows" in Path(where).parts
        ]
        calls = sum(row[1] for row in found) / plans
        stages.append({"stage": stage, "calls": calls, "share": sum(r[3] for r in found) / total})
    own: dict[str, float] = {}
    for (where, _, _name), row in entries.items():
        module = _module(where)
        own[module] = own.get(module, 0.0) + row[2]
    largest = sorted(own.items(), key=lambda item: -item[1])[:_SHOWN]
    return tuple(stages), tuple({"module": m, "share": t / total} for m, t in largest)


def _module(file: str) -> str:
    """Return what a file belongs to: a module of narrows, or a package as a whole."""
    parts = Path(file).parts
    if file == "~":
        return "compiled functions"
    if "site-packages" in parts:
        return parts[parts.index("site-packages") + 1]
    if "narrows" in parts:
        last = len(parts) - 1 - parts[::-1].index("narrows")
        return "/".join(parts[last:])
    return "the standard library"
