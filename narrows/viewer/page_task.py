"""What a tab has under way beside the page: asked, told of, cancelled, replaced by newer."""

from __future__ import annotations

import threading
import time as clock
from collections.abc import Callable
from typing import Any

from viser import GuiApi

from .page_guard import Guard
from .page_jobs import Job, JobRunner
from .page_report import Told, Work
from .page_words import Words

_TICK = 0.2  # s between words about work under way

Done = Callable[[Any], None]
"""Called with what came of the work, while the guard's lock is held."""


class Task:
    """At most one job of a tab, with its bar and the button that cancels it."""

    def __init__(
        self,
        gui: GuiApi,
        guard: Guard,
        runner: JobRunner,
        say: Callable[[Words], None],
        moved: Callable[[Any, float, str], None],
        ended: Callable[[], None],
    ) -> None:
        """Add bar and button, out of sight.

        Args:
            gui: The page.
            guard: Whose lock is held whenever something is called.
            runner: Runs the jobs.
            say: Says how it stands.
            moved: Called with pose (3,), time [s] and who is in control where a chair is on its
                way in real time.
            ended: Called when work ends, however it does.
        """
        self._guard = guard
        self._runner = runner
        self._say, self._moved, self._ended = say, moved, ended
        self._jobs: list[Job] = []
        self._asked = 0
        self._doing = ""
        self._bar: Any = gui.add_progress_bar(0.0, visible=False, animated=True)
        self._button = gui.add_button("Cancel", color="red", visible=False)
        self._button.on_click(guard(lambda _: self.cancel()))

    def ask(self, words: str, work: Work, arguments: tuple[Any, ...], done: Done) -> None:
        """Start work; what was under way is ended, and nothing more is heard of it.

        Args:
            words: What is being done, for people.
            work: See `JobRunner.start`.
            arguments: What it is called with.
            done: Called with its result.
        """
        self.end()
        self._button.visible = self._bar.visible = True
        self._bar.value = 100.0
        self._doing = words
        self._say(Words("busy", f"{words} …"))
        self._start(work, arguments, lambda told: self._hear(told, done))
        begun, number = clock.monotonic(), self._asked

        def tick() -> None:
            while True:
                with self._guard.lock:
                    if number != self._asked:
                        return
                    spent = f"{clock.monotonic() - begun:.1f} s"
                    self._say(Words("busy", f"{self._doing} …", spent, "The page stays usable."))
                clock.sleep(_TICK)

        threading.Thread(target=tick, daemon=True).start()

    def also(self, work: Work, arguments: tuple[Any, ...], done: Done) -> None:
        """Start work of which only the result is told; it ends when anything else is asked."""

        def hear(told: Told) -> None:
            if told.kind == "result":
                done(told.value)

        self._start(work, arguments, hear)

    def tell(self, value: Any) -> None:
        """Tell the work under way something."""
        with self._guard.lock:
            for job in self._jobs:
                job.tell(value)

    def cancel(self) -> None:
        """End what is under way, and say so."""
        self.end()
        self._say(Words("quiet", "cancelled", "", "Nothing was changed."))

    def end(self) -> None:
        """End what is under way."""
        self._asked += 1
        for job in self._jobs:
            job.cancel()
        self._jobs = []
        self._button.visible = self._bar.visible = False
        self._bar.animated = True
        self._ended()

    def _start(self, work: Work, arguments: tuple[Any, ...], hear: Callable[[Told], None]) -> None:
        number = self._asked

        def heard(told: Told) -> None:
            with self._guard.lock:
                if number == self._asked:
                    hear(told)

        self._jobs.append(self._runner.start(work, *arguments, heard=heard))

    def _hear(self, told: Told, done: Done) -> None:
        value = told.value
        if told.kind == "progress" and isinstance(value, dict):
            self._moved(value["pose"], float(value["time"]), str(value["state"]))
        elif told.kind == "progress" and isinstance(value, str):
            self._doing = value
        elif told.kind == "progress":
            self._bar.animated = False
            self._bar.value = 100.0 * float(value)
        elif told.kind == "result":
            self.end()
            done(value)
        else:
            self.end()
            self._say(Words("bad", "no answer", "", str(value)))
