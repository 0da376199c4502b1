"""The studies there are, found by looking, and running one by its name."""

from __future__ import annotations

import ast
import contextlib
import difflib
import importlib
import inspect
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import InputError, StudyError
from ..files import write_whole

LARGEST_SEED = 2**63 - 1
"""What a table of results holds as a whole number."""

_GIVEN = ("out", "jobs", "resume", "seed")


@dataclass(frozen=True)
class Report:
    """What a study has to say.

    Attributes:
        name: The study's name.
        out: Folder with its tables, pictures and `report.md`.
        text: The report, Markdown.
    """

    name: str
    out: Path
    text: str

    @property
    def file(self) -> Path:
        """Where the report is written."""
        return self.out / "report.md"


def summaries() -> dict[str, str]:
    """Return what each study does, in one line, by name; read without importing them."""
    found = {}
    for folder in sys.modules[__package__].__path__:
        for file in Path(folder).glob("*.py"):
            summary = _summary(file)
            if summary is not None:
                found[file.stem.replace("_", "-")] = summary
    return dict(sorted(found.items()))


def names() -> tuple[str, ...]:
    """Return the names of the studies, sorted."""
    return tuple(summaries())


def run(
    name: str,
    out: Path,
    *,
    jobs: int = 1,
    resume: bool = False,
    seed: int = 0,
    **options: Any,
) -> Report:
    """Run a study and write its report to `out/report.md`.

    Args:
        name: One of `names()`.
        out: Folder for all it writes; made if need be.
        jobs: Worker processes, >= 1.
        resume: Keep the cases that are done in `out` from an earlier run.
        seed: Seed of everything random, 0 to `LARGEST_SEED`.
        options: The study's own options.

    Raises:
        StudyError: If there is no such study or option, or the folder cannot be used.
        InputError: If the report cannot be written there.
    """
    known = names()
    if name not in known:
        near = difflib.get_close_matches(name, known, n=1)
        allowed = f"{near[0]}?" if near else ", ".join(known)
        raise StudyError("there is no such study", value=name, allowed=allowed)
    if jobs < 1:
        raise StudyError("no process to run on", field="jobs", value=jobs, allowed=">= 1")
    if not 0 <= seed <= LARGEST_SEED:
        allowed = f"0 to {LARGEST_SEED}"
        raise StudyError("the seed is out of range", field="seed", value=seed, allowed=allowed)
    study = importlib.import_module(f"{__package__}.{name.replace('-', '_')}")
    _check_options(name, inspect.signature(study.run).parameters, options)
    with _folder(out):
        report = Report(name, out, study.run(out, jobs=jobs, resume=resume, seed=seed, **options))
    write_whole(report.file, report.text)
    return report


@contextlib.contextmanager
def _folder(out: Path) -> Iterator[None]:
    """Make a folder for what is done meanwhile; leave none behind if that refuses to begin."""
    made = not out.exists()
    try:
        out.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise StudyError("the folder cannot be used: this is a file", file=str(out)) from error
    except OSError as error:
        why = error.strerror or str(error)
        raise StudyError(f"the folder cannot be made: {why}", file=str(out)) from error
    try:
        yield
    except InputError:
        if made:
            with contextlib.suppress(OSError):  # there is something in it
                out.rmdir()
        raise


def _check_options(
    name: str, parameters: Mapping[str, inspect.Parameter], options: Mapping[str, Any]
) -> None:
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters.values()):
        return
    own = [option for option in parameters if option not in _GIVEN]
    for option in options:
        if option not in own:
            allowed = ", ".join(own) or "none"
            raise StudyError(f"study {name} has no such option", value=option, allowed=allowed)


def _summary(file: Path) -> str | None:
    """Return the text a module assigns to SUMMARY, or None if it assigns none."""
    source = file.read_text(encoding="utf-8")
    if "SUMMARY" not in source:
        return None
    for statement in ast.parse(source).body:
        match statement:
            case (
                ast.Assign(targets=[ast.Name(id="SUMMARY")], value=ast.Constant(value=str(text)))
                | ast.AnnAssign(target=ast.Name(id="SUMMARY"), value=ast.Constant(value=str(text)))
            ):
                return text
    return None
