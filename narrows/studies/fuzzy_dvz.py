"""The experiments of [FuzzyDVZ] again, what the paper did not test, and its printed equations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import product
from pathlib import Path

from .case import CaseFunction
from .fuzzy_dvz_figures import DRAWN, draw
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

_SECTIONS = (
    ("paper", paper_text),
    ("clutter", clutter_text),
    ("people", people_text),
    ("sensed", sensed_text),
    ("odd", odd_text),
    ("dropouts", dropout_text),
    ("clutter", printed_text),
)
"""The report: which table each section is about."""


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
    scenes: Sequence[str] = tuple(PAPER_SCENES),
    odd: Sequence[str] = ODD,
    drawn: int = DRAWN,
) -> str:
    """Run the study into a folder and return its report.

    Writes `paper.csv`, `clutter.csv`, `people.csv`, `odd.csv`, `dropouts.csv`, `sensed.csv`, the
    scene and a figure of each of the paper's runs, and a figure of some random worlds.

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
        scenes: The paper's runs, some of `PAPER_SCENES`.
        odd: Some of `ODD`.
        drawn: Of the cluttered worlds, in a figure.
    """
    table = partial(_table, out, jobs=jobs, resume=resume, seed=seed)
    variants = (GUARDED, BLIND, *VARIANTS)
    silences: list[_Case] = [{"world": k, "base": seed} for k in range(silent)]
    found = {
        "paper": table(
            "paper",
            paper_case,
            _each("scene", scenes, "variant", variants),
            ("scene", "variant"),
        ),
        "clutter": table(
            "clutter", clutter_case, _clutter(worlds, compared, seed), ("world", "variant")
        ),
        "people": table("people", people_case, _people(peopled, told, seed), ("world", "knows")),
        "odd": table("odd", odd_case, [{"case": name} for name in odd], ("case",)),
        "dropouts": table("dropouts", dropout_case, silences, ("world",)),
        "sensed": table(
            "sensed",
            sensing_case,
            _each("scene", scenes, "senses", senses),
            ("scene", "senses"),
        ),
    }
    draw(out, seed, scenes, drawn)
    return _report(found)


def _report(found: Mapping[str, Table]) -> str:
    """Return the report on the tables by their names."""
    parts = ["# Fuzzy rules and a deformable zone, again"]
    parts += [text(found[name].done) for name, text in _SECTIONS]
    failed = [str(row["reason"]) for table in found.values() for row in table.failed.rows]
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
