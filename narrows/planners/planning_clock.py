"""The clock of planning: processor time, without that of loading libraries.

What a plan costs must not depend on whether it is the first of its process, so `solve_time_s` and
time budgets leave out imports and the reading of compiled code.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext


class PlanningClock:
    """Processor time of this process, less what was spent in `loading`."""

    def __init__(self) -> None:
        """Start with nothing left out."""
        self._left_out = 0.0
        self._depth = 0

    def now(self) -> float:
        """Return the processor time spent so far [s]; only differences mean anything."""
        return time.process_time() - self._left_out

    def loading_of(self, compiled: object) -> AbstractContextManager[None]:
        """Leave out the first call of a compiled function, which reads or makes its code.

        For functions of which one call is little work: that is left out too.
        """
        return nullcontext() if getattr(compiled, "signatures", None) else self.loading()

    @contextmanager
    def loading(self) -> Iterator[None]:
        """Leave out what happens within: an import. Within another one it counts once."""
        begun = time.process_time()
        self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1
            if self._depth == 0:
                self._left_out += time.process_time() - begun


clock = PlanningClock()
"""The one of this process."""
