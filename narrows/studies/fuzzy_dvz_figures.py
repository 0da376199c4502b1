"""The figures of the [FuzzyDVZ] study: its drives again, handed to the viewer."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..reactive.zone_shape import ZoneShape
from ..scene import write_scene
from .fuzzy_dvz_runs import BLIND, Drive, drive, guarded_options
from .fuzzy_dvz_scenes import PAPER_SCENES, cluttered

DRAWN = 6
"""Random worlds in the figure of them."""


def file_of(name: str, suffix: str = ".png") -> str:
    """Return the file of the figure, or with ".yaml" of the scene, of one of the paper's runs.

    >>> file_of("table, ball, chair")
    'table-ball-chair.png'
    """
    return name.replace(", ", "-").replace(" ", "-") + suffix


def draw(out: Path, seed: int, names: Sequence[str], worlds: int) -> None:
    """Draw the paper's runs, and some random worlds, into a folder; write the former's scenes.

    Args:
        out: Folder.
        seed: Of the random worlds.
        names: Of the paper's runs.
        worlds: Number of random worlds.
    """
    from ..viewer.fuzzy_dvz_pictures import DrawnRun, run_figure, worlds_figure
    from ..viewer.pictures import save_picture

    def drawn(title: str, found: Drive) -> DrawnRun:
        shape = guarded_options().zone or ZoneShape.around(found.scene.vehicle)
        return DrawnRun(title, found.reason, found.scene, found.record, shape.section(0.0))

    thresholds = guarded_options().thresholds
    for name in names:
        scene = PAPER_SCENES[name]()
        write_scene(scene, out / file_of(name, ".yaml"))
        figure = run_figure(
            drawn(name, drive(scene)),
            thresholds=(thresholds.leave, thresholds.enter),
            without=drive(scene, BLIND).record.poses,
        )
        save_picture(figure, str(out / file_of(name)))
    scenes = [cluttered(np.random.default_rng([seed, k])) for k in range(worlds)]
    runs = [drawn(f"world {k}", drive(scene)) for k, scene in enumerate(scenes)]
    save_picture(worlds_figure(runs), str(out / "worlds.png"))
