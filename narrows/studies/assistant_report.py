"""What the driving-assistant study says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from . import assistant_texts as texts
from .assistant_drives import HOSTILE
from .assistant_more_tables import doors_table, found_table, people_table, troubles_table
from .assistant_paper import PRINTED_DISTANCE_III, column, mean
from .assistant_people import WALKS
from .assistant_tables import hits_of, means_table, numbers, paper_three, table_three, tests_table
from .statistics import wilson_interval
from .table import Table

MISPRINT = f"""The paper prints a mean distance of {PRINTED_DISTANCE_III} m for run III; its table
gives 32.63 m with the aborted half run and {mean(column("III", 1)):.2f} m without. The means here
leave that run out; the changes are paired over the seven who finished both."""
"""What is to be known of the paper's own figures."""


@dataclass(frozen=True, eq=False)
class Results:
    """The study's tables.

    Attributes:
        course: Drives there and back.
        doors: Drives through doors.
        faults: Drives with faults.
        people: Meetings with people.
        found: Drives found in the learned map.
        grid: How far that map is wrong.
    """

    course: Table
    doors: Table
    faults: Table
    people: Table
    found: Table
    grid: Mapping[str, float]


def assistant_report(results: Results, seed: int) -> str:
    """Return the report, Markdown.

    Args:
        results: The study's tables.
        seed: Of the bootstrap.
    """
    grid = results.grid
    learned = (
        f"The map was learned on one slow drive; there the chair was {grid['pose_mean_mm']:.0f} mm "
        f"off on average, {grid['pose_max_mm']:.0f} mm at most, where odometry alone ended "
        f"{grid['drift_mm']:.0f} mm off. Half of the occupied cells lie within "
        f"{grid['wall_median_mm']:.0f} mm of a wall's surface, 95 % within "
        f"{grid['wall_95_mm']:.0f} mm."
    )
    parts = [
        "# Assisted driving",
        texts.SETUP,
        "## Findings",
        findings(results),
        "## Test runs, the first drive of each driver",
        table_three(results.course),
        "`*`: did not arrive. Table III of the paper, `*` aborted:",
        paper_three(),
        MISPRINT,
        "## All drives",
        means_table(results.course, seed),
        tests_table(results.course),
        texts.TESTS,
        "## Where they drove",
        "![tracks over the learned map](tracks.png)",
        texts.MAP,
        learned,
        found_table(results.found),
        "## Doors of 0.80 m",
        texts.DOORS,
        doors_table(results.doors, seed),
        "![doors by offset and approach angle](doors.png)",
        "## Faults",
        texts.FAULTS,
        troubles_table(results.faults),
        "## People",
        texts.PEOPLE,
        people_table(results.people),
    ]
    tables = (results.course, results.doors, results.faults, results.people, results.found)
    failed = [f"- {row['reason']}" for table in tables for row in table.failed.rows]
    if failed:
        parts += ["## Failed cases", "\n".join(failed)]
    return "\n\n".join(parts) + "\n"


def findings(results: Results) -> str:
    """Return what the tables say in a few lines."""
    course = results.course.done.rows
    assisted = [row for row in course if row["assisted"]]
    hostile = [row for row in assisted if row["driver"] == HOSTILE]
    helped = [row for row in results.doors.done.rows if row["help"] != "alone"]
    troubled = results.faults.done.rows
    everything = [*assisted, *helped, *troubled]
    hits = sum(1 for row in everything if row["collisions"])
    rate = wilson_interval(hits, len(everything))
    clearance = min(numbers(everything, "min_clearance_mm"))
    alone = hits_of(results.course, ("I", "III"))
    lines = [
        f"- Assisted, {hits} of {len(everything)} drives touched anything that stands (95 %: "
        f"at most {rate.high:.2%}): {len(assisted)} on the course, {len(hostile)} of them by the "
        f"hostile driver, {len(helped)} through doors, {len(troubled)} with faults. The least "
        f"clearance of any was {clearance:.0f} mm.",
        f"- Alone, {alone[0]} of {sum(alone)} drives on the course touched "
        f"({alone[0] / sum(alone):.0%}); the paper's subjects 5 of 15 (33 %).",
    ]
    stuck = [row for row in assisted if row["driver"] != HOSTILE and not row["arrived"]]
    people = len(assisted) - len(hostile)
    lines.append(f"- {people - len(stuck)} of {people} assisted drives arrived within 400 s.")
    stays = [row for row in results.people.done.rows if row["walk"] != WALKS[-1]]
    met = sum(1 for row in stays if row["collisions"])
    lines.append(
        f"- Somebody who steps before a chair pushed forward, 0.6 m ahead or more, and stays or "
        f"crosses was touched in {met} of {len(stays)} meetings."
    )
    return "\n".join(lines)
