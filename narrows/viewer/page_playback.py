"""Playing a motion on the page: play, pause, time, speed, and plots that follow the time."""

from __future__ import annotations

import math
import threading
import time as clock
from collections.abc import Callable
from typing import Any

import numpy as np
from viser import GuiApi, uplot

from narrows.se2 import Array

from . import palette
from .page_motion import Curve, Motion

RATES = {"¼ ×": 0.25, "½ ×": 0.5, "1 ×": 1.0, "2 ×": 2.0, "4 ×": 4.0}

STATES = {
    "goal": palette.BLUE,
    "zone": "#B35900",
    "stopped": palette.WALL,
    "backing": palette.RED,
    "full user control": palette.BLUE,
    "braking": palette.RED,
    "obstacle avoidance": "#B35900",
    "restoring orientation": palette.GREEN,
}
"""Colours of who is in control: of the words, the body and the way driven."""

_FRAME = 0.04  # s between frames
_PLOT_EVERY = 3  # frames
_LINES = (palette.BLUE, palette.ORANGE, palette.GREEN, palette.PINK)
_PLOTS = 4


class Playback:
    """The time of the motion that is shown, and who moves it."""

    def __init__(self, gui: GuiApi, show: Callable[[Motion, float], None]) -> None:
        """Add play, time, speed and the plots; nothing to play yet.

        Args:
            gui: The page.
            show: Called with the motion and the time [s] that is to be seen.
        """
        self._show = show
        self._lock = threading.RLock()
        self._motion: Motion | None = None
        self._playing = threading.Event()
        self.button = gui.add_button("Play", disabled=True)
        self.button.on_click(lambda _: self.pause() if self._playing.is_set() else self.play())
        self.slider: Any = gui.add_slider(
            "time [s]", 0.0, 1.0, step=0.01, initial_value=0.0, disabled=True
        )
        self.slider.on_update(self._moved)
        self.rate: Any = gui.add_dropdown("speed", tuple(RATES), initial_value="1 ×")
        self.now = gui.add_html("")
        self._gui = gui
        self._folder = gui.add_folder("Plots", visible=False)
        self._plots: list[Any] = []
        self._thread: threading.Thread | None = None

    @property
    def motion(self) -> Motion | None:
        """What is played."""
        return self._motion

    def load(self, motion: Motion | None) -> None:
        """Take a motion to play from its start; None: nothing."""
        with self._lock:
            self.pause()
            self._motion = motion
            for plot in self._plots:
                plot.remove()
            self._plots = []
            self.button.disabled = self.slider.disabled = motion is None
            self._folder.visible = motion is not None
            self.slider.value = 0.0
            if motion is None:
                self.now.content = ""
                return
            self.slider.max = round(motion.duration, 2)
            with self._folder:
                for curve in motion.curves[:_PLOTS]:
                    self._plots.append(_plot(self._gui, motion, curve))
            self._follow(0.0, plots=True)

    def play(self) -> None:
        """Play from where the slider stands; from the start if it stands at the end."""
        with self._lock:
            if self._motion is None or self._playing.is_set():
                return
            if self.slider.value >= self.slider.max - 0.01:
                self.slider.value = 0.0
            self._playing.set()
            self.button.label = "Pause"
            self._thread = threading.Thread(target=self._run, args=(self._motion,), daemon=True)
            self._thread.start()

    def pause(self) -> None:
        """Stop playing."""
        self._playing.clear()
        self.button.label = "Play"

    def _run(self, motion: Motion) -> None:
        frame = 0
        before = clock.monotonic()
        while self._playing.wait(0.0):
            clock.sleep(_FRAME)
            now = clock.monotonic()
            with self._lock:
                if self._motion is not motion or not self._playing.is_set():
                    return
                at = float(self.slider.value) + (now - before) * RATES[str(self.rate.value)]
                at, ended = min(at, motion.duration), at >= motion.duration
                before, frame = now, frame + 1
                self.slider.value = at
                self._follow(at, plots=ended or frame % _PLOT_EVERY == 0)
                if ended:
                    self.pause()

    def _moved(self, event: Any) -> None:
        if event.client is not None and self._motion is not None:
            with self._lock:
                self._follow(float(self.slider.value), plots=True)

    def _follow(self, at: float, *, plots: bool) -> None:
        """Show a time: the chair, the words and the plots."""
        motion = self._motion
        if motion is None:
            return
        self._show(motion, at)
        self.now.content = _now(motion, at)
        if plots:
            for plot, curve in zip(self._plots, motion.curves, strict=False):
                plot.data = curve_data(motion.times, curve.values, at, curve.most)


