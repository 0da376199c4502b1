"""The experiments of [FuzzyDVZ] again, what the paper did not test, and its printed equations."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from itertools import product
from pathlib import Path

from .case import CaseFunction
from .fuzzy_dvz_figures import draw
from .fuzzy_dvz_printed import VARIANTS
from .fuzzy_dvz_report import (
    clutter_text,
    dropout_text,
    odd_text,
    paper_text,
    people_text,
    printed_text,
    sensed_text,
)
from .fuzzy_dvz_runs import (
    BLIND,
    GUARDED,
    clutter_case,
    dropout_case,
    odd_case,
    paper_case,
    people_case,
)
from .fuzzy_dvz_scenes import KINDS, PAPER_SCENES
from .fuzzy_dvz_sensing import SENSED, sensing_case
from .sweep import sweep
from .table import Table

SUMMARY = "the navigator of [FuzzyDVZ]: its runs, random worlds, people, its printed equations"

_Case = dict[str, object]

ODD = (
    "U-trap 1.0",
    "U-trap 2.0",
    "U-trap 3.0",
    "glass table, seen",
    "glass table, its top not",
    "glass table, not at all",
)


def run(
    out: Path,
    *,
    jobs: int,
    resume: bool,
    seed: int,
    worlds: int = 500,
    peopled: int = 200,
    compared: int = 60,
    told: int = 20,
    silent: int = 40,
    senses: Sequence[str] = SENSED,
) -> str:
    """Run the study into a folder and return its report.

    Writes `paper.csv`, `clutter.csv`, `people.csv`, `odd.csv`, `dropouts.csv`,
    `sensed.csv` and a figure of each
    of the paper's runs and of some random worlds.

    Args:
        out: Folder.
        jobs: Worker processes.
        resume: Keep the cases done before.
        seed: Of the random worlds.
        worlds: Random cluttered worlds.
        peopled: Random worlds with people, of all `KINDS` in turn.
        compared: Of the cluttered worlds, for the printed equations.
        told: Of the peopled worlds, again with velocities known.
        silent: Of the cluttered worlds, again with senses that go silent.
        senses: What the chair carries in the paper's runs, some of `SENSED`.
    """
    table = partial(_table, out, jobs=jobs, resume=resume, seed=seed)
    paper_cases = _each("scene", PAPER_SCENES, "variant", (GUARDED, BLIND, *VARIANTS))
    paper = table("paper", paper_case, paper_cases, ("scene", "variant"))
    worlds_cases = _clutter(worlds, compared, seed)
    clutter = table("clutter", clutter_case, worlds_cases, ("world", "variant"))
    people = table("people", people_case, _people(peopled, told, seed), ("world", "knows"))
    odd = table("odd", odd_case, [{"case": name} for name in ODD], ("case",))
    silences: list[_Case] = [{"world": k, "base": seed} for k in range(silent)]
    dropouts = table("dropouts", dropout_case, silences, ("world",))
    sensed_cases = _each("scene", PAPER_SCENES, "senses", senses)
    sensed = table("sensed", sensing_case, sensed_cases, ("scene", "senses"))
    draw(out, seed)
    parts = [
        "# Fuzzy rules and a deformable zone, again",
        paper_text(paper.done),
        clutter_text(clutter.done),
        people_text(people.done),
        sensed_text(sensed.done),
        odd_text(odd.done),
        dropout_text(dropouts.done),
        printed_text(clutter.done),
    ]
    failed = [
        str(row["reason"])
        for one in (paper, clutter, people, odd, dropouts, sensed)
        for row in one.failed.rows
    ]
    if failed:
        parts.append("## Failed cases\n\n" + "\n".join(failed))
    return "\n\n".join(parts) + "\n"


def _each(first: str, ones: Iterable[str], second: str, others: Iterable[str]) -> list[_Case]:
    """Return a case for each pair."""
    return [{first: one, second: other} for one, other in product(ones, others)]


def _clutter(worlds: int, compared: int, seed: int) -> list[_Case]:
    """Return the cluttered worlds, the first of them for the printed equations too."""
    cases: list[_Case] = [{"world": k, "variant": GUARDED, "base": seed} for k in range(worlds)]
    for variant in VARIANTS:
        count = min(compared, worlds)
        cases += [{"world": k, "variant": variant, "base": seed} for k in range(count)]
    return cases


def _people(peopled: int, told: int, seed: int) -> list[_Case]:
    """Return the worlds with people, the first of them with velocities known too."""
    return [
        {"world": k, "kind": KINDS[k % len(KINDS)], "knows": knows, "base": seed}
        for knows, count in ((False, peopled), (True, min(told, peopled)))
        for k in range(count)
    ]


def _table(
    out: Path,
    name: str,
    function: CaseFunction,
    cases: Sequence[_Case],
    keys: tuple[str, ...],
    *,
    jobs: int,
    resume: bool,
    seed: int,
) -> Table:
    """Return the table of a sweep, written as CSV too."""
    found = sweep(
        cases,
        function,
        table=out / f"{name}.sqlite",
        keys=keys,
        jobs=jobs,
        resume=resume,
        seed=seed,
        version="1",
    )
    found.write_csv(out / f"{name}.csv", with_runs=False)
    return found
