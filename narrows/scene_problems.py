"""What is wrong with a scene file, in words: the model's complaints with line, field and remedy."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from .errors import SceneError
from .scene_source import Source, Step, printable

if TYPE_CHECKING:
    from pydantic import BaseModel

    Model = TypeVar("Model", bound=BaseModel)

_PROBLEMS = {
    "missing": "is missing",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
    "greater_than": "is too small",
    "greater_than_equal": "is too small",
    "less_than": "is too large",
    "less_than_equal": "is too large",
    "string_type": "must be text",
    "string_too_long": "is too long a text",
    "list_type": "must be a list",
    "tuple_type": "must be a list",
    "dict_type": "must be a mapping",
    "model_type": "must be a mapping",
    "model_attributes_type": "must be a mapping",
    "literal_error": "is not one of the choices",
}
_RANGES = {
    "exclusiveMinimum": "more than",
    "minimum": "at least",
    "exclusiveMaximum": "less than",
    "maximum": "at most",
    "minItems": "at least",
    "maxItems": "at most",
    "maxLength": "at most",
}


def validated(model: type[Model], source: Source, value: Any) -> Model:
    """Return the value as the model's entry.

    Raises:
        SceneError: If it does not fit the model; the first problem, with the others behind it.
    """
    from pydantic import ValidationError

    try:
        return model.model_validate(value)
    except ValidationError as error:
        found = error.errors(include_url=False)
    # A misspelt key explains the missing one on its line: name it first.
    found.sort(key=lambda problem: problem["type"] != "extra_forbidden")
    schema = model.model_json_schema()
    raise first_of([_translated(schema, source, problem) for problem in found])


def first_of(problems: Sequence[SceneError]) -> SceneError:
    """Return the first problem by line, with the others behind it."""
    first, *others = sorted(problems, key=lambda problem: problem.line or 0)
    return SceneError(
        first.problem,
        file=first.file,
        line=first.line,
        field=first.field,
        value=first.value,
        allowed=first.allowed,
        others=others,
    )


def nearest(word: str, known: Sequence[str]) -> str:
    """Return the known word most like another.

    >>> nearest("Polygn", ["circle", "polygon"])
    'polygon'
    """
    by_small = {name.lower(): name for name in known}
    matches = difflib.get_close_matches(printable(word).lower(), by_small, n=1, cutoff=0.0)
    return by_small[matches[0]] if matches else sorted(known)[0]


def _translated(schema: dict[str, Any], source: Source, found: Any) -> SceneError:
    path: tuple[Step, ...] = found["loc"]
    kind, value = found["type"], found["input"]
    if kind == "extra_forbidden":
        known = list(_at(schema, path[:-1]).get("properties", {}))
        guess = nearest(str(path[-1]), known)
        problem = f"unknown key; the nearest known one is '{guess}'"
        return source.error(path, problem, value=printable(str(path[-1])), allowed=", ".join(known))
    if kind == "missing":
        return source.error(path, _PROBLEMS[kind], allowed=_allowed(_at(schema, path)))
    if kind in ("too_short", "too_long"):
        count = found["ctx"]["actual_length"]
        problem = f"has too {'few' if kind == 'too_short' else 'many'} entries: {count}"
    else:
        problem = _PROBLEMS.get(kind, found["msg"])
    return source.error(path, problem, value=_shown(value), allowed=_allowed(_at(schema, path)))


def _shown(value: Any) -> Any:
    """Return a value for an error message; nothing given reads as 'nothing'."""
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return f"a mapping with {', '.join(printable(str(key)) for key in list(value)[:6])}"
    return value


def _allowed(node: dict[str, Any]) -> str:
    """Return what a node of the JSON Schema accepts: its meaning, then its range."""
    meaning = str(node.get("description", ""))
    if "properties" in node and "{" not in meaning:
        meaning = f"{{{', '.join(node['properties'])}}}"
    ranges = [f"{word} {node[key]:g}" for key, word in _RANGES.items() if key in node]
    if "enum" in node:
        ranges.append(" or ".join(node["enum"]))
    if node.get("minItems") is not None and node.get("minItems") == node.get("maxItems"):
        ranges = [f"exactly {node['minItems']} entries"]
    return "; ".join(part for part in (meaning, ", ".join(ranges)) if part)


def _at(schema: dict[str, Any], path: Sequence[Step]) -> dict[str, Any]:
    """Return the node of the JSON Schema that describes the field a path leads to."""
    node = _resolved(schema, schema)
    for step in path:
        if isinstance(step, int):
            places = node.get("prefixItems", [])
            inner = places[step] if step < len(places) else node.get("items", {})
        else:
            inner = node.get("properties", {}).get(step, {})
        node = _resolved(schema, inner)
    return node


def _resolved(schema: dict[str, Any], node: dict[str, Any]) -> dict[str, Any]:
    """Return the node with references followed and the first of several choices taken.

    What is said at the place itself outranks what is said where it refers to.
    """
    while "$ref" in node or "anyOf" in node:
        own = {key: value for key, value in node.items() if key not in ("$ref", "anyOf")}
        if "$ref" in node:
            target = schema["$defs"][node["$ref"].rsplit("/", 1)[1]]
        else:
            target = node["anyOf"][0]
        node = {**target, **own}
    return node
