"""What a command says and where: its outcome, mistakes, progress, and the exit code."""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import click

from .commands.outcome import OK, WRONG_INPUT, Outcome
from .errors import InputError, NarrowsError

_INTERRUPTED, _BROKEN_PIPE = 130, 141  # as the shell reports SIGINT and SIGPIPE


def run(command: click.Command, arguments: Sequence[str]) -> int:
    """Run a command, print what came of it, and return its exit code; no exception leaves.

    Args:
        command: What to run; returns an `Outcome`, or nothing where it printed its help.
        arguments: What follows `narrows` on the command line.
    """
    as_json = "--json" in arguments
    try:
        code, text = _outcome(command, arguments, as_json)
        if text:
            click.echo(text)
        if sys.stdout is not None:  # None where the shell closed it: `>&-`
            sys.stdout.flush()
    except KeyboardInterrupt:
        _tell("interrupted")
        return _INTERRUPTED
    except BrokenPipeError:
        _leave_nothing_to_flush()
        return _BROKEN_PIPE
    except OSError as error:
        _leave_nothing_to_flush()
        _tell(f"standard output cannot be written: {error.strerror or error}")
        return WRONG_INPUT
    return code


def show_what_can_be_shown() -> None:
    """Let standard output escape the characters that a terminal has not, rather than fail."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


@contextlib.contextmanager
def progress(what: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on standard error after two seconds, where a person looks."""
    bars: list[Any] = []

    def report(share: float) -> None:
        if not bars:
            from tqdm import tqdm

            bars.append(
                tqdm(
                    total=1.0,
                    desc=what,
                    file=sys.stderr,
                    delay=2.0,
                    leave=False,
                    disable=sys.stderr is None or not sys.stderr.isatty(),
                    bar_format="{desc} {percentage:3.0f} % |{bar}| {remaining} left",
                )
            )
        bars[0].update(share - bars[0].n)

    try:
        yield report
    finally:
        for bar in bars:
            bar.close()


def _outcome(command: click.Command, arguments: Sequence[str], as_json: bool) -> tuple[int, str]:
    """Return a command's exit code and what it has for standard output; tell the rest."""
    try:
        outcome = command.main(list(arguments), prog_name="narrows", standalone_mode=False)
    except click.exceptions.Abort as error:
        raise KeyboardInterrupt from error
    except click.ClickException as error:
        context = getattr(error, "ctx", None)
        verb = context.command_path if context is not None else "narrows"
        message = error.format_message()
        _tell(f"{message}\nTry '{verb} --help'.")
        return WRONG_INPUT, _mistake(message) if as_json else ""
    except BrokenPipeError:
        raise
    except (NarrowsError, OSError) as error:
        _tell(str(error))
        return WRONG_INPUT, _mistake(error) if as_json else ""
    if not isinstance(outcome, Outcome):
        return int(outcome or OK), ""
    for note in outcome.notes:
        _tell(note)
    return outcome.code, outcome.as_json() if as_json else outcome.text


def _mistake(error: Exception | str) -> str:
    """Return what is wrong with the input as one JSON object."""
    fields: dict[str, Any] = {"status": "error", "reason": str(error)}
    if isinstance(error, InputError):
        fields |= {"file": error.file, "line": error.line, "field": error.field}
    return json.dumps(fields)


def _tell(text: str) -> None:
    """Say something on standard error; where nobody can hear it, the exit code must do."""
    with contextlib.suppress(OSError):
        click.echo(f"narrows: {text}", err=True)


def _leave_nothing_to_flush() -> None:
    """Turn standard output away, so that the interpreter does not fail on it when it ends."""
    if sys.stdout is not None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
