"""The process that jobs are forked from: it has imported and built once what they need.

A fresh process would import and build for a second before it plans for a tenth. A job forked from
this one starts warm, and can be killed at any moment without harm to the next.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from multiprocessing.reduction import ForkingPickler
from types import MappingProxyType
from typing import Any

from narrows.errors import NarrowsError, ShapeError

from .page_report import Report, Told, Work

_WARM_PAUSE = 3.0  # s without a request after which the forge warms up further


def _read_only(mapping: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    """Return a read-only mapping, as it was before it was sent."""
    return MappingProxyType(mapping)


def _sendable(mapping: MappingProxyType[Any, Any]) -> tuple[Callable[..., Any], tuple[Any]]:
    """Return how a read-only mapping goes from process to process."""
    return _read_only, (dict(mapping),)


ForkingPickler.register(MappingProxyType, _sendable)


def forge(server: Connection, warm: tuple[Work, ...]) -> None:
    """Wait for requests, fork a process for each, pass on what the processes tell.

    Args:
        server: Where orders `(what, number, work, arguments)` come from and answers go.
        warm: Called one after the other, with a report that goes nowhere: the first before any
            job, the others while nothing is asked for.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the page's own process ends this one
    if hasattr(os, "setpgrp"):
        os.setpgrp()
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


def end_group(process: BaseProcess) -> None:
    """End a forge and all its jobs at once, whatever they are at."""
    if process.pid is None:
        return
    try:
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass  # it has ended, or has not come so far as to lead a group
    process.kill()


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
