"""The three figures of the [DoorBezier] study: trajectories, errors along them, obstacles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from narrows import bezier
from narrows.se2 import Array
from narrows.vehicle import Vehicle
from narrows.world import World

from . import palette
from .study_axes import draw_body, draw_room, new_figure, study_style

_STYLE = study_style(12)
# Told apart by dashes too, for eyes and printers without colour.
_LINES: tuple[tuple[str, Any], ...] = (
    (palette.BLUE, "-"),
    (palette.ORANGE, (0, (6, 2))),
    (palette.GREEN, (0, (3, 1.5, 1, 1.5))),
    (palette.PINK, (0, (1.5, 1.2))),
)


_DRIVEN: Any = (0, (2.5, 1.6))


@dataclass(frozen=True, eq=False)
class DrawnTrajectory:
    """A reference curve with how it was driven.

    Attributes:
        name: Such as "A1".
        control: Control points, shape (4, 2), [m].
        driven: True positions, shape (N, 2), [m].
        parameter: Curve parameter at each control period, shape (K,).
        omega: Commanded yaw rate there, shape (K,), [rad/s].
        lookahead_error: D_err there, shape (K,), [m].
        hit: Pose where the reference cuts deepest into something, shape (3,), or None.
        depth_mm: How deep.
    """

    name: str
    control: Array
    driven: Array
    parameter: Array
    omega: Array
    lookahead_error: Array
    hit: Array | None = None
    depth_mm: float = 0.0


def trajectories_figure(
    world: World, vehicle: Vehicle, scenarios: Mapping[str, Sequence[DrawnTrajectory]]
) -> Figure:
    """Return reference and driven trajectories of both scenarios [DoorBezier, Fig. 5].

    Where a reference cuts the wall, the body is drawn at its deepest, for the worst of each
    scenario.
    """
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(12.0, 6.8)
        panels = figure.subplots(1, len(scenarios), squeeze=False)[0]
        views = {"A": (-1.2, 0.0, 3.3, 4.0), "B": (-0.4, 0.0, 4.1, 4.0)}
        for axes, (scenario, drawn) in zip(panels, scenarios.items(), strict=True):
            draw_room(axes, world, views.get(scenario, (-1.0, 0.0, 3.5, 4.0)))
            for (colour, _), one in zip(_LINES, drawn, strict=False):
                _draw_trajectory(axes, one, colour)
            worst = max(drawn, key=lambda one: one.depth_mm)
            if worst.hit is not None:
                draw_body(axes, worst.hit, vehicle, palette.REFUSED)
                text = f"the chair on {worst.name}\ncuts {worst.depth_mm:.0f} mm into the jamb"
                axes.annotate(
                    text,
                    worst.hit[:2],
                    (0.98, 0.1),
                    textcoords="axes fraction",
                    ha="right",
                    color=palette.REFUSED,
                    zorder=6,
                    arrowprops={"arrowstyle": "-", "color": palette.REFUSED},
                )
            axes.set_title(f"Scenario {scenario}")
            _zoom(axes, drawn[0], palette.BLUE, left=scenario != "A")
        for number, (colour, _) in enumerate(_LINES, start=1):
            panels[0].plot([], [], color=colour, linewidth=2.6, label=f"reference {number}")
        panels[0].plot([], [], color=palette.INK, lw=1.3, ls=_DRIVEN, label="driven")
        panels[0].plot([], [], "o", color=palette.OUTLINE, label="free control points")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=6, fontsize=11)
        figure.suptitle("Table I: the smoothest convex cubics and how they are driven", fontsize=14)
    return figure


def _draw_trajectory(axes: Axes, one: DrawnTrajectory, colour: str) -> None:
    """Draw a reference with its name and free control points, and how it was driven."""
    points = bezier.evaluate(one.control, np.linspace(0.0, 1.0, 300))
    axes.plot(*points.T, color=colour, linewidth=2.6, zorder=3)
    axes.plot(*one.driven.T, color=palette.INK, linewidth=1.3, ls=_DRIVEN, zorder=4)
    axes.plot(*one.control[1:3].T, "o", color=colour, markersize=5, zorder=4)
    first = one.name.endswith(("1", "2"))
    place = points[75] if first else points[200]
    outward = one.control[1:3].mean(axis=0) - place
    offset = 20.0 * outward / max(float(np.linalg.norm(outward)), 1e-9)
    axes.annotate(
        one.name,
        place,
        offset,
        textcoords="offset points",
        ha="center",
        va="center",
        color=colour,
        fontweight="bold",
        zorder=6,
        bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none"},
    )


def _zoom(axes: Axes, one: DrawnTrajectory, colour: str, *, left: bool) -> None:
    """Draw the place where the drive is furthest from the reference, ten times larger."""
    points = bezier.evaluate(one.control, np.linspace(0.0, 1.0, 2000))
    apart = np.linalg.norm(one.driven[:, None] - points[None, ::10], axis=2).min(axis=1)
    beyond = np.linalg.norm(one.driven - one.control[3], axis=1) < 0.1  # the end is not abeam
    apart[beyond] = 0.0
    x, y = one.driven[int(apart.argmax())]
    box = (0.03, 0.62, 0.3, 0.3) if left else (0.68, 0.62, 0.3, 0.3)
    inset = axes.inset_axes(box)
    inset.plot(*points.T, color=colour, linewidth=2.6)
    inset.plot(*one.driven.T, color=palette.INK, linewidth=1.5, ls=_DRIVEN)
    half = 0.06
    inset.set_xlim(x - half, x + half)
    inset.set_ylim(y - half, y + half)
    inset.set_aspect("equal")
    inset.set_xticks([])
    inset.set_yticks([])
    for spine in inset.spines.values():
        spine.set_visible(True)
    inset.set_title(f"{one.name}, 0.12 m wide:\n{1e3 * apart.max():.0f} mm apart", fontsize=10)
    axes.indicate_inset_zoom(inset, edgecolor=palette.INK)


def errors_figure(drawn: Sequence[DrawnTrajectory]) -> Figure:
    """Return yaw rate and look-ahead error over the curve parameter [DoorBezier, Fig. 6]."""
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(12.0, 7.0)
        above, below = figure.subplots(2, 1, sharex=True)
        for (colour, style), one in zip(_LINES, drawn, strict=False):
            above.plot(one.parameter, one.omega, color=colour, ls=style, lw=2.2, label=one.name)
            millimetres = 1e3 * one.lookahead_error
            label = f"{one.name}: at most {np.abs(millimetres).max():.0f} mm"
            below.plot(one.parameter, millimetres, color=colour, ls=style, lw=2.2, label=label)
        above.set_ylabel("yaw rate omega [rad/s]")
        below.set_ylabel("look-ahead error D_err [mm]")
        below.set_xlabel("curve parameter t [-]")
        below.set_xlim(0.0, 1.0)
        below.axhline(55.0, color=palette.OUTLINE, lw=1.0, ls=(0, (4, 4)), zorder=0)
        below.annotate(
            "the paper's 55 mm",
            (0.01, 55.0),
            (0, 4),
            textcoords="offset points",
            ha="left",
            fontsize=11,
            color=palette.INK,
        )
        for axes in (above, below):
            axes.axhline(0.0, color=palette.PALE, lw=1.0, zorder=0)
            axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=12)
        above.set_title("Scenario A driven with the paper's gains, 0.4 m/s, look-ahead 0.28 m")
    return figure


def obstacles_figure(
    world: World,
    vehicle: Vehicle,
    curves: Mapping[str, Array],
    driven: Array,
    hit: Array | None,
    text: str,
) -> Figure:
    """Return the trajectories with and without obstacles [DoorBezier, Fig. 7].

    Args:
        world: Walls and obstacles.
        vehicle: The chair.
        curves: Control points (K, 4, 2) by label, drawn in this order.
        driven: True positions of the drive around the obstacles, shape (N, 2), [m].
        hit: Pose where the chair cuts deepest, shape (3,), or None.
        text: What is to be said of it.
    """
    with matplotlib.rc_context(_STYLE):
        figure = new_figure(12.0, 9.0)
        axes = figure.subplots()
        draw_room(axes, world, (-0.9, 0.1, 3.6, 4.0))
        lines = ((palette.ORANGE, (0, (6, 2))), (palette.BLUE, "-"))
        for (colour, style), (label, control) in zip(lines, curves.items(), strict=False):
            points = bezier.evaluate(control[:, None], np.linspace(0.0, 1.0, 200)).reshape(-1, 2)
            axes.plot(*points.T, color=colour, ls=style, linewidth=2.6, label=label, zorder=3)
            free = control[:, 1:3].reshape(-1, 2)
            axes.plot(*free.T, "o", color=colour, markersize=6, zorder=4)
        axes.plot(*driven.T, color=palette.INK, lw=1.4, ls=_DRIVEN, label="driven", zorder=5)
        for solid in world.solids:
            if solid.radius > 0.0:
                center = (solid.shape.centroid.x, solid.shape.centroid.y)
                axes.annotate(
                    solid.name,
                    center,
                    (0, -24),
                    textcoords="offset points",
                    ha="center",
                    va="top",
                    fontsize=11,
                    zorder=6,
                )
        if hit is not None:
            label = "chair where it cuts deepest"
            draw_body(axes, hit, vehicle, palette.REFUSED, label=label)
        axes.legend(loc="upper right", fontsize=12)
        axes.set_title(text, fontsize=13)
    return figure
