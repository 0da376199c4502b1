"""Files that are either the old one or the whole new one, never half of it."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from .errors import InputError


def write_whole(file: Path | str, content: str | bytes) -> None:
    """Write a file in one step: to a temporary file beside it, then renamed over it.

    Folders on the way are made. A reader, or a run that is killed, sees the old file or the new.

    Args:
        file: Where to.
        content: Text, written as UTF-8, or bytes.

    Raises:
        InputError: If the file cannot be written there.
    """
    file = Path(file)
    content = content.encode("utf-8") if isinstance(content, str) else content
    temporary = None
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        descriptor, temporary = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name[:80]}.")
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content)
        os.chmod(temporary, 0o666 & ~_file_mode_mask())
        os.replace(temporary, file)
    except (OSError, ValueError) as error:
        _remove(temporary)
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(f"the file cannot be written: {why}", file=str(file)) from error
    except BaseException:
        _remove(temporary)
        raise


def check_can_be_written(file: Path | str) -> None:
    """Say early, before any work is done for it, that a file cannot be written.

    Raises:
        InputError: If the place is a folder, or lies in something that is none.
    """
    file = Path(file)
    try:
        problem = "the file cannot be written: this is a folder" if file.is_dir() else ""
        nearest = next((parent for parent in file.parents if parent.exists()), None)
        if nearest is not None and not nearest.is_dir():
            problem = f"the file cannot be written: {nearest} is no folder"
        elif nearest is not None and not os.access(nearest, os.W_OK):
            problem = f"the file cannot be written: no permission to write in {nearest}"
    except (OSError, ValueError) as error:
        problem = f"the file cannot be written: {error}"
    if problem:
        raise InputError(problem, file=str(file))


def _remove(temporary: str | None) -> None:
    if temporary is not None and os.path.exists(temporary):
        os.unlink(temporary)


def _file_mode_mask() -> int:
    """Return the process's mask of file permissions, which can only be read by setting it."""
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
