"""The command line keeps its contract: fields, exit codes, where each word goes."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.cli import run

ROOT = Path(__file__).parents[1]
SCENES = ROOT / "examples" / "scenes"
DOOR, TOO_NARROW = str(SCENES / "door.yaml"), str(SCENES / "too-narrow.yaml")
PLAN_FIELDS = [
    "status",
    "planner",
    "clearance_m",
    "length_m",
    "duration_s",
    "max_curvature_1_m",
    "direction_changes",
    "peak_jerk_m_s3",
    "solve_time_s",
    "reason",
]
DRIVE_FIELDS = [
    "reached",
    "collisions",
    "min_clearance_m",
    "max_cross_track_error_m",
    "final_position_error_m",
    "final_heading_error_deg",
    "duration_s",
    "length_m",
]
WALL = "[[3, -1], [3.1, -1], [3.1, 1], [3, 1]]"
POST = "[[1.45, 0.3], [1.5, 0.3], [1.5, 0.4], [1.45, 0.4]]"
STRAIGHT_ROOM = f"""
vehicle: {{body: {{length: 1.0, width: 0.7, rear_overhang: 0.2}}}}
world: {{solids: [{{polygon: {WALL}, name: wall}}]}}
start: {{x: 0, y: 0, heading_deg: 0}}
goal: {{x: 2, y: 0, heading_deg: 0}}
"""


@pytest.fixture
def cli(capsys):
    """Run a command; return exit code, standard output, standard error."""

    def call(*arguments: object) -> tuple[int, str, str]:
        code = run([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return call


@pytest.fixture
def cli_json(cli):
    """Run a command with --json; return exit code and the one object it prints."""

    def call(*arguments: object) -> tuple[int, dict]:
        code, out, _ = cli(*arguments, "--json")
        assert len(out.splitlines()) == 1

        def refuse(constant: str) -> None:
            raise AssertionError(f"{constant} is not JSON")

        return code, json.loads(out, parse_constant=refuse)

    return call


@pytest.fixture
def room(tmp_path):
    """A chair that can drive 2 m straight to 0.2 m before a wall."""
    file = tmp_path / "room.yaml"
    file.write_text(STRAIGHT_ROOM)
    return file


def csv_of(tmp_path, rows, header="x,y,heading"):
    file = tmp_path / "rows.csv"
    file.write_text("\n".join([header, *(",".join(map(str, row)) for row in rows)]))
    return file


# plan


def test_a_plan_has_the_fields_of_the_contract_and_is_written(cli_json, tmp_path):
    output = tmp_path / "door.csv"
    code, fields = cli_json("plan", DOOR, "-o", output)
    assert code == 0
    assert list(fields) == PLAN_FIELDS
    assert fields["status"] == "certified"
    assert 0.0 < fields["clearance_m"] < 0.115  # half of what a 0.90 m door leaves a 0.67 m chair
    assert fields["direction_changes"] == 0
    assert 0.0 < fields["solve_time_s"] < 60.0
    table = np.loadtxt(output, delimiter=",", skiprows=1)
    assert table[-1, 0] == pytest.approx(fields["duration_s"], abs=1e-9)
    moved = np.hypot(*np.diff(table[:, 1:3], axis=0).T).sum()
    assert moved == pytest.approx(fields["length_m"], abs=1e-3)  # chords of rows 1 cm apart


def test_what_plan_writes_verify_certifies(cli, cli_json, tmp_path):
    for name in ("door.csv", "door.json"):
        assert cli("plan", DOOR, "-o", tmp_path / name)[0] == 0
        code, fields = cli_json("verify", DOOR, tmp_path / name)
        assert (code, fields["status"], fields["limits_kept"]) == (0, "certified", True)


def test_a_plan_that_is_not_certified_writes_no_trajectory(cli, tmp_path):
    output, picture = tmp_path / "none.csv", tmp_path / "none.png"
    code, out, err = cli("plan", TOO_NARROW, "-o", output, "--picture", picture)
    assert code == 3
    assert "impassable" in out
    assert "nothing was written" in err
    assert not output.exists()
    assert picture.stat().st_size > 10_000


def test_an_impassable_scene_has_null_figures_and_a_reason(cli_json):
    code, fields = cli_json("plan", TOO_NARROW)
    assert code == 3
    assert list(fields) == PLAN_FIELDS
    assert fields["status"] == "impassable"
    assert fields["clearance_m"] is None
    assert "mm" in fields["reason"]


def test_an_unknown_planner_is_an_error_that_names_those_there_are(cli):
    code, out, err = cli("plan", DOOR, "--planner", "dooorway")
    assert (code, out) == (2, "")
    assert "doorway" in err


# passable


def test_passable_says_what_is_to_spare(cli_json):
    code, fields = cli_json("passable", DOOR)
    assert code == 0
    assert list(fields) == ["status", "spare_mm", "narrowest", "reason", "time_s"]
    assert fields["status"] == "passable"
    assert fields["spare_mm"] == pytest.approx(230.0, abs=2.0)  # 0.90 m less 0.67 m


def test_passable_says_what_is_missing(cli_json):
    code, fields = cli_json("passable", TOO_NARROW)
    assert (code, fields["status"]) == (3, "impassable")
    assert fields["spare_mm"] < 0.0


def test_what_is_not_decided_is_not_said_to_lack_anything(cli, tmp_path):
    scene = tmp_path / "exact.yaml"  # the door is as wide as the chair
    scene.write_text("vehicle: narrow-arcs\ndoorway: {corridor_width: 1.6, door_width: 0.67}\n")
    code, out, _ = cli("passable", scene)
    assert code == 4
    assert "undecided" in out
    assert "missing" not in out


# verify


def test_a_clear_drive_is_certified_with_its_exact_clearance(cli_json, room, tmp_path):
    code, fields = cli_json("verify", room, csv_of(tmp_path, [[0, 0, 0], [2, 0, 0]]))
    assert code == 0
    assert list(fields) == ["status", "clearance_m", "at", "against", "limits_kept", "reason"]
    assert fields["clearance_m"] == pytest.approx(0.2, abs=1e-3)
    assert fields["at"] == pytest.approx([2.0, 2.0, 0.0], abs=0.01)
    assert fields["against"] == "wall"


def test_contact_between_rows_is_refused(cli_json, tmp_path):
    scene = tmp_path / "post.yaml"
    scene.write_text(STRAIGHT_ROOM.replace(WALL, POST))
    code, fields = cli_json("verify", scene, csv_of(tmp_path, [[-1, 0, 0], [3, 0, 0]]))
    assert (code, fields["status"]) == (4, "refused")
    assert fields["clearance_m"] == pytest.approx(-0.05, abs=1e-3)
    assert "cuts 50 mm into wall" in fields["reason"]


@pytest.mark.parametrize(
    ("header", "rows", "reason"),
    [
        ("x,y,heading", [[0, 0, 0], [1, 0.2, 0]], "slip"),
        ("t,x,y,heading", [[0, 0, 0, 0], [0.5, 2, 0, 0]], "speed reaches 4 m/s"),
    ],
)
def test_what_a_chair_cannot_do_is_refused(cli_json, room, tmp_path, header, rows, reason):
    code, fields = cli_json("verify", room, csv_of(tmp_path, rows, header))
    assert (code, fields["limits_kept"]) == (4, False)
    assert reason in fields["reason"]


def test_other_ends_are_noted_and_refuse_nothing(cli, room, tmp_path):
    code, out, _ = cli("verify", room, csv_of(tmp_path, [[-1, 0, 0], [1, 0, 0]]))
    assert code == 0
    assert "starts 1000 mm" in out
    assert "ends 1000 mm" in out


def test_nothing_to_touch_is_null_not_infinity(cli_json, tmp_path):
    scene = tmp_path / "empty.yaml"
    scene.write_text(STRAIGHT_ROOM.replace(f"[{{polygon: {WALL}, name: wall}}]", "[]"))
    code, fields = cli_json("verify", scene, csv_of(tmp_path, [[0, 0, 0], [2, 0, 0]]))
    assert code == 0
    assert fields["clearance_m"] is None
    assert fields["at"] is None
    assert fields["against"] is None


# drive


@pytest.mark.slow
def test_a_drive_is_planned_tracked_recorded_and_judged(cli_json, tmp_path):
    files = {name: tmp_path / name for name in ("door.csv", "record.csv", "drive.png")}
    code, fields = cli_json(
        "drive",
        DOOR,
        "--save-trajectory",
        files["door.csv"],
        "--record",
        files["record.csv"],
        "--picture",
        files["drive.png"],
    )
    assert code == 0
    assert list(fields) == DRIVE_FIELDS
    assert fields["reached"] is True
    assert fields["collisions"] == 0
    assert fields["min_clearance_m"] > 0.0
    assert all(file.stat().st_size > 1000 for file in files.values())
    code, again = cli_json("drive", DOOR, "--trajectory", files["door.csv"])
    assert code == 0
    assert again["length_m"] == pytest.approx(fields["length_m"], abs=0.01)


def test_a_drive_into_a_wall_is_judged_a_collision(cli_json, room, tmp_path):
    rows = [[0, 0, 0, 0], [5, 2.5, 0, 0]]
    code, fields = cli_json("drive", room, "--trajectory", csv_of(tmp_path, rows, "t,x,y,heading"))
    assert code == 4
    assert fields["reached"] is False
    assert fields["collisions"] == 1
    assert fields["min_clearance_m"] < 0.0


def test_driving_a_scene_without_a_plan_drives_nothing(cli_json):
    code, fields = cli_json("drive", TOO_NARROW)
    assert code == 3
    assert list(fields) == DRIVE_FIELDS
    assert fields["reached"] is False
    assert fields["duration_s"] is None


def test_an_unknown_tracker_is_an_error_that_names_those_there_are(cli):
    code, out, err = cli("drive", DOOR, "--tracker", "nobody")
    assert (code, out) == (2, "")
    assert "allowed: lookahead" in err


# study


def test_study_without_a_name_lists_the_studies(cli):
    code, out, _ = cli("study")
    assert code == 0
    assert "door-bezier" in out


def test_an_unknown_study_is_an_error_that_names_the_nearest(cli, tmp_path):
    code, _, err = cli("study", "door-bezeir", "--out", tmp_path)
    assert code == 2
    assert "door-bezier?" in err


# wrong input

WRONG = {
    "missing scene": ("plan", "nowhere.yaml"),
    "folder": ("plan", "."),
    "unknown verb": ("fly", DOOR),
    "unknown option": ("plan", DOOR, "--fast"),
    "missing argument": ("verify", DOOR),
    "missing trajectory": ("verify", DOOR, "nowhere.csv"),
    "unknown format": ("plan", DOOR, "-o", "door.docx"),
    "mcap": ("plan", DOOR, "-o", "door.mcap"),
    "unknown picture": ("plan", DOOR, "--picture", "door.bmp"),
    "output is a folder": ("plan", DOOR, "-o", "folder.csv"),
    "output below a file": ("plan", DOOR, "-o", "file/door.csv"),
    "record": ("drive", DOOR, "--record", "drive.xml"),
    "jobs": ("study", "door-bezier", "--jobs", "0"),
    "seed": ("study", "door-bezier", "--seed", "-1"),
    "large seed": ("study", "door-bezier", "--seed", "9" * 20, "--out", "made"),
    "no maps": ("study", "real-maps", "--data", "file", "--out", "maps"),
    "out is a file": ("study", "real-maps", "--out", "file"),
}


@pytest.mark.parametrize("arguments", WRONG.values(), ids=WRONG)
def test_wrong_input_is_exit_code_2_and_one_message(cli, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.csv").mkdir()
    (tmp_path / "file").write_text("")
    code, out, err = cli(*arguments)
    assert (code, out) == (2, "")
    assert err.startswith("narrows: ")
    assert "Traceback" not in err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder.csv"]


def test_wrong_input_with_json_says_where(cli, tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(STRAIGHT_ROOM.replace("heading_deg: 0}\ngoal", "heading: 0}\ngoal"))
    code, out, err = cli("plan", scene, "--json")
    fields = json.loads(out)
    assert code == 2
    assert fields["status"] == "error"
    assert (fields["file"], fields["line"]) == (str(scene), 4)
    assert "heading_deg" in fields["reason"]
    assert str(scene) in err


@given(content=st.binary(max_size=120))
@settings(deadline=None, max_examples=25, derandomize=True)
def test_any_file_as_scene_or_trajectory_ends_in_an_exit_code(tmp_path_factory, content):
    folder = tmp_path_factory.mktemp("any")
    (folder / "any.yaml").write_bytes(content)
    (folder / "any.csv").write_bytes(b"x,y,heading\n" + content)
    assert run(["passable", str(folder / "any.yaml")]) == 2
    assert run(["verify", DOOR, str(folder / "any.csv")]) in (0, 2, 4)


def test_an_interrupted_command_is_130(monkeypatch, cli):
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("narrows.commands.verify.run_verify", interrupt)
    code, out, _ = cli("verify", DOOR, "any.csv")
    assert (code, out) == (130, "")


# as a process


def narrows(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "narrows.cli", *arguments]
    return subprocess.run(
        command, capture_output=True, text=True, timeout=600, check=False, **options
    )


def test_version_help_and_no_verb():
    assert narrows("--version").stdout.startswith("narrows, version ")
    for verb in ("plan", "passable", "verify", "drive", "study"):
        shown = narrows(verb, "--help")
        assert shown.returncode == 0
        assert f"narrows {verb}" in shown.stdout.split("Examples:")[1]
    bare = narrows()
    assert (bare.returncode, bare.stderr) == (0, "")
    assert bare.stdout == narrows("--help").stdout


def test_a_reader_that_goes_away_ends_the_command_quietly():
    command = f"{sys.executable} -m narrows.cli passable {DOOR} | true; echo ${{PIPESTATUS[0]}}"
    done = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, timeout=600, check=False
    )
    assert done.stderr == ""
    assert done.stdout.strip() == "141"


@pytest.mark.parametrize("closed", [">/dev/full", ">/dev/full --json", ">&-", "2>/dev/full"])
def test_an_output_that_takes_nothing_ends_in_an_exit_code(closed):
    verb = "plan nowhere.yaml" if closed.startswith("2") else "study"
    verb = "passable nowhere.yaml" if "json" in closed else verb
    command = f"{sys.executable} -m narrows.cli {verb} {closed}"
    done = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == (0 if closed == ">&-" else 2)
    assert "Traceback" not in done.stderr


def test_a_name_that_the_terminal_cannot_show_is_escaped(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text("name: Ω\n" + STRAIGHT_ROOM.strip(), encoding="utf-8")
    done = narrows("passable", str(scene), env={"PYTHONIOENCODING": "latin-1"})
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("\\u03a9: passable")


def test_shell_completion_knows_the_verbs_and_options():
    environment = {
        "_NARROWS_COMPLETE": "bash_complete",
        "COMP_WORDS": "narrows pl",
        "COMP_CWORD": "1",
    }
    assert "plan" in narrows(env=environment).stdout
    environment |= {"COMP_WORDS": "narrows plan --pi", "COMP_CWORD": "2"}
    assert "--picture" in narrows(env=environment).stdout
