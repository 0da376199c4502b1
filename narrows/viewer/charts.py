"""Curvature, speeds, clearance and tracking error along a motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from narrows.clearance import clearance_at
from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import Array
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle

from . import palette

_PIVOT = 20.0  # 1/m: a tighter bend, of what was driven, is a turn on the spot
_SHOWN = 0.3  # m: more clearance is not drawn unless there is nowhere less


@dataclass(frozen=True, eq=False)
class TrackingErrors:
    """How far a drive was from its plan.

    Attributes:
        times: Times, shape (N,), [s].
        cross_track: Distance from the planned path, positive on its left, shape (N,), [m].
        lookahead: Error a look-ahead tracker steers by, shape (N,), [m]; None if there is none.
    """

    times: Array
    cross_track: Array
    lookahead: Array | None = None


def _samples(motion: Path | Trajectory) -> tuple[Array, Array, str]:
    """Return the abscissa (N,), the progress there (N,), and what the abscissa is."""
    if isinstance(motion, Trajectory):
        times = motion.times
        return times, motion.progress(times), "time [s]"
    progress = np.linspace(0.0, motion.span, 600)
    turns = bool((motion.directions == 0).any())
    return progress, progress, "progress [m or rad]" if turns else "arc length [m]"


def draw_curvature(axes: Axes, motion: Path | Trajectory, vehicle: Vehicle, colour: str) -> None:
    """Draw the curvature of the path, with the chair's limit if it has one."""
    abscissa, progress, name = _samples(motion)
    path = motion.path if isinstance(motion, Trajectory) else motion
    curvature = path.curvature(progress)
    curvature[np.abs(curvature) > _PIVOT] = np.nan  # as good as on the spot: a gap
    axes.plot(abscissa, curvature, color=colour, linewidth=1.8)
    greatest = path.max_curvature  # between the samples too
    if greatest > _PIVOT:
        greatest = float(np.nanmax(np.abs(curvature), initial=0.0))
    limit = vehicle.limits.curvature
    if math.isfinite(limit) and limit <= 3.0 * max(greatest, 0.5):
        _draw_limit(axes, limit, both=bool(np.nanmin(curvature, initial=0.0) < -0.3 * limit))
        axes.legend(loc="best", fontsize=9, framealpha=0.85)
    if greatest < 0.2:
        axes.set_ylim(-0.5, 0.5)
    _finish(axes, f"curvature, at most {greatest:.2f} 1/m", name, "curvature [1/m]")


def draw_speeds(axes: Axes, trajectory: Trajectory, vehicle: Vehicle, colour: str) -> None:
    """Draw the speeds of the body origin and of the wheels' rims over time."""
    times = trajectory.times
    # Speeds of driven rows jump from row to row: between them they are what they are.
    times = 0.5 * (times[1:] + times[:-1]) if trajectory.sampled else times
    commands = trajectory.command(times)
    wheels = vehicle.wheel_speeds(commands)
    axes.plot(times, commands[:, 0], color=colour, linewidth=2.2, label="drive axle")
    axes.plot(times, wheels[:, 0], color=palette.ORANGE, linewidth=1.3, ls="--", label="left wheel")
    axes.plot(times, wheels[:, 1], color=palette.GREEN, linewidth=1.3, ls="-.", label="right wheel")
    axes.legend(loc="best", fontsize=9, framealpha=0.85)
    _finish(axes, f"speeds, {trajectory.duration:.1f} s in all", "time [s]", "speed [m/s]")


def draw_clearance(axes: Axes, motion: Path | Trajectory, scene: Scene, colour: str) -> None:
    """Draw the clearance from what stands still, with the margin asked for."""
    abscissa, progress, name = _samples(motion)
    path = motion.path if isinstance(motion, Trajectory) else motion
    if len(progress) > 600:
        chosen = np.linspace(0, len(progress) - 1, 600).astype(int)
        abscissa, progress = abscissa[chosen], progress[chosen]
    clearance, _ = clearance_at(scene.world, scene.vehicle, path(progress))
    if not np.isfinite(clearance).all():
        axes.text(0.5, 0.5, "nothing to touch", ha="center", transform=axes.transAxes)
        _finish(axes, "clearance", name, "clearance [mm]")
        return
    axes.plot(abscissa, 1e3 * clearance, color=colour, linewidth=1.8)
    below = clearance < 0.0
    if below.any():
        axes.fill_between(abscissa, 1e3 * clearance, 0.0, where=below, color=palette.RED, alpha=0.4)
    axes.axhline(1e3 * scene.margin, color=palette.INK, linewidth=1.0, linestyle=":")
    axes.annotate(
        f"margin {1e3 * scene.margin:.0f} mm",
        (1.0, 1e3 * scene.margin),
        xycoords=("axes fraction", "data"),
        xytext=(-4, 3),
        textcoords="offset points",
        ha="right",
        fontsize=9,
        bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
    )
    least = float(clearance.min())
    axes.set_ylim(min(0.0, 1.1e3 * least), 1.05e3 * min(max(_SHOWN, 2.0 * least), clearance.max()))
    _finish(axes, "clearance from what stands still", name, "clearance [mm]")


def draw_tracking(axes: Axes, errors: TrackingErrors) -> None:
    """Draw the tracking errors of a drive over time."""
    cross = 1e3 * errors.cross_track
    axes.plot(errors.times, cross, color=palette.BLUE, linewidth=1.8, label="cross-track")
    if errors.lookahead is not None:
        ahead = 1e3 * errors.lookahead
        axes.plot(
            errors.times, ahead, color=palette.ORANGE, linewidth=1.3, ls="--", label="look-ahead"
        )
        axes.legend(loc="best", fontsize=9, framealpha=0.85)
    axes.axhline(0.0, color=palette.OUTLINE, linewidth=0.8)
    greatest = float(np.abs(cross).max(initial=0.0))
    if greatest < 5.0 and errors.lookahead is None:
        axes.set_ylim(-6.0, 6.0)
    _finish(axes, f"tracking error, at most {greatest:.1f} mm", "time [s]", "error [mm]")


def _draw_limit(axes: Axes, limit: float, *, both: bool) -> None:
    for sign in (1.0, -1.0) if both else (1.0,):
        label = f"limit {limit:g} 1/m" if sign > 0.0 else None
        axes.axhline(sign * limit, color=palette.INK, linewidth=1.0, linestyle=":", label=label)


def _finish(axes: Axes, title: str, abscissa: str, ordinate: str) -> None:
    axes.set_title(title, fontsize=11)
    axes.set_xlabel(abscissa)
    axes.set_ylabel(ordinate)
    axes.grid(visible=True, color=palette.PALE, linewidth=0.6)
    axes.margins(x=0.01)
