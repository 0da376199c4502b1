"""Work beside the page: each job in a process of its own, forked from one that is warm.

A fresh process would import and build for a second before it plans for a tenth. So one process, the
*forge*, imports and builds once; every job is forked from it, starts warm, and can be killed at any
moment without harm to the next. The page's threads only wait for messages.
"""

from __future__ import annotations

import atexit
import itertools
import multiprocessing
import signal
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from multiprocessing.reduction import ForkingPickler
from types import MappingProxyType
from typing import Any

from narrows.errors import NarrowsError, ShapeError

Work = Callable[..., Any]
"""What a job runs: a function at the top of a module, called as work(report, *arguments)."""

_WARM_PAUSE = 3.0  # s without a request after which the forge warms up further


@dataclass(frozen=True)
class Told:
    """What a job says.

    Attributes:
        kind: `progress`, `result`, `refused` (the input was wrong: a message for people) or
            `broken` (the process ended without an answer).
        value: The share done, the result, or the message.
    """

    kind: str
    value: Any


class Report:
    """A job's line to who asked for it."""

    def __init__(self, connection: Connection | None = None) -> None:
        """Keep the line; None: nobody listens."""
        self._connection = connection
        self._heard: Any = None

    def __call__(self, share: Any) -> None:
        """Say how far it is: a share from 0 to 1, or anything that can be sent."""
        if self._connection is not None:
            self._connection.send(Told("progress", share))

    def latest(self) -> Any:
        """Return what the job was told last by `Job.tell`; None: nothing yet."""
        while self._connection is not None and self._connection.poll():
            self._heard = self._connection.recv()
        return self._heard


_GONE = Told("broken", "the process that plans has ended: start the page again")


def _read_only(mapping: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    """Return a read-only mapping, as it was before it was sent."""
    return MappingProxyType(mapping)


def _sendable(mapping: MappingProxyType[Any, Any]) -> tuple[Callable[..., Any], tuple[Any]]:
    """Return how a read-only mapping goes from process to process."""
    return _read_only, (dict(mapping),)


ForkingPickler.register(MappingProxyType, _sendable)


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
        """Start the forge.

        Args:
            warm: Called one after the other in the forge, with a report that goes nowhere: the
                first before any job, the others while nothing is asked for.
        """
        self._numbers = itertools.count(1)
        self._listeners: dict[int, Callable[[Told], None]] = {}
        self._lock = threading.Lock()
        context = multiprocessing.get_context("spawn")  # this process has threads: no fork
        self._connection, theirs = context.Pipe()
        self._forge = context.Process(target=_forge, args=(theirs, tuple(warm)))
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
            self._listeners.clear()
            self._send("stop", 0, None, ())
        self._forge.join(timeout=5.0)
        if self._forge.is_alive():
            self._forge.kill()

    def _send(self, *order: Any) -> bool:
        """Send an order to the forge and return whether it is still there."""
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


def _forge(server: Connection, warm: tuple[Work, ...]) -> None:
    """Wait for requests, fork a process for each, pass on what the processes tell."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the page's own process ends this one
    started: dict[int, tuple[BaseProcess, Connection]] = {}
    readers: dict[Connection, int] = {}
    left = list(warm)
    if left:
        left.pop(0)(Report())
    multiprocessing.set_start_method(_method(), force=True)
    while True:
        ready = wait([server, *readers], timeout=_WARM_PAUSE if left else None)
        if not ready and left:
            left.pop(0)(Report())
        for connection in ready:
            if connection is not server:
                _pass_on(server, connection, readers, started)
                continue
            order, number, work, arguments = _next_order(server)
            if order == "stop":
                for process, _ in started.values():
                    process.kill()
                return
            if order == "start":
                mine, theirs = multiprocessing.Pipe()
                process = multiprocessing.Process(target=_work, args=(theirs, work, arguments))
                process.daemon = True
                process.start()
                theirs.close()
                started[number], readers[mine] = (process, mine), number
            elif order == "cancel":
                if number in started:
                    started[number][0].kill()
            elif order == "tell":
                if number in started:
                    _tell(started[number][1], work)
            else:
                raise ShapeError(f"no such order: {order}")


def _next_order(server: Connection) -> tuple[str, int, Any, tuple[Any, ...]]:
    """Return what the page asks for next; it asks to stop when it is gone."""
    try:
        order: tuple[str, int, Any, tuple[Any, ...]] = server.recv()
    except EOFError:
        return "stop", 0, None, ()
    return order


def _pass_on(
    server: Connection,
    reader: Any,
    readers: dict[Connection, int],
    started: dict[int, tuple[BaseProcess, Connection]],
) -> None:
    """Send on what a job's process tells; at its end, whether it ended without an answer."""
    number = readers[reader]
    try:
        server.send((number, reader.recv()))
    except (EOFError, OSError):  # OSError: killed in the middle of a message
        del readers[reader]
        reader.close()
        process, _ = started.pop(number)
        process.join()
        text = f"the work ended without an answer (exit code {process.exitcode})"
        server.send((number, Told("broken", f"{text}; the terminal may say more")))


def _tell(job: Connection, value: Any) -> None:
    try:
        job.send(value)
    except OSError:
        return  # it has just ended


def _work(writer: Connection, work: Work, arguments: tuple[Any, ...]) -> None:
    """Run a job in its own process and send what comes of it."""
    try:
        told = Told("result", work(Report(writer), *arguments))
    except NarrowsError as error:
        told = Told("refused", str(error))
    writer.send(told)
    writer.close()


def _method() -> str:
    """Return how jobs are started: forked warm where the system can, else afresh and slower."""
    methods = multiprocessing.get_all_start_methods()
    return "fork" if "fork" in methods else "spawn"
