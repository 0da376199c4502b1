"""The study of real maps, on a map of our own: two rooms, two doors, four drives."""

import json

import pytest

from narrows.cli import run as run_command
from narrows.errors import StudyError
from narrows.studies import run
from narrows.studies.real_maps import read_drives
from narrows.studies.table import read_csv

WALLS = [[[0.0, 1.95], [1.55, 1.95], [1.55, 2.05], [0.0, 2.05]]]  # doors of 0.90 and 0.72 m
WALLS += [[[2.45, 1.95], [4.64, 1.95], [4.64, 2.05], [2.45, 2.05]]]
WALLS += [[[5.36, 1.95], [6.0, 1.95], [6.0, 2.05], [5.36, 2.05]]]
HEADER = (
    "folder,map,expect,door_or_task,start_x,start_y,start_yaw,goal_x,goal_y,goal_yaw,"
    "chair_width,chair_length"
)
UP = 1.5708


def drive(expect, door, x, width):
    return f"here,rooms,{expect},{door},{x},0.8,{UP},{x},3.2,{UP},{width},1.1"


@pytest.fixture
def data(tmp_path):
    (tmp_path / "here").mkdir()
    rooms = {"format": "wall-map/1", "bounds": [0, 0, 6, 4], "walls": [[ring] for ring in WALLS]}
    (tmp_path / "here" / "rooms.json").write_text(json.dumps(rooms))
    rows = [
        drive("must_succeed", "wide", 2.0, 0.7),
        drive("must_succeed", "tight", 5.0, 0.69),  # 15 mm on either side, 20 mm asked for
        drive("must_fail", "wide", 2.0, 0.95),
        drive("must_succeed", "mistaken", 2.0, 0.95),
    ]
    (tmp_path / "cases.csv").write_text("\n".join([HEADER, *rows]) + "\n")
    return tmp_path


@pytest.mark.slow
def test_the_study_tells_right_answers_from_wrong_ones(data, tmp_path):
    report = run("real-maps", tmp_path / "out", data=str(data))
    table = read_csv(tmp_path / "out" / "drives.csv", ("expect", "door_or_task"))
    answers = {(row["expect"], row["door_or_task"]): row for row in table.rows}
    assert answers["must_succeed", "wide"]["answer"] == "certified"
    assert answers["must_succeed", "wide"]["clearance_mm"] == pytest.approx(100.0, abs=1.0)
    tight = answers["must_succeed", "tight"]
    assert tight["is_below_margin"] == 1
    assert tight["clearance_mm"] == pytest.approx(15.0, abs=0.5)
    assert answers["must_fail", "wide"]["answer"] == "impassable"
    assert answers["must_fail", "wide"]["missing_mm"] == pytest.approx(50.0, abs=1.0)
    assert [row["is_expected"] for row in table.rows].count(0) == 1
    assert "3 of 4 drives are answered as they must be" in report.text
    wrong = report.text.split("## Not as expected")[1].split("##")[0]
    assert "mistaken" in wrong
    assert "tight" not in wrong
    assert "tight" in report.text.split("## Certified below the margin")[1]


def test_every_nth_drive_of_each_kind_is_taken(data):
    names = [row["door_or_task"] for row in read_drives(data / "cases.csv", every=2)]
    assert names == ["wide", "mistaken", "wide"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("chair_width", "breadth", r"cases\.csv:1: columns are missing; found \['chair_width'\]"),
        ("0.69", "narrow", r"cases\.csv:3: chair_width: not a number; found 'narrow'"),
        ("must_fail", "may_fail", r"cases\.csv:4: no such expectation; found 'may_fail'"),
    ],
)
def test_a_table_that_cannot_be_used_says_where_and_why(data, old, new, message):
    file = data / "cases.csv"
    file.write_text(file.read_text().replace(old, new))
    with pytest.raises(StudyError, match=message):
        read_drives(file)


def test_without_a_folder_it_says_what_to_give(tmp_path, monkeypatch):
    monkeypatch.delenv("NARROWS_DATA", raising=False)
    with pytest.raises(StudyError, match=r"--data: no maps; allowed: the folder of cases\.csv"):
        run("real-maps", tmp_path)


def test_the_command_takes_the_folder(data, tmp_path, capsys):
    (data / "cases.csv").write_text(HEADER + "\n" + drive("must_succeed", "wide", 2.0, 0.7) + "\n")
    out = str(tmp_path / "out")
    assert run_command(["study", "real-maps", "--data", str(data), "--out", out]) == 0
    assert "1 of 1 drives" in capsys.readouterr().out
