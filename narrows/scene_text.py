"""YAML with its lines: what a file says, and where it says it.

Read by events, not by YAML's own object construction, so that nothing in a file can run code,
recurse without end or blow up through aliases. Scalars follow the core schema of YAML 1.2:
`yes` and `1:30` are text, `1e-3` is a number.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from .errors import SceneError
from .scene_source import Located, Source, Step, printable

_DEEPEST = 24  # levels of nesting; the format needs six
_LARGEST = 4 * 2**20  # bytes; about 20 s of reading
_MOST_ALIASED = 100_000  # values that aliases may repeat in all

_HINTS = {
    "'\\t'": "lines indented by spaces, not by tabs",
    "mapping values are not allowed": "`key: value`, a space after the colon, keys that belong "
    "together indented alike",
}
"""What would be accepted, by what the parser says of the commonest slips."""

_INTEGER = re.compile(r"[-+]?[0-9]{1,15}")
_NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_CONSTANTS: dict[str, Any] = {
    **dict.fromkeys(["", "~", "null", "Null", "NULL"]),
    **dict.fromkeys(["true", "True", "TRUE"], True),
    **dict.fromkeys(["false", "False", "FALSE"], False),
    **dict.fromkeys([".inf", ".Inf", ".INF", "+.inf", "+.Inf", "+.INF"], float("inf")),
    **dict.fromkeys(["-.inf", "-.Inf", "-.INF"], float("-inf")),
    **dict.fromkeys([".nan", ".NaN", ".NAN"], float("nan")),
}


def read_source(text: str, file: str | None) -> Source:
    """Return what a YAML or JSON text says, with its lines.

    Raises:
        SceneError: If the text is empty, too large, not YAML, nested too deeply, or repeats a
            key; if it uses tags, more than one document, or aliases without measure.
    """
    return Source(file, _Reader(text, file).read())


def decode(content: bytes, file: str | None) -> str:
    """Return the text of a file's bytes.

    Raises:
        SceneError: If they are not UTF-8 text, or too many.
    """
    source = Source(file)
    if len(content) > _LARGEST:
        raise source.error(
            (),
            f"the file is larger than {_LARGEST // 2**20} MB",
            allowed="a `map:` for large worlds",
        )
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise source.error(
            (), f"not a text file (byte {error.start})", allowed="YAML or JSON in UTF-8"
        ) from None


class _Reader:
    """Builds located values from the events of one YAML document."""

    def __init__(self, text: str, file: str | None) -> None:
        self._file = file
        self._events = self._checked_events(text)
        self._anchors: dict[str, Located] = {}
        self._aliased = 0

    def read(self) -> Located:
        """Return the one document of the text."""
        from ruamel.yaml.events import DocumentStartEvent, StreamEndEvent

        next(self._events)  # start of the stream
        if isinstance(next(self._events), StreamEndEvent):
            raise self._error(1, "the file is empty", "a scene: vehicle, world, start, goal")
        root = self._node(next(self._events), 0)
        next(self._events)  # end of the document
        following = next(self._events)
        if isinstance(following, DocumentStartEvent):
            raise self._error(_line(following), "a second document begins here", "one document")
        return root

    def _checked_events(self, text: str) -> Iterator[Any]:
        from ruamel.yaml import YAML
        from ruamel.yaml.error import MarkedYAMLError, YAMLError

        if len(text) > _LARGEST:
            raise self._error(None, f"the text is longer than {_LARGEST} characters", None)
        try:
            yield from YAML(typ="safe", pure=True).parse(text)
        except MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            what = " ".join(str(error.problem or error.context).split())
            hint = next((hint for said, hint in _HINTS.items() if said in what), "YAML or JSON")
            raise self._error(
                None if mark is None else mark.line + 1, f"not YAML: {what}", hint
            ) from None
        except YAMLError as error:
            what = " ".join(str(error).split())[:120]
            raise self._error(None, f"not YAML: {what}", "YAML or JSON text") from None
        except (ValueError, OverflowError) as error:  # escapes beyond Unicode, absurd directives
            raise self._error(None, f"not YAML: {error}", "YAML or JSON") from None

    def _node(self, event: Any, depth: int) -> Located:
        from ruamel.yaml.events import (
            AliasEvent,
            MappingStartEvent,
            ScalarEvent,
            SequenceStartEvent,
        )

        line = _line(event)
        if depth > _DEEPEST:
            raise self._error(line, f"nested deeper than {_DEEPEST} levels", "fewer levels")
        if isinstance(event, AliasEvent):
            return self._repeated(event)
        if getattr(event, "tag", None) is not None:
            raise self._error(
                line,
                f"the tag {printable(str(event.tag))} is not understood",
                "values without tags",
            )
        if isinstance(event, ScalarEvent):
            node = Located(_scalar(event.value) if event.style is None else event.value, line)
        elif isinstance(event, SequenceStartEvent):
            node = self._sequence(line, depth)
        elif isinstance(event, MappingStartEvent):
            node = self._mapping(line, depth)
        else:
            raise self._error(line, "not understood", "mappings, lists, text and numbers")
        if event.anchor is not None:
            self._anchors[event.anchor] = node
        return node

    def _sequence(self, line: int, depth: int) -> Located:
        from ruamel.yaml.events import SequenceEndEvent

        entries: list[Located] = []
        while not isinstance(event := next(self._events), SequenceEndEvent):
            entries.append(self._node(event, depth + 1))
        return Located(
            [entry.value for entry in entries],
            line,
            dict(enumerate(entries)),
            1 + sum(entry.count for entry in entries),
        )

    def _mapping(self, line: int, depth: int) -> Located:
        from ruamel.yaml.events import MappingEndEvent, ScalarEvent

        entries: dict[Step, Located] = {}
        while not isinstance(event := next(self._events), MappingEndEvent):
            here = _line(event)
            if not isinstance(event, ScalarEvent) or event.tag is not None:
                raise self._error(here, "a key must be plain text", "key: value")
            key = str(event.value)
            if key in entries:
                first = entries[key].line
                raise self._error(
                    here, f"the key '{printable(key)}' is given twice", None, first=first
                )
            if key == "<<":
                raise self._error(here, "merge keys (<<) are not understood", "the keys in full")
            found = self._node(next(self._events), depth + 1)
            entries[key] = Located(found.value, here, found.items, found.count)
        return Located(
            {key: entry.value for key, entry in entries.items()},
            line,
            entries,
            1 + sum(entry.count for entry in entries.values()),
        )

    def _repeated(self, event: Any) -> Located:
        target = self._anchors.get(event.anchor)
        if target is None:
            raise self._error(
                _line(event),
                f"the alias *{printable(event.anchor)} has no finished anchor before it",
                None,
            )
        self._aliased += target.count
        if self._aliased > _MOST_ALIASED:
            raise self._error(
                _line(event), f"aliases repeat more than {_MOST_ALIASED} values", "values in full"
            )
        return Located(target.value, _line(event), target.items, target.count)

    def _error(
        self, line: int | None, problem: str, allowed: str | None, *, first: int | None = None
    ) -> SceneError:
        if first is not None:
            problem = f"{problem}, first on line {first}"
        return SceneError(problem, file=self._file, line=line, allowed=allowed)


def _line(event: Any) -> int:
    return int(event.start_mark.line) + 1


def _scalar(text: str) -> Any:
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if _NUMBER.fullmatch(text):
        return float(text)
    return text
