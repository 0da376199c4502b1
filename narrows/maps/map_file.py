"""The bytes of a map's file."""

from __future__ import annotations

from pathlib import Path

from ..errors import SceneError


def read_map_file(file: Path, largest: int) -> bytes:
    """Return what a file holds.

    Args:
        file: The file.
        largest: Most bytes it may have.

    Raises:
        SceneError: If it cannot be read, is no file, or is larger.
    """
    place = str(file)
    try:
        size = file.stat().st_size
        content = file.read_bytes() if file.is_file() and size <= largest else None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise SceneError(f"the map cannot be read: {reason}", file=place) from error
    if content is None:
        allowed = f"a file of at most {largest} bytes"
        raise SceneError("this is no map", file=place, value=f"{size} bytes", allowed=allowed)
    return content
