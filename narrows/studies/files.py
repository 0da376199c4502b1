"""Files that are either the old one or the whole new one, never half of it."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def write_whole(file: Path, text: str) -> None:
    """Write a text file in one step: to a temporary file beside it, then renamed over it.

    Folders on the way are made. A reader, or a run that is killed, sees the old file or the new.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    descriptor, temporary = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8", newline="") as stream:
            stream.write(text)
        os.chmod(temporary, 0o666 & ~_file_mode_mask())
        os.replace(temporary, file)
    except BaseException:
        os.unlink(temporary)
        raise


def _file_mode_mask() -> int:
    """Return the process's mask of file permissions, which can only be read by setting it."""
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
