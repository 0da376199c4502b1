"""Work beside the page: each job in a process of its own, forked from one that is warm.

The page's threads only wait for messages.
"""

from __future__ import annotations

import atexit
import itertools
import multiprocessing
import threading
from collections.abc import Callable, Sequence
from multiprocessing.process import BaseProcess
from typing import Any

from .page_forge import end_group, forge
from .page_report import Told, Work

_PATIENCE = 5.0  # s the forge has to end
_GONE = Told("broken", "the process that plans has ended: start the page again")


class Job:
    """A piece of work under way."""

    def __init__(self, number: int, runner: JobRunner) -> None:
        """Keep where to cancel."""
        self._number = number
        self._runner = runner

    def tell(self, value: Any) -> None:
        """Tell the work something while it is under way."""
        self._runner.tell(self._number, value)

    def cancel(self) -> None:
        """End the work; nothing more is heard of it. Of a job that has ended, nothing."""
        self._runner.cancel(self._number)


class JobRunner:
    """Runs functions in processes forked from a warm one."""

    def __init__(self, warm: Sequence[Work] = ()) -> None:
        """Wait for the first job, or for `begin`.

        Args:
            warm: What the forge builds before any job and while nothing is asked for.
        """
        self._warm = tuple(warm)
        self._numbers = itertools.count(1)
        self._listeners: dict[int, Callable[[Told], None]] = {}
        self._lock = threading.Lock()
        self._forge: BaseProcess | None = None
        self._closed = False

    def begin(self) -> None:
        """Start the forge, if it does not run yet: it takes a core for a second to warm up."""
        with self._lock:
            if self._forge is not None or self._closed:
                return
            context = multiprocessing.get_context("spawn")  # this process has threads: no fork
            self._connection, theirs = context.Pipe()
            self._forge = context.Process(target=forge, args=(theirs, self._warm))
            self._forge.start()
            theirs.close()
        atexit.register(self.close)
        threading.Thread(target=self._listen, name="page-jobs", daemon=True).start()

    def start(self, work: Work, *arguments: Any, heard: Callable[[Told], None]) -> Job:
        """Start work(report, *arguments) in a process of its own.

        Args:
            work: A function at the top of a module.
            arguments: What it is called with; it gets copies.
            heard: Called with all that the job tells, in another thread.
        """
        self.begin()
        number = next(self._numbers)
        with self._lock:
            self._listeners[number] = heard
            sent = self._send("start", number, work, arguments)
            if not sent:
                del self._listeners[number]
        if not sent:
            heard(_GONE)
        return Job(number, self)

    def tell(self, number: int, value: Any) -> None:
        """Tell a job something, by its number."""
        with self._lock:
            if number in self._listeners:
                self._send("tell", number, value, ())

    def cancel(self, number: int) -> None:
        """End a job by its number."""
        with self._lock:
            if self._listeners.pop(number, None) is not None:
                self._send("cancel", number, None, ())

    def close(self) -> None:
        """End all jobs and the forge."""
        atexit.unregister(self.close)
        with self._lock:
            self._closed = True
            self._listeners.clear()
            if self._forge is None:
                return
        end_group(self._forge)
        self._forge.join(timeout=_PATIENCE)

    def _send(self, *order: Any) -> bool:
        """Send an order to the forge and return whether it is there."""
        if self._forge is None:
            return False
        try:
            self._connection.send(order)
        except OSError:
            return False
        return True

    def _listen(self) -> None:
        while True:
            try:
                number, told = self._connection.recv()
            except (EOFError, OSError):
                break
            with self._lock:
                ended = told.kind != "progress"
                heard = self._listeners.get(number)
                if ended:
                    self._listeners.pop(number, None)
            if heard is not None:
                heard(told)
        with self._lock:
            left = list(self._listeners.values())
            self._listeners.clear()
        for heard in left:
            heard(_GONE)
