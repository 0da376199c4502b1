"""One writer at a time for a study's table."""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Iterator
from pathlib import Path

from ..errors import StudyError


@contextlib.contextmanager
def sole_writer(file: Path) -> Iterator[None]:
    """Hold `NAME.lock` beside a file; the system lets go of it if the process is killed.

    Raises:
        StudyError: If another process, or another sweep of this one, holds it.
    """
    lock = Path(f"{file}.lock")
    descriptor = _locked(lock, file)
    try:
        yield
    finally:
        # Removed while still held: whoever waits on the old file sees below that it is gone.
        lock.unlink(missing_ok=True)
        os.close(descriptor)


def _locked(lock: Path, file: Path) -> int:
    """Return the open descriptor of the lock file that is at this path now, locked."""
    while True:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            os.close(descriptor)
            raise StudyError(
                "the table is being written by another run; wait for it, or give another --out",
                file=str(file),
            ) from error
        if lock.exists() and os.path.samestat(os.fstat(descriptor), os.stat(lock)):
            return descriptor
        os.close(descriptor)
