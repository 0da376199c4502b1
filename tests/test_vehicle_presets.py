"""The chairs that come with narrows: their sizes, and where every number comes from."""

import pytest

from narrows.errors import SceneError
from narrows.scene import load_vehicle, vehicle_names
from narrows.vehicle_presets import preset_entry


def numbers(entry: dict, path: str = "") -> set[str]:
    """Return the dotted paths of all numbers in an entry."""
    found = set()
    for key, value in entry.items():
        if isinstance(value, dict):
            found |= numbers(value, f"{path}{key}.")
        elif isinstance(value, float):
            found.add(f"{path}{key}")
    return found


@pytest.mark.parametrize("name", vehicle_names())
def test_every_number_says_where_it_comes_from(name):
    entry = preset_entry(name)
    stated = numbers(entry.model_dump(exclude_none=True, exclude={"sources"}))
    assert stated == set(entry.sources)
    for source in entry.sources.values():
        assert source.startswith(("[", "assumed: "))
        assert len(source) > 12


@pytest.mark.parametrize(
    ("name", "length", "width"),
    [
        ("narrow-arcs", 1.0, 0.67),
        ("adaag", 1.065, 0.66),
        ("dft", 1.2, 0.7),
        ("door-bezier", None, 0.75),
        ("xeno", None, 0.66),
    ],
)
def test_the_stated_sizes_are_those_of_papers_and_standards(name, length, width):
    chair = load_vehicle(name)
    assert chair.name == name
    assert chair.width == pytest.approx(width)
    if length is None:
        assert preset_entry(name).sources["body.length"].startswith("assumed")
    else:
        assert chair.length == pytest.approx(length)
        assert preset_entry(name).sources["body.length"].startswith("[")


def test_all_chairs_are_listed_and_known():
    assert vehicle_names() == ("adaag", "dft", "door-bezier", "narrow-arcs", "xeno")
    assert load_vehicle("narrow-arcs").wheel_radius == 0.16


def test_an_unknown_chair_names_the_nearest():
    with pytest.raises(SceneError, match="nearest is 'narrow-arcs'"):
        load_vehicle("narrow_arc")
    with pytest.raises(SceneError, match="adaag, dft"):
        load_vehicle("")
    with pytest.raises(SceneError, match="no chair of that name"):
        load_vehicle("../secrets")
