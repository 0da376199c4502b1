"""The public names are those documented, typed as they run, and stand where they say."""

import ast
import re
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

import narrows

ROOT = Path(__file__).parents[1]


def documented_names() -> set[str]:
    """Return the names the reference page gives a line of their own: `name` at a table's start."""
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    return set(re.findall(r"^\| `(\w+)", text, flags=re.MULTILINE))


def typed_names() -> set[str]:
    """Return the names a type checker sees in `narrows`."""
    tree = ast.parse((ROOT / "narrows" / "__init__.py").read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    assert ast.unparse(block.test) == "TYPE_CHECKING"
    return {alias.name for node in block.body for alias in node.names}


def test_the_public_names_are_exactly_those_documented():
    assert set(narrows.__all__) - {"__version__"} == documented_names()


def test_type_checkers_see_the_names_that_run():
    assert set(narrows.__all__) - {"__version__"} == typed_names()


@pytest.mark.parametrize("name", sorted(narrows.__all__))
def test_each_name_is_there_and_documented_in_its_docstring(name):
    value = getattr(narrows, name)
    if name != "__version__":
        assert value.__doc__, name
        assert value.__module__.startswith("narrows.")
        assert getattr(import_module(value.__module__), name) is value


def test_dir_lists_the_public_names():
    assert dir(narrows) == sorted(narrows.__all__)


def test_other_names_are_refused():
    with pytest.raises(AttributeError, match="module 'narrows' has no attribute 'nothing'"):
        narrows.nothing  # noqa: B018


def test_the_version_is_the_packages():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert narrows.__version__ == project["version"]
