"""What a job beside the page says, and hears, while it is under way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

Work = Callable[..., Any]
"""What a job runs: a function at the top of a module, called as work(report, *arguments)."""


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
        """Say how far it is.

        Args:
            share: From 0 to 1; or words for what begins now; or `pose`, `time` and `state` of a
                chair that is on its way in real time.
        """
        if self._connection is not None:
            self._connection.send(Told("progress", share))

    def latest(self) -> Any:
        """Return what the job was told last by `Job.tell`; None: nothing yet."""
        while self._connection is not None and self._connection.poll():
            self._heard = self._connection.recv()
        return self._heard
