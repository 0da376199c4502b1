"""The figures of the [FuzzyDVZ] study: paths by who drives, wheels, intrusion, changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from narrows.scene import Scene
from narrows.se2 import Array, transform
from narrows.simulation.record import Record
from narrows.world import Solid

from . import palette
from .study_axes import draw_body, draw_room, new_figure, study_style
from .view_box import ViewBox

_STYLE = study_style(11)
# Who drives by the value of the signal: name, colour, width; told apart without colour too.
_DRIVERS: dict[int, tuple[str, str, float]] = {
    0: ("goal controller", palette.BLUE, 2.2),
    1: ("zone", palette.RED, 4.2),
    3: ("backing off", palette.ORANGE, 6.0),
}


@dataclass(frozen=True, eq=False)
class DrawnRun:
    """A drive with what it drove through.

    Attributes:
        title: Its name.
        text: How it ended.
        scene: World, chair, goal.
        record: The drive, with the navigator's signals.
        zone: Outline of the zone at rest, body frame, shape (K, 2), [m].
    """

    title: str
    text: str
    scene: Scene
    record: Record
    zone: Array


def run_figure(
    run: DrawnRun, *, thresholds: tuple[float, float], without: Array | None = None
) -> Figure:
    """Return a run: the path by who drives; wheel speeds and intrusion over time.

    Args:
        run: The run.
        thresholds: Intrusions below and above which the controllers change.
        without: Poses of the same run without the zone, shape (N, 3), or None.
    """
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(12.0, 6.6)
        grid = figure.add_gridspec(3, 2, width_ratios=(1.15, 1.0))
        _draw_place(figure.add_subplot(grid[:, 0]), run, without)
        wheels = figure.add_subplot(grid[0, 1])
        _draw_wheels(wheels, run.record)
        intruded = figure.add_subplot(grid[1, 1], sharex=wheels)
        _draw_intrusion(intruded, run.record, thresholds)
        changes = figure.add_subplot(grid[2, 1], sharex=wheels)
        _draw_changes(changes, run.record)
        figure.suptitle(f"{run.title}: {run.text}", fontweight="bold")
    return figure


def worlds_figure(runs: Sequence[DrawnRun]) -> Figure:
    """Return the paths of several runs, a panel each."""
    with matplotlib.rc_context(_STYLE):
        rows = -(-len(runs) // 3)
        figure = new_figure(12.0, 4.2 * rows + 0.4)
        panels = figure.subplots(rows, 3, squeeze=False).ravel()
        for axes in panels[len(runs) :]:
            axes.set_axis_off()
        for axes, run in zip(panels, runs, strict=False):
            _draw_place(axes, run, None, legend=False)
            axes.set_title(f"{run.title}: {run.text}", fontsize=10)
        figure.legend(handles=_handles(None, runs), loc="outside lower center", ncols=6)
    return figure


def _view(run: DrawnRun) -> ViewBox:
    points = [run.record.poses[:, :2], run.scene.goal.pose[None, :2]]
    points += [np.array(s.shape.bounds).reshape(2, 2) for s in run.scene.world.solids]
    points += [s.path[:, 1:] for s in run.scene.world.moving]
    rows = np.concatenate(points)
    low, high = rows.min(axis=0) - 1.0, rows.max(axis=0) + 1.0
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _draw_place(axes: Axes, run: DrawnRun, without: Array | None, *, legend: bool = True) -> None:
    scene, record = run.scene, run.record
    draw_room(axes, scene.world, _view(run))
    _hatch_what_hangs(axes, run, named=legend)
    if without is not None:
        axes.plot(*without[:, :2].T, color=palette.INK, ls=(0, (2, 2)), lw=1.3, zorder=3)
    active = record.signals["active"].astype(int)
    segments = np.stack([record.poses[:-1, :2], record.poses[1:, :2]], axis=1)
    for value, (_, colour, width) in _DRIVERS.items():
        chosen = active[:-1] == value
        axes.add_collection(
            LineCollection(list(segments[chosen]), colors=colour, linewidths=width, zorder=4)
        )
    count = max(2, round(record.length / 1.2))
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(record.poses[:, :2], axis=0).T))])
    for share in np.linspace(0.0, 1.0, count):
        pose = record.poses[min(int(np.searchsorted(way, share * way[-1])), len(way) - 1)]
        draw_body(axes, pose, scene.vehicle, palette.OUTLINE)
    zone = transform(record.poses[0], run.zone)
    axes.plot(*np.vstack([zone, zone[:1]]).T, color=palette.GREEN, lw=1.2, ls=(0, (5, 2)), zorder=3)
    axes.plot(*scene.goal.pose[:2], "*", color=palette.GOAL, ms=15, mec="black", zorder=7)
    for solid in scene.world.moving:
        axes.plot(*solid.path[:, 1:].T, color=palette.PINK, ls=":", lw=1.6, zorder=2)
        for time in np.arange(0.0, solid.path[-1, 0] + 0.1, 4.0):
            place = solid.position(time)
            axes.add_patch(
                Circle((place[0], place[1]), solid.radius, color=palette.PINK, alpha=0.3)
            )
            axes.annotate(
                f"{time:.0f} s", (place[0], place[1]), ha="center", va="center", fontsize=8
            )
    if legend:
        axes.legend(
            handles=_handles(without, [run]),
            loc="upper center",
            bbox_to_anchor=(0.5, 0.0),
            borderaxespad=4.5,  # font sizes: below the axis' name, however low the panel is
            ncols=3,
            frameon=False,
            fontsize=9,
        )


def _hatch_what_hangs(axes: Axes, run: DrawnRun, *, named: bool) -> None:
    """Mark solids the chair passes under, and say how high the others hang."""
    for solid in run.scene.world.solids:
        if solid.z[0] <= 0.0:
            continue
        area = solid.shape.buffer(solid.radius) if solid.radius else solid.shape
        corners = shapely.get_coordinates(area)
        if _is_passed_under(solid, run.scene):
            axes.fill(
                *corners.T, facecolor="white", edgecolor=palette.OUTLINE, hatch="//", zorder=1.5
            )
        if not named:
            continue
        text = axes.annotate(
            f"{solid.z[0]:.2f} m up",
            (area.centroid.x, area.centroid.y),
            fontsize=8,
            ha="center",
            va="center",
            zorder=8,
        )
        text.set_bbox({"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.8})


def _is_passed_under(solid: Solid, scene: Scene) -> bool:
    return solid.z[0] >= scene.vehicle.height


def _handles(without: Array | None, runs: Sequence[DrawnRun]) -> list[Any]:
    handles: list[Any] = [
        Line2D([], [], color=colour, lw=width, label=name)
        for name, colour, width in _DRIVERS.values()
    ]
    handles.append(Line2D([], [], color=palette.GREEN, ls=(0, (5, 2)), label="zone at rest"))
    if without is not None:
        handles.append(Line2D([], [], color=palette.INK, ls=(0, (2, 2)), label="without the zone"))
    if any(run.scene.world.moving for run in runs):
        handles.append(Line2D([], [], color=palette.PINK, ls=":", label="person"))
    handles.append(Patch(facecolor=palette.WALL, label="in the chair's height"))
    if any(_is_passed_under(solid, run.scene) for run in runs for solid in run.scene.world.solids):
        handles.append(
            Patch(facecolor="white", edgecolor=palette.OUTLINE, hatch="//", label="passed under")
        )
    return handles


def _draw_wheels(axes: Axes, record: Record) -> None:
    axes.plot(record.times, record.wheel_speeds[:, 0], color=palette.ORANGE, label="left wheel")
    axes.plot(
        record.times, record.wheel_speeds[:, 1], color=palette.BLUE, ls=(0, (4, 1.5)), label="right"
    )
    axes.set_ylabel("speed [m/s]")
    axes.legend(loc="upper right", ncols=2, fontsize=9, frameon=False)
    axes.set_ylim(top=1.35 * max(float(record.wheel_speeds.max()), 0.1))


def _draw_intrusion(axes: Axes, record: Record, thresholds: tuple[float, float]) -> None:
    axes.plot(record.times, record.signals["intrusion"], color=palette.INK, lw=1.2)
    for value, name in zip(thresholds, ("leave", "enter"), strict=True):
        axes.axhline(value, color=palette.RED, lw=1.0, ls=(0, (4, 2)))
        axes.annotate(name, (1.0, value), xycoords=("axes fraction", "data"), fontsize=8)
    axes.set_yscale("symlog", linthresh=1e-3)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("intrusion I")


def _draw_changes(axes: Axes, record: Record) -> None:
    active = record.signals["active"].astype(int)
    for row, (value, (_, colour, _)) in enumerate(_DRIVERS.items()):
        axes.fill_between(
            record.times, row, row + 0.8, where=active == value, color=colour, step="post", lw=0
        )
    share = record.signals["guard_share"]
    row = len(_DRIVERS)
    slowed = (share < 1.0) & (active != 2)
    axes.fill_between(
        record.times, row, row + 0.8, where=slowed, color=palette.OUTLINE, step="post", lw=0
    )
    names = [*(name for name, _, _ in _DRIVERS.values()), "guard slows"]
    axes.set_yticks([place + 0.4 for place in range(row + 1)], names)
    axes.tick_params(axis="y", length=0)
    axes.set_ylim(0.0, row + 1.0)
    axes.set_xlabel(f"time [s]; {int(record.signals['switches'][-1])} changes")
