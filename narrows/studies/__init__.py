"""Studies: experiments that regenerate in one command, each one file on top of `sweep`.

A study is a module of this package that says in one line what it does and can be run::

    SUMMARY = "one line for the help text"

    def run(out: Path, *, jobs: int, resume: bool, seed: int, **options) -> str:
        ...  # writes its tables and pictures into `out`, returns its report as Markdown

Its name is the module's with hyphens: `door_bezier.py` is the study `door-bezier`. Nothing is
listed by hand, and no study is imported before it is run.
"""

from .registry import LARGEST_SEED, Report, names, run, summaries

__all__ = ["LARGEST_SEED", "Report", "names", "run", "summaries"]
