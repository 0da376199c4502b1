"""The driving-assistant study's figures, drawn from its tables and tracks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .assistant_course import BOUNDS
from .assistant_doors import HELP
from .assistant_localisation import read_map, track_file
from .assistant_paper import CONDITIONS
from .table import Table


def draw_tracks(file: Path, grid: Path, folder: Path, found: Table) -> None:
    """Draw where the filter found the drives of each test run, as in Fig. 8 of the paper.

    Args:
        file: Where to.
        grid: File of the learned map.
        folder: Where the tracks are.
        found: Table of the drives.
    """
    from ..viewer.assistant_pictures import DrawnMap, tracks_figure
    from ..viewer.pictures import save_picture

    panels = {}
    for run, (device, assisted) in CONDITIONS.items():
        tracks = {}
        for row in found.done.rows:
            if row["device"] == device and bool(row["assisted"]) == assisted:
                with np.load(track_file(folder, row)) as stored:
                    tracks[str(row["driver"])] = stored["found"]
        panels[f"{run}: {device}, {'assisted' if assisted else 'alone'}"] = tracks
    drawn = DrawnMap(read_map(grid).occupied, BOUNDS)
    save_picture(tracks_figure(drawn, panels), file)


def draw_doors(
    file: Path, doors: Table, offsets: Sequence[float], angles_deg: Sequence[float]
) -> None:
    """Draw what came of the doors, by where the drives began.

    Args:
        file: Where to.
        doors: Table of the drives.
        offsets: Beside the door's middle [m].
        angles_deg: From straight on [deg].
    """
    from ..viewer.assistant_pictures import DoorShares, doors_figure
    from ..viewer.pictures import save_picture

    panels = []
    for name in HELP:
        success = np.full((len(angles_deg), len(offsets)), math.nan)
        time = success.copy()
        for i, angle in enumerate(angles_deg):
            for k, offset in enumerate(offsets):
                rows = doors.done.where(help=name, angle_deg=angle, offset_m=offset).rows
                through = [float(row["time_s"] or 0.0) for row in rows if row["succeeded"]]
                success[i, k] = len(through) / max(len(rows), 1)
                if through:
                    time[i, k] = math.fsum(through) / len(through)
        panels.append(DoorShares(name, success, time))
    save_picture(doors_figure(panels, offsets, angles_deg), file)
