"""Trajectories in files: read and written by the file's suffix, `.csv` or `.json`."""

from __future__ import annotations

from pathlib import Path as FilePath

from ..errors import TrajectoryError
from ..path import Path
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from .csv_trajectory import read_csv, write_csv
from .json_trajectory import read_json, write_json

__all__ = ["SUFFIXES", "check_suffix", "read_trajectory", "write_trajectory"]

SUFFIXES = (".csv", ".json")
"""Suffixes of the files that can be read and written."""


def read_trajectory(file: FilePath | str) -> Trajectory | Path:
    """Return the motion in a file: a trajectory where its rows have times, else a path.

    Args:
        file: CSV with a header, or JSON; see `narrows.formats.columns` for the columns.

    Raises:
        TrajectoryError: If the file cannot be used; says file, line, field, value.
    """
    suffix = check_suffix(file)
    if suffix == ".csv":
        return read_csv(file)
    if suffix == ".json":
        return read_json(file)
    raise _refused(file, suffix)


def write_trajectory(trajectory: Trajectory, file: FilePath | str, *, vehicle: Vehicle) -> None:
    """Write a trajectory, whole or not at all.

    Args:
        trajectory: What to write: its rows at `trajectory.times`.
        file: Where to; the suffix says how.
        vehicle: The chair it was made for: its track gives the wheels' speeds.

    Raises:
        TrajectoryError: If files of this suffix cannot be written.
        InputError: If the file cannot be written there.
    """
    suffix = check_suffix(file)
    if suffix == ".csv":
        write_csv(trajectory, file, vehicle=vehicle)
    elif suffix == ".json":
        write_json(trajectory, file, vehicle=vehicle)
    else:
        raise _refused(file, suffix)


def check_suffix(file: FilePath | str) -> str:
    """Return the file's suffix in lower case.

    Raises:
        TrajectoryError: If it is not one of `SUFFIXES`.
    """
    suffix = FilePath(file).suffix.lower()
    if suffix not in SUFFIXES:
        raise _refused(file, suffix)
    return suffix


def _refused(file: FilePath | str, suffix: str) -> TrajectoryError:
    problem = "trajectories in files of this kind are not supported"
    if suffix == ".mcap":
        problem = "MCAP is not supported yet"
    allowed = " or ".join(SUFFIXES)
    return TrajectoryError(problem, file=str(file), value=suffix, allowed=allowed)
