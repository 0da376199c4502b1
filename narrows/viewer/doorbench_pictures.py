"""The pictures of DoorBench: a scene with everybody's way, and all planners at a glance."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.ticker import LogLocator, NullFormatter

from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import Array

from . import palette
from .motion_drawing import swept_area
from .scene_drawing import draw_ends, draw_world, outline_of
from .study_axes import new_figure, study_style
from .view_box import view_box

_STYLE = study_style(11)
# Colour, dashes, marker: told apart without colour too. The order is that of the planners.
_LOOKS: tuple[tuple[str, Any, str], ...] = (
    (palette.BLUE, "-", "o"),
    (palette.SKY, (0, (7, 2)), "s"),
    (palette.GREEN, "-", "^"),
    (palette.PINK, (0, (7, 2)), "v"),
    (palette.ORANGE, (0, (3, 1.5, 1, 1.5)), "D"),
    (palette.RED, (0, (2, 1.2)), "P"),
    (palette.INK, (0, (1, 1)), "X"),
    (palette.OUTLINE, "-", "*"),
    (palette.GREEN, (0, (1, 1)), "<"),
)
_OFFSET = 0.32  # of the distance between two levels, within which the planners stand


@dataclass(frozen=True, eq=False)
class DrawnWay:
    """A planner's way through a scene.

    Attributes:
        planner: Its name.
        path: The way.
        progress: Where the curvature is known, shape (N,), [m or rad].
        curvature: The curvature there, shape (N,), [1/m].
        is_valid: Whether it is proven drivable.
        clearance_mm: Its clearance, negative where it cuts [mm].
        integral_k2: Its integral of squared curvature [1/m].
    """

    planner: str
    path: Path
    progress: Array
    curvature: Array
    is_valid: bool
    clearance_mm: float
    integral_k2: float


def look_of(planner: str, planners: Sequence[str]) -> tuple[str, Any, str]:
    """Return colour, dashes and marker of a planner among others."""
    return _LOOKS[list(planners).index(planner) % len(_LOOKS)]


def scene_figure(
    scene: Scene, ways: Sequence[DrawnWay], planners: Sequence[str], text: str
) -> Figure:
    """Return a scene with the body swept along the first way, and the curvature of all.

    Args:
        scene: The scene.
        ways: The ways claimed.
        planners: All planners compared, in the order of their looks.
        text: What the first planner says.
    """
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(12.0, 8.2)
        left, right = figure.subplots(1, 2, width_ratios=[1.35, 1.0])
        view = view_box(scene, [way.path for way in ways])
        draw_world(left, scene, view)
        for way in ways[:1]:
            colour = look_of(way.planner, planners)[0] if way.is_valid else palette.REFUSED
            area = PathPatch(outline_of(swept_area(scene.vehicle.outline, way.path)))
            area.set(facecolor=colour, alpha=0.16, edgecolor="none", zorder=1)
            left.add_patch(area)
        for way in reversed(ways):
            _draw_way(left, right, way, planners, first=way is ways[0])
        draw_ends(left, scene)
        left.set(xlim=view[::2], ylim=view[1::2], xlabel="x [m]", ylabel="y [m]")
        left.set_aspect("equal")
        left.set_title(textwrap.fill(text, 70), fontsize=10.5)
        _finish_curvature(right, scene, ways)
        figure.suptitle(f"{scene.name}: ways of the drive axle", fontsize=14, fontweight="bold")
        handles, labels = right.get_legend_handles_labels()
        if handles:
            figure.legend(
                handles[::-1], labels[::-1], loc="outside lower center", ncols=2, fontsize=11
            )
    return figure


def _draw_way(
    left: Axes, right: Axes, way: DrawnWay, planners: Sequence[str], *, first: bool
) -> None:
    colour, dashes, _ = look_of(way.planner, planners)
    style: dict[str, Any] = {"color": colour, "linestyle": dashes}
    style["linewidth"] = 2.6 if first else 1.6
    points = way.path(np.linspace(0.0, way.path.span, 600))[:, :2]
    left.plot(*points.T, zorder=4.0 if first else 3.5, **style)
    verdict = f"{way.clearance_mm:.1f} mm clear" if way.is_valid else "refused"
    if not way.is_valid and way.clearance_mm < 0.0:
        verdict = f"refused, cuts {-way.clearance_mm:.1f} mm"
    label = f"{way.planner}: {verdict}, ∫ curvature² {way.integral_k2:.2f} 1/m"
    right.plot(way.progress, way.curvature, label=label, zorder=4.0 if first else 3.5, **style)


def _finish_curvature(axes: Axes, scene: Scene, ways: Sequence[DrawnWay]) -> None:
    limit = scene.vehicle.limits.curvature
    if np.isfinite(limit):
        for sign in (-1.0, 1.0):
            axes.axhline(sign * limit, color=palette.INK, linewidth=1.0, linestyle=":")
        axes.set_ylim(-1.15 * limit, 1.15 * limit)
        axes.annotate(
            f"limit {limit:g} 1/m",
            (0.01, limit),
            xycoords=("axes fraction", "data"),
            xytext=(0, 4),
            textcoords="offset points",
            fontsize=10,
        )
    axes.axhline(0.0, color=palette.PALE, linewidth=1.0, zorder=0)
    axes.set(xlabel="progress [m]", ylabel="mean curvature over 2 cm [1/m]")
    if not ways:
        axes.text(0.5, 0.5, "nobody claims a way", ha="center", transform=axes.transAxes)


def summary_figure(
    rows: Sequence[Mapping[str, Any]], planners: Sequence[str], levels: Sequence[str]
) -> Figure:
    """Return what all planners found, cost and are worth, by level.

    Args:
        rows: One for each scene and planner, with the columns of the study's table.
        planners: The planners in the order of their looks.
        levels: The levels from left to right.
    """
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(12.0, 9.0)
        panels = figure.subplots(2, 2)
        _draw_shares(panels[0, 0], rows, planners, levels)
        quantities = (
            (panels[0, 1], "plan_cpu_s", "CPU time of a plan [s]", False),
            (panels[1, 0], "integral_k2", "integral of squared curvature [1/m]", True),
            (panels[1, 1], "clearance_mm", "proven clearance [mm]", True),
        )
        for axes, name, title, valid_only in quantities:
            _draw_quantity(axes, rows, planners, levels, name, valid_only=valid_only)
            axes.set_title(title + (", valid paths" if valid_only else ", every attempt"))
        for axes in (panels[0, 1], panels[1, 0]):
            axes.set_yscale("log")
            axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axes.yaxis.set_major_formatter("{x:g}")
            axes.yaxis.set_minor_formatter(NullFormatter())
        for axes in panels.ravel():
            axes.set_xticks(range(len(levels)), levels)
            axes.grid(axis="y", color=palette.PALE, linewidth=0.6)
            axes.set_axisbelow(True)
        figure.suptitle(
            "Dots: median; bars: tenth to ninetieth percentile; a level's number: door wider "
            "than the chair [cm]",
            fontsize=12,
        )
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=11)
    return figure


def _places(planners: Sequence[str]) -> Array:
    """Return where planners stand about a level, shape (P,)."""
    if len(planners) == 1:
        return np.zeros(1)
    return np.linspace(-_OFFSET, _OFFSET, len(planners))


def _draw_shares(
    axes: Axes,
    rows: Sequence[Mapping[str, Any]],
    planners: Sequence[str],
    levels: Sequence[str],
) -> None:
    """Draw the share of scenes with a valid path as bars, with what is claimed and invalid."""
    width = 2.0 * _OFFSET / max(len(planners) - 1, 1)
    for planner, place in zip(planners, _places(planners), strict=True):
        colour = look_of(planner, planners)[0]
        for number, level in enumerate(levels):
            own = [r for r in rows if r["planner"] == planner and r["level"] == level]
            if not own:
                continue
            valid = 100.0 * sum(bool(r["is_valid"]) for r in own) / len(own)
            claimed = 100.0 * sum(bool(r["is_claimed"]) for r in own) / len(own)
            x = number + place
            label = planner if number == 0 else None
            axes.bar(x, valid, 0.9 * width, color=colour, label=label)
            if claimed > valid:
                axes.bar(
                    x,
                    claimed - valid,
                    0.9 * width,
                    bottom=valid,
                    facecolor="white",
                    edgecolor=colour,
                    hatch="////",
                    linewidth=1.0,
                )
    axes.set_ylim(0.0, 105.0)
    axes.set_ylabel("scenes [%]")
    axes.set_title("valid path; hatched: claimed but invalid")


def _draw_quantity(
    axes: Axes,
    rows: Sequence[Mapping[str, Any]],
    planners: Sequence[str],
    levels: Sequence[str],
    name: str,
    *,
    valid_only: bool,
) -> None:
    for planner, place in zip(planners, _places(planners), strict=True):
        colour, _, marker = look_of(planner, planners)
        for number, level in enumerate(levels):
            values = [
                float(r[name])
                for r in rows
                if r["planner"] == planner
                and r["level"] == level
                and r[name] is not None
                and (r["is_valid"] or not valid_only)
            ]
            if not values:
                continue
            low, middle, high = np.quantile(values, [0.1, 0.5, 0.9])
            axes.plot([number + place] * 2, [low, high], color=colour, linewidth=1.6)
            axes.plot(number + place, middle, marker, color=colour, markersize=6)
