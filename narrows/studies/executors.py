"""Where the cases of a study run: in this process, or in worker processes of this machine."""

from __future__ import annotations

import math
import pickle
from collections import deque
from collections.abc import Generator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import wait
from typing import Protocol

from ..errors import StudyError
from .case import Case, Outcome, Task
from .worker import Worker, prepare_workers

Outcomes = Generator[tuple[int, Outcome], None, None]


class Executor(Protocol):
    """Anything that runs the cases of a sweep; a cluster is one more."""

    def outcomes(self, task: Task, cases: Sequence[Case]) -> Outcomes:
        """Yield the index and outcome of every case once, as they end, in any order.

        Closing the generator early stops whatever still runs. A case that cannot be finished
        (worker lost, out of time) is an outcome with a reason, not an exception.
        """
        ...


@dataclass(frozen=True)
class InProcess:
    """Runs one case after the other in the calling process, where a debugger sees them."""

    def outcomes(self, task: Task, cases: Sequence[Case]) -> Outcomes:
        """Yield the outcomes in the order of the cases."""
        for index, case in enumerate(cases):
            yield index, task(case)


@dataclass(frozen=True)
class LocalProcesses:
    """Runs cases in worker processes of this machine.

    Attributes:
        jobs: Number of processes, >= 1.
        timeout_s: Wall time after which a case is stopped [s], or None for no end.
    """

    jobs: int
    timeout_s: float | None = None

    def outcomes(self, task: Task, cases: Sequence[Case]) -> Outcomes:
        """Yield outcomes as they end; a worker that dies costs its case and is replaced.

        Raises:
            StudyError: If the function cannot be sent to another process or loaded there.
        """
        payload = _pickled(task)
        waiting = deque(range(len(cases)))
        workers: list[Worker] = []
        prepare_workers(task.function)
        try:
            while waiting or any(worker.is_busy for worker in workers):
                busy = sum(worker.is_busy for worker in workers)
                while len(workers) < min(self.jobs, len(waiting) + busy):
                    workers.append(Worker(payload))
                for worker in self._eventful(workers):
                    ended = worker.receive() if worker.has_news else worker.stop(self._too_late)
                    if waiting and worker.is_idle:
                        assign(worker, waiting, cases)
                    if worker.is_stopped:
                        workers.remove(worker)
                    if ended is not None:
                        yield ended
        finally:
            for worker in workers:
                worker.stop("the sweep was stopped")

    @property
    def _too_late(self) -> str:
        return f"timed out after {self.timeout_s:g} s"

    def _eventful(self, workers: Sequence[Worker]) -> list[Worker]:
        """Wait until a worker reports, dies or is out of time; return those that did."""
        limit = math.inf if self.timeout_s is None else self.timeout_s
        left = [limit - worker.elapsed_s for worker in workers if worker.is_busy]
        patience = max(0.0, min(left, default=math.inf))
        wait([w.connection for w in workers], None if math.isinf(patience) else patience)
        return [w for w in workers if w.has_news or (w.is_busy and w.elapsed_s >= limit)]


def assign(worker: Worker, waiting: deque[int], cases: Sequence[Case]) -> None:
    """Give a worker the next case; one that died idle takes none with it."""
    index = waiting.popleft()
    if not worker.send(index, cases[index]):
        waiting.appendleft(index)


def _pickled(task: Task) -> bytes:
    """Return a task as it is sent to the workers."""
    try:
        return pickle.dumps(task)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise StudyError(
            f"the study's function cannot be sent to another process: {error}",
            allowed="a function at the top level of a module, or jobs=1",
        ) from error
