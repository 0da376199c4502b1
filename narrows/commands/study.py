"""`narrows study`: an experiment, regenerated in one command."""

from __future__ import annotations

from pathlib import Path

from ..errors import StudyError
from ..studies import LARGEST_SEED, run, summaries
from .outcome import OK, Outcome, lines


def run_study(
    name: str | None,
    *,
    out: str | None,
    jobs: int,
    resume: bool,
    seed: int,
    scenes: str | None = None,
    data: str | None = None,
) -> Outcome:
    """Run a study into a folder; without a name, say which studies there are."""
    if name is None:
        rows = [(study, summary) for study, summary in summaries().items()]
        return Outcome(OK, {}, lines("studies:", *rows))
    if jobs < 1:
        raise StudyError("no process to run on", field="--jobs", value=jobs, allowed=">= 1")
    if not 0 <= seed <= LARGEST_SEED:
        allowed = f"0 to {LARGEST_SEED}"
        raise StudyError("the seed is out of range", field="--seed", value=seed, allowed=allowed)
    folder = Path(out) if out is not None else Path("out") / name
    given = {"scenes": scenes, "data": data}
    options = {option: value for option, value in given.items() if value is not None}
    report = run(name, folder, jobs=jobs, resume=resume, seed=seed, **options)
    return Outcome(OK, {}, lines(report.text.rstrip(), f"\nwritten to {report.file}"))
