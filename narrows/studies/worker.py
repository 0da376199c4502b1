"""A worker process and the parent's end of it.

Every worker has a pipe of its own, so the parent always knows which case it holds: a worker that
dies costs that case and no other, and nothing is shared that it could leave locked.
"""

from __future__ import annotations

import contextlib
import functools
import multiprocessing
import os
import pickle
import signal
import threading
import time
from collections.abc import Callable, Iterator
from multiprocessing import forkserver
from multiprocessing.connection import Connection
from typing import Any

from ..errors import StudyError
from .case import Case, Outcome, Task, timestamp
from .provenance import machine

_READY = "ready"
_THREAD_COUNTS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_PATIENCE_S = 2.0  # for a process that was told to leave, before it is killed


def prepare_workers(function: Callable[..., Any]) -> None:
    """Start the process that workers are forked from, with the function's module loaded in it.

    Numerical libraries get one thread a worker unless the environment says otherwise: the cases
    are what runs in parallel. Does nothing if that process runs already.
    """
    while isinstance(function, functools.partial):
        function = function.func
    module = getattr(function, "__module__", "__main__")
    loaded = [__name__] if module == "__main__" else [__name__, module]
    multiprocessing.get_context("forkserver").set_forkserver_preload(loaded)
    with _one_thread_each():
        forkserver.ensure_running()


class Worker:
    """One worker process, as the parent sees it.

    Attributes:
        connection: The parent's end of the worker's pipe; readable when there is news.
        is_stopped: Whether the process is gone.
    """

    def __init__(self, payload: bytes) -> None:
        """Start a process that will run a pickled `Task`."""
        context = multiprocessing.get_context("forkserver")
        self.connection, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, payload), daemon=True)
        self._process.start()
        theirs.close()
        self.is_stopped = False
        self._is_ready = False
        self._index: int | None = None
        self._sent, self._started = 0.0, ""

    @property
    def pid(self) -> int:
        """Number of its process."""
        return self._process.pid or 0

    @property
    def is_busy(self) -> bool:
        """Whether it holds a case."""
        return self._index is not None

    @property
    def is_idle(self) -> bool:
        """Whether it waits for a case."""
        return self._is_ready and not self.is_busy and not self.is_stopped

    @property
    def has_news(self) -> bool:
        """Whether `receive` would return at once."""
        return self.connection.poll()

    @property
    def elapsed_s(self) -> float:
        """Time since it was sent its case [s]."""
        return time.monotonic() - self._sent

    def send(self, index: int, case: Case) -> bool:
        """Give it a case; return whether it took it, which one that died does not."""
        try:
            self.connection.send(case)
        except OSError:
            self.stop("")
            return False
        self._index, self._sent, self._started = index, time.monotonic(), timestamp()
        return True

    def receive(self) -> tuple[int, Outcome] | None:
        """Take its news; return the index and outcome of its case if that ended.

        Raises:
            StudyError: If it cannot load the task, or died before it could.
        """
        try:
            message = self.connection.recv()
        except (EOFError, OSError):
            return self._lost()
        if isinstance(message, Outcome) and self._index is not None:
            ended, self._index = (self._index, message), None
            return ended
        if message != _READY:
            raise StudyError(
                f"a worker process cannot load the study's function: {message}",
                allowed="a function at the top level of an importable module, or jobs=1",
            )
        self._is_ready = True
        return None

    def stop(self, reason: str) -> tuple[int, Outcome] | None:
        """End the process; return its case, if it holds one, as failed for this reason."""
        ended = self._failure(reason)
        if ended is not None or not self._is_ready:
            self._process.kill()
        self.connection.close()  # an idle worker takes this as its leave
        self._process.join(_PATIENCE_S)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self.is_stopped = True
        return ended

    def _lost(self) -> tuple[int, Outcome] | None:
        """Account for a process that closed its pipe."""
        self._process.join(_PATIENCE_S)
        code = self._process.exitcode
        if not self._is_ready:
            self.stop("")
            raise StudyError(
                f"a worker process ended before it could start (exit code {code})",
                allowed="a script that starts workers only under `if __name__ == '__main__':`",
            )
        if code is not None and code < 0:
            return self.stop(f"worker killed ({signal.Signals(-code).name})")
        return self.stop(f"worker ended by itself (exit code {code})")

    def _failure(self, reason: str) -> tuple[int, Outcome] | None:
        if self._index is None:
            return None
        index, self._index = self._index, None
        return index, Outcome(
            values=None,
            reason=reason,
            started=self._started,
            wall_s=self.elapsed_s,
            cpu_s=None,
            machine=machine(),
        )


def _serve(connection: Connection, payload: bytes) -> None:
    """Run the cases that come through a pipe until it is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    for name in _THREAD_COUNTS:
        os.environ.setdefault(name, "1")
    try:
        task: Task = pickle.loads(payload)
    except Exception as error:  # whatever the import of a study's module may raise
        connection.send(f"{type(error).__name__}: {error}")
        return
    connection.send(_READY)
    while True:
        try:
            case = connection.recv()
        except EOFError:
            return
        connection.send(task(case))


def _leave_with_parent() -> None:
    """End this process as soon as the one that started it is gone, killed or not."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextlib.contextmanager
def _one_thread_each() -> Iterator[None]:
    """Set the thread counts that the environment leaves open, for processes started meanwhile."""
    added = [name for name in _THREAD_COUNTS if name not in os.environ]
    os.environ.update(dict.fromkeys(added, "1"))
    try:
        yield
    finally:
        for name in added:
            del os.environ[name]
