"""Callbacks of one tab, one after the other: viser calls each in a thread of its own."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any


class Guard:
    """A lock that functions are wrapped in; whoever holds it may call others of them."""

    def __init__(self) -> None:
        """Make it open."""
        self.lock = threading.RLock()

    def __call__(self, function: Callable[[Any], None]) -> Callable[[Any], None]:
        """Return a function of an event that waits until no other is at work."""

        def guarded(event: Any) -> None:
            with self.lock:
                function(event)

        return guarded
