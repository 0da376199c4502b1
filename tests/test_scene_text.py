"""YAML with its lines: values of the core schema, places, and what is refused without delay."""

import math
import time

import pytest

from narrows.errors import SceneError
from narrows.scene_source import field_name
from narrows.scene_text import decode, read_source


def value(text: str):
    return read_source(text, None).root.value


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1", 1),
        ("-1.5", -1.5),
        ("1e-3", 1e-3),
        (".5", 0.5),
        ("1.", 1.0),
        ("007", 7),
        (".inf", math.inf),
        ("-.INF", -math.inf),
        ("true", True),
        ("FALSE", False),
        ("null", None),
        ("~", None),
        ("yes", "yes"),
        ("1:30", "1:30"),
        ("2026-01-01", "2026-01-01"),
        ("0x10", "0x10"),
        ("1_000", "1_000"),
        ("90 cm", "90 cm"),
        ('"1"', "1"),
        ("'true'", "true"),
        ("1" * 400, math.inf),
        ('{"a": [1, 2.5, "x", null, true]}', {"a": [1, 2.5, "x", None, True]}),
        ("a: &p [1, 2]\nb: *p", {"a": [1, 2], "b": [1, 2]}),
        ("1: a\ntrue: b", {"1": "a", "true": "b"}),
    ],
)
def test_scalars_follow_the_core_schema_of_yaml_1_2(text, expected):
    found = value(text)
    assert found == expected
    assert type(found) is type(expected)


def test_every_value_knows_its_line():
    source = read_source("a: 1\nb:\n  - {c: 2,\n     d: 3}\n  -\n    e: 4\n", "x.yaml")
    assert source.line(("a",)) == 1
    assert source.line(("b",)) == 2  # where its key stands
    assert source.line(("b", 0, "c")) == 3
    assert source.line(("b", 0, "d")) == 4
    assert source.line(("b", 1, "e")) == 6
    assert source.line(("b", 1, "missing")) == 6  # the nearest thing around it
    assert source.line(()) == 1


def test_an_error_names_its_place_its_value_and_the_remedy():
    source = read_source("a: 1\nb: {c: -2}\n", "x.yaml")
    error = source.error(("b", "c"), "is too small", value=-2, allowed="more than 0")
    assert str(error) == "x.yaml:2: b.c: is too small; found -2; allowed: more than 0"
    assert (error.file, error.line, error.field, error.value) == ("x.yaml", 2, "b.c", -2)


def test_fields_read_like_the_file():
    assert field_name(("world", "solids", 2, "polygon", 0)) == "world.solids[2].polygon[0]"
    assert field_name(("a\x1b[31m" + "b" * 100,)).isprintable()


@pytest.mark.parametrize(
    ("text", "line", "problem"),
    [
        ("", 1, "empty"),
        ("# only a comment\n", 1, "empty"),
        ("a: 1\nb: 2\na: 3", 3, "the key 'a' is given twice, first on line 1"),
        ("a:\n\tb: 1", 2, "spaces, not by tabs"),
        ("a:\n  b: 1\n   c: 2", 3, "indented alike"),
        ("a: [1, 2", None, "not YAML"),
        ("a: 1\n b: 2", 2, "not YAML"),
        ("a: \t- x\n\t- y", None, "not YAML"),
        ("a: \x01", None, "not YAML"),
        ('a: "\\UFFFFFFFF"', None, "not YAML"),
        ("%YAML 1" + "1" * 5000 + ".1\n---\na: 1", None, "not YAML"),
        ("---\na: 1\n---\nb: 2", 3, "second document"),
        ("a: !!python/object/apply:os.system [ls]", 1, "tag"),
        ("a: !!float 1", 1, "tag"),
        ("? [1, 2]\n: b", 1, "key must be plain text"),
        ("? {a: 1}\n: b", 1, "key must be plain text"),
        ("a: *nowhere", 1, "no finished anchor"),
        ("a: &a [*a]", 1, "no finished anchor"),
        ("a: &a {x: 1}\nb:\n  <<: *a", 3, "merge keys"),
    ],
)
def test_what_is_not_plain_yaml_is_refused_with_its_line(text, line, problem):
    with pytest.raises(SceneError, match=problem) as caught:
        read_source(text, "x.yaml")
    assert caught.value.file == "x.yaml"
    if line is not None:
        assert caught.value.line == line


BOMB = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 30)
)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        (BOMB, "aliases repeat"),
        ("[" * 50_000, "nested deeper"),
        ("{a: " * 50_000, "nested deeper"),
        ("- " * 50_000, "nested deeper"),
        ("[" * 50_000 + "]" * 50_000, "nested deeper"),
        ("x" * 5_000_000, "longer than"),
    ],
    ids=["aliases", "lists", "mappings", "dashes", "closed", "large"],
)
def test_bombs_are_refused_soon(text, problem):
    began = time.process_time()
    with pytest.raises(SceneError, match=problem):
        read_source(text, None)
    assert time.process_time() - began < 60.0  # 0.5 here; what explodes takes for ever


def test_text_is_utf_8_with_or_without_its_mark():
    assert decode("Tür".encode(), None) == "Tür"
    assert decode("\ufeffTür".encode(), None) == "Tür"
    with pytest.raises(SceneError, match=r"not a text file \(byte 0\)"):
        decode(b"\xff\xfe\x00", "x.yaml")
    with pytest.raises(SceneError, match="larger than 4 MB"):
        decode(b"a" * (2**22 + 1), "x.yaml")
