"""Tables in a study's report."""

from __future__ import annotations

import numbers
from collections.abc import Mapping, Sequence
from typing import Any

from ..errors import StudyError

_NOTHING = "–"


def markdown_table(
    rows: Sequence[Mapping[str, Any]],
    columns: Sequence[str] | Mapping[str, str],
    formats: Mapping[str, str] | None = None,
) -> str:
    """Return rows as a Markdown table, numbers to the right, texts to the left.

    Args:
        rows: Rows by column name. None, and a name a row does not have, become a dash.
        columns: Names in order, or a mapping from names to headings.
        formats: Format specifications by name, such as `.1f` or `.0%`, for the numbers of a
            column. Without one, integers are written whole and floats to four digits.

    Raises:
        StudyError: If there are no columns, a format is for none of them or does not apply.

    >>> print(markdown_table([{"door": 0.9, "spare": 21.4}], ["door", "spare"], {"spare": ".0f"}))
    | door | spare |
    |---:|---:|
    | 0.9 | 21 |
    """
    headings = dict(columns) if isinstance(columns, Mapping) else {name: name for name in columns}
    formats = formats or {}
    if not headings:
        raise StudyError("a table needs columns", field="columns")
    for name in formats:
        if name not in headings:
            raise StudyError("a format for no column", value=name, allowed=", ".join(headings))
    cells = [[_cell(row.get(name), name, formats.get(name)) for name in headings] for row in rows]
    rules = ["---:" if _is_numeric(rows, name) else "---" for name in headings]
    lines = [[_escaped(heading) for heading in headings.values()], *cells]
    texts = [f"| {' | '.join(line)} |" for line in lines]
    return "\n".join([texts[0], f"|{'|'.join(rules)}|", *texts[1:]])


def _cell(value: Any, name: str, specification: str | None) -> str:
    if value is None:
        return _NOTHING
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, numbers.Real):
        return _escaped(str(value))
    if specification is None:
        specification = "d" if isinstance(value, numbers.Integral) else ".4g"
    try:
        text = format(value, specification)
    except ValueError as error:
        raise StudyError(f"the format does not apply: {error}", field=name, value=value) from error
    return _unsigned_zero(text)


def _unsigned_zero(text: str) -> str:
    """Return a formatted number without the sign that rounding leaves on a zero."""
    is_zero = text.startswith("-") and not any(digit in text for digit in "123456789in")
    return text[1:] if is_zero else text


def _is_numeric(rows: Sequence[Mapping[str, Any]], name: str) -> bool:
    """Whether a column holds numbers and nothing else (None aside)."""
    values = [row.get(name) for row in rows if row.get(name) is not None]
    return bool(values) and all(
        isinstance(value, numbers.Real) and not isinstance(value, bool) for value in values
    )


def _escaped(text: str) -> str:
    """Return a text that stays within its cell."""
    return " ".join(text.split()).replace("|", "\\|")
