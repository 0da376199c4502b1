"""Table III of [DrivingAssistant] as printed, and the means recomputed from it."""

from __future__ import annotations

import math
from collections.abc import Sequence

RUNS = ("I", "II", "III", "IV")
"""Test runs: joystick alone, joystick assisted, head joystick alone, head joystick assisted."""

CONDITIONS = {
    "I": ("joystick", False),
    "II": ("joystick", True),
    "III": ("head-joystick", False),
    "IV": ("head-joystick", True),
}
"""Device and assistance of each run."""

ABORTED = ("S2", "III")
"""Subject and run that was aborted half-way; its figures count in no mean."""

TABLE_III: dict[str, tuple[tuple[float, float, int], ...]] = {
    "S1": ((71.45, 34.35, 0), (101.51, 34.97, 0), (106.12, 35.43, 0), (137.68, 47.93, 0)),
    "S2": ((78.98, 37.26, 1), (106.10, 36.20, 0), (50.09, 18.72, 0), (131.14, 43.71, 0)),
    "S3": ((66.51, 33.98, 0), (101.49, 35.80, 0), (131.68, 35.67, 0), (146.68, 41.30, 0)),
    "S4": ((77.57, 35.18, 0), (132.97, 40.42, 0), (113.24, 35.60, 0), (135.47, 38.73, 0)),
    "S5": ((68.62, 33.74, 0), (96.88, 34.10, 0), (99.97, 35.76, 1), (136.90, 40.13, 0)),
    "S6": ((70.99, 34.00, 0), (90.66, 35.36, 0), (116.69, 34.05, 1), (119.60, 37.72, 0)),
    "S7": ((86.21, 33.27, 0), (110.94, 34.39, 0), (100.44, 33.76, 0), (145.57, 39.44, 0)),
    "S8": ((78.05, 32.23, 1), (108.51, 34.88, 0), (90.24, 32.02, 1), (140.72, 46.63, 0)),
}
"""Time [s], distance [m] and collisions of each subject in runs I to IV, as printed."""

PRINTED_DISTANCE_III = 36.63
"""Mean distance of run III as printed in the text [m]: a misprint of 32.63, which is the mean of
all eight, the aborted half run included; without it 34.61."""


def column(run: str, which: int) -> list[float]:
    """Return a column of Table III without the aborted run: 0 time, 1 distance, 2 collisions."""
    number = RUNS.index(run)
    return [float(row[number][which]) for name, row in TABLE_III.items() if (name, run) != ABORTED]


def mean(values: Sequence[float]) -> float:
    """Return the mean."""
    return math.fsum(values) / len(values)


def mean_speed(run: str) -> float:
    """Return the mean over the subjects of distance by time [m/s]."""
    pairs = zip(column(run, 1), column(run, 0), strict=True)
    return mean([distance / time for distance, time in pairs])


def paired(first: str, second: str, which: int) -> tuple[list[float], list[float]]:
    """Return a column of two runs for the subjects who finished both."""
    a, b = RUNS.index(first), RUNS.index(second)
    kept = [
        row
        for name, row in TABLE_III.items()
        if (name, first) != ABORTED and (name, second) != ABORTED
    ]
    return [float(row[a][which]) for row in kept], [float(row[b][which]) for row in kept]
