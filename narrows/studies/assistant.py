"""Assisted driving: eight drivers on a course, by hand and by head, alone and assisted."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..simulation.driver_traits import DRIVERS
from .assistant_doors import ANGLES_DEG, DOOR_DRIVERS, HELP, OFFSETS, door_case
from .assistant_drawing import draw_doors, draw_tracks
from .assistant_drives import DEVICES, HOSTILE, course_case, prepare_regions
from .assistant_faults import TROUBLES, trouble_case
from .assistant_localisation import learn_map, localised_case, map_figures
from .assistant_people import GAPS, WALKS, people_case
from .assistant_report import Results, assistant_report
from .case import Scalar
from .sweep import sweep
from .table import Table

SUMMARY = "driving assistant: eight drivers by hand and by head, alone and assisted; doors, faults"

_TIMEOUT = 300.0  # s, of a case
_FAULT_DRIVERS = 4


def run(
    out: Path,
    *,
    jobs: int,
    resume: bool,
    seed: int,
    seeds: int = 2,
    hostile: int = 10,
    door_seeds: int = 1,
    meetings: int = 5,
    drivers: Sequence[str] = tuple(DRIVERS),
    offsets: Sequence[float] = OFFSETS,
    angles_deg: Sequence[float] = ANGLES_DEG,
) -> str:
    """Run the study into a folder and return its report.

    Writes tables (SQLite and CSV) of the drives on the course, through doors, with faults, before
    people and in the map; the safety regions, the learned map, the tracks; and two figures.

    Args:
        out: Folder.
        jobs: Worker processes.
        resume: Keep the drives done before.
        seed: Seed of everything random.
        seeds: Drives of each driver with each device, alone and assisted.
        hostile: Assisted drives of the hostile driver with each device.
        door_seeds: Drives through the door of each driver from each start.
        meetings: Meetings with somebody of each kind, at each distance.
        drivers: Who drives the course; the first four have the faults.
        offsets: Where drives through the door begin, beside its middle [m].
        angles_deg: At which headings they begin [deg].
    """
    tables = _Tables(out, jobs, resume, seed, prepare_regions(out))
    course = tables.sweep("course", course_case, _course_cases(drivers, seeds, hostile))
    doors = tables.sweep("doors", door_case, _door_cases(offsets, angles_deg, door_seeds))
    troubled = drivers[:_FAULT_DRIVERS]
    faults = tables.sweep(
        "faults",
        trouble_case,
        [{"trouble": name, "driver": driver} for name in TROUBLES for driver in troubled],
    )
    people = tables.sweep(
        "people",
        people_case,
        [
            {"walk": walk, "gap_m": gap, "run": number}
            for walk in WALKS
            for gap in GAPS
            for number in range(meetings)
        ],
    )
    found, grid = _find_tracks(tables, drivers)
    draw_tracks(out / "tracks.png", grid, out, found)
    draw_doors(out / "doors.png", doors, offsets, angles_deg)
    results = Results(course, doors, faults, people, found, map_figures(grid))
    return assistant_report(results, seed)


@dataclass(frozen=True)
class _Tables:
    """Runs the study's sweeps, all alike."""

    out: Path
    jobs: int
    resume: bool
    seed: int
    regions: str

    def sweep(
        self,
        name: str,
        function: Callable[..., Mapping[str, Scalar]],
        cases: Sequence[dict[str, Scalar]],
        **more: str,
    ) -> Table:
        """Return the table of cases, each a row identified by all it has; also written as CSV."""
        table = sweep(
            cases,
            functools.partial(function, regions=self.regions, **more),
            table=self.out / f"{name}.sqlite",
            keys=tuple(cases[0]),
            jobs=self.jobs,
            resume=self.resume,
            seed=self.seed,
            timeout_s=_TIMEOUT if self.jobs > 1 else None,
        )
        table.write_csv(self.out / f"{name}.csv", with_runs=False)
        return table


def _course_cases(drivers: Sequence[str], seeds: int, hostile: int) -> list[dict[str, Scalar]]:
    """Return all drives on the course; the hostile driver's are all assisted."""
    people = [(name, assisted, seeds) for name in drivers for assisted in (False, True)]
    return [
        {"driver": name, "device": device, "assisted": assisted, "run": number}
        for name, assisted, count in [*people, (HOSTILE, True, hostile)]
        for device in DEVICES
        for number in range(count)
    ]


def _door_cases(
    offsets: Sequence[float], angles_deg: Sequence[float], seeds: int
) -> list[dict[str, Scalar]]:
    return [
        {"driver": name, "help": given, "offset_m": offset, "angle_deg": angle, "run": number}
        for given in HELP
        for name in DOOR_DRIVERS
        for offset in offsets
        for angle in angles_deg
        for number in range(seeds)
    ]


def _find_tracks(tables: _Tables, drivers: Sequence[str]) -> tuple[Table, Path]:
    """Learn the map and find a drive of everybody in it; return the table and the map's file."""
    grid = tables.out / "map.npz"
    if not tables.resume:
        grid.unlink(missing_ok=True)
    learn_map(grid, tables.regions, tables.seed)
    cases: list[dict[str, Scalar]] = [
        {"driver": name, "device": device, "assisted": assisted}
        for name in drivers
        for device in DEVICES
        for assisted in (False, True)
    ]
    more = {"grid": str(grid), "tracks": str(tables.out)}
    return tables.sweep("tracks", localised_case, cases, **more), grid
