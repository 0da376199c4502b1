"""Playing a motion on the page: play, pause, time, speed, and the figures of the time."""

from __future__ import annotations

import threading
import time as clock
from collections.abc import Callable
from typing import Any

import numpy as np
from viser import GuiApi

from .control_colours import state_chip
from .page_motion import Motion

RATES = {"¼ ×": 0.25, "½ ×": 0.5, "1 ×": 1.0, "2 ×": 2.0, "4 ×": 4.0}

_FRAME = 0.04  # s between frames
_PLOT_EVERY = 3  # frames


class Playback:
    """The time of the motion that is shown, and who moves it."""

    def __init__(
        self,
        gui: GuiApi,
        show: Callable[[Motion, float], None],
        plot: Callable[[float], None],
    ) -> None:
        """Add play, time and speed; nothing to play yet.

        Args:
            gui: The page.
            show: Called with the motion and the time [s] that is to be seen, every frame.
            plot: Called with the time [s] that is to be seen, less often.
        """
        self._show, self._plot = show, plot
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
            self.button.disabled = self.slider.disabled = motion is None
            self.slider.value = 0.0
            if motion is None:
                self.now.content = ""
                return
            self.slider.max = round(motion.duration, 2)
            self._follow(0.0, plots=True)

    def tell(self, state: str) -> None:
        """Say who is in control of a drive under way, that is not played yet."""
        shown = f"in control: {state_chip(state)}" if state else ""
        self.now.content = _boxed(shown)

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
            self._plot(at)


def _now(motion: Motion, at: float) -> str:
    """Return the figures of a time as HTML."""
    cells = [f"<b>{motion.name}</b> at {at:.2f} s"]
    if motion.states:
        cells.append(f"in control: {state_chip(motion.state(at))}")
    for curve in motion.curves:
        figures = [np.interp(at, motion.times, column) for column in curve.values.T]
        shown = " / ".join("–" if np.isnan(f) else f"{f:z.{curve.places}f}" for f in figures)
        cells.append(f"{curve.title}: <b>{shown}</b>")
    return _boxed("<br>".join(cells))


def _boxed(words: str) -> str:
    looks = "margin:0 .7em .5em;font-size:12.5px;line-height:1.45"
    return f'<div class="narrows-now" style="{looks}">{words}</div>'
