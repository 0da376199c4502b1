"""Where the page may write: plainly named files in the folder it was started in, nowhere else."""

from __future__ import annotations

import re
from pathlib import Path

from narrows.errors import InputError
from narrows.files import check_can_be_written

_PLAIN = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_. -]{0,79}")
_ALLOWED = "letters, digits, spaces, '.', '-' and '_', at most 80, no folder"


def page_file(folder: Path, name: str, suffix: str, *, replace: bool = False) -> Path:
    """Return the file of a typed name in a folder.

    Args:
        folder: The only folder that is written to.
        name: What somebody typed, without or with the suffix.
        suffix: Such as `.yaml`.
        replace: Whether a file that is there already may be replaced.

    Raises:
        InputError: If the name is no plain name, the file is there already, or cannot be written.
    """
    plain = name.strip().removesuffix(suffix)
    if not _PLAIN.fullmatch(plain) or plain.endswith((".", " ")):
        raise InputError("this is no name for a file", value=name[:80], allowed=_ALLOWED)
    file = folder / f"{plain}{suffix}"
    if file.parent.resolve() != folder.resolve():
        raise InputError("this is no name for a file", value=name[:80], allowed=_ALLOWED)
    if file.is_symlink():
        raise InputError("this is a link to another place", file=file.name)
    if file.exists() and not replace:
        raise InputError(
            "there is such a file already",
            file=file.name,
            allowed="another name, or tick 'replace'",
        )
    check_can_be_written(file)
    return file