def curve_data(times: Array, values: Array, at: float, most: float = math.inf) -> tuple[Array, ...]:
    """Return times, the lines, and an upright line at a time, in arrays of one length.

    The upright line is two more rows at that time, where the lines themselves are interpolated.

    Args:
        times: Shape (N,), [s].
        values: Shape (N, L).
        at: Where the upright line stands [s].
        most: Where the upright line ends at the latest.
    """
    place = int(np.searchsorted(times, at))
    low, high = limits(values, most)
    here = np.array([np.interp(at, times, column) for column in values.T])
    lines = np.insert(values, [place, place], here, axis=0)
    upright = np.full(len(lines), np.nan)
    upright[place : place + 2] = low, high
    return (np.insert(times, [place, place], at), *np.ascontiguousarray(lines.T), upright)


def limits(values: Array, most: float = math.inf) -> tuple[float, float]:
    """Return the range a plot shows: all values up to `most`, and zero."""
    finite = values[np.isfinite(values)]
    low, high = min(0.0, finite.min(initial=0.0)), max(0.0, finite.max(initial=0.0))
    room = 0.05 * (high - low) or 1.0
    return float(low - room * (low < 0.0)), float(min(high + room, most))


def _plot(gui: GuiApi, motion: Motion, curve: Curve) -> Any:
    low, high = limits(curve.values, curve.most)
    series = [uplot.Series(label="t [s]")]
    for name, colour in zip(curve.names, _LINES, strict=False):
        series.append(
            uplot.Series(label=name, stroke=colour, width=2, points=uplot.Series_Points(show=False))
        )
    series.append(
        uplot.Series(
            label="now", stroke=palette.INK, width=2, points=uplot.Series_Points(show=False)
        )
    )
    return gui.add_uplot(
        data=curve_data(motion.times, curve.values, 0.0, curve.most),
        series=tuple(series),
        title=curve.title,
        scales={
            "x": uplot.Scale(time=False, auto=False, range=(0.0, motion.duration)),
            "y": uplot.Scale(range=(low, high)),
        },
        axes=(uplot.Axis(size=28), uplot.Axis(size=48)),
        legend=uplot.Legend(show=False),
        padding=(10, 10, 0, 0),
        height=125,
    )


def state_colour(state: str) -> str:
    """Return the colour of who is in control; blue for what has no colour of its own."""
    return STATES.get(state, palette.BLUE)


def _now(motion: Motion, at: float) -> str:
    """Return the figures of a time as HTML."""
    cells = [f"<b>{motion.name}</b> at {at:.2f} s"]
    if motion.states:
        state = motion.state(at)
        chip = f"background:{state_colour(state)};color:#fff;padding:0 6px;border-radius:3px"
        cells.append(f'in control: <b style="{chip}">{state}</b>')
    for curve in motion.curves[:_PLOTS]:
        figures = [np.interp(at, motion.times, column) for column in curve.values.T]
        places = 2 if "m/s" in curve.title else 0
        shown = " / ".join("–" if np.isnan(f) else f"{f:.{places}f}" for f in figures)
        cells.append(f"{curve.title}: <b>{shown}</b>")
    return (
        '<div class="narrows-now" style="margin:0 .7em .5em;font-size:12.5px;line-height:1.45">'
        + "<br>".join(cells)
        + "</div>"
    )
