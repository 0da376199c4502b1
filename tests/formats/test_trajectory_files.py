"""Trajectories in files: what is written is read back, what is wrong is refused."""

import json
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import InputError, NarrowsError, TrajectoryError
from narrows.formats import read_trajectory, write_trajectory
from narrows.path import Path
from narrows.planners.timing import time_path
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle

CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25, track=0.6)
TEN_DECIMALS = 1e-9  # half a unit of the tenth decimal, and rounding where progress is summed up


@pytest.fixture(scope="module")
def trajectory() -> Trajectory:
    """Forward, on the spot, in reverse: every kind of section."""
    poses = [[0, 0, 0], [1, 0, 0], [1, 0, 1], [1 - 0.5 * np.cos(1), -0.5 * np.sin(1), 1]]
    return time_path(Path.from_poses(poses), CHAIR)


@pytest.mark.parametrize("suffix", [".csv", ".json"])
def test_what_is_written_is_read_back_to_ten_decimals(tmp_path, trajectory, suffix):
    file = tmp_path / f"drive{suffix}"
    write_trajectory(trajectory, file, vehicle=CHAIR)
    back = read_trajectory(file)
    assert isinstance(back, Trajectory)
    np.testing.assert_allclose(back(trajectory.times), trajectory.poses, atol=TEN_DECIMALS)
    assert back.duration == pytest.approx(trajectory.duration, abs=1e-9)
    assert back.path.direction_changes == trajectory.path.direction_changes == 1


def test_rows_are_close_and_the_header_is_the_contract(tmp_path, trajectory):
    file = tmp_path / "drive.csv"
    write_trajectory(trajectory, file, vehicle=CHAIR)
    assert file.read_text().splitlines()[0] == "t,x,y,heading,v,omega,v_left,v_right"
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    assert np.diff(table[:, 0]).max() <= 0.02 + 1e-9
    assert np.hypot(*np.diff(table[:, 1:3], axis=0).T).max() <= 0.01 + 1e-9
    half_track = 0.3
    np.testing.assert_allclose(table[:, 6], table[:, 4] - half_track * table[:, 5], atol=1e-9)
    np.testing.assert_allclose(table[:, 7], table[:, 4] + half_track * table[:, 5], atol=1e-9)
    assert "-0.0000000000" not in file.read_text()


def test_the_row_at_a_direction_change_is_exact(tmp_path, trajectory):
    file = tmp_path / "drive.csv"
    write_trajectory(trajectory, file, vehicle=CHAIR)
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    for corner in ([1.0, 0.0, 0.0], [1.0, 0.0, 1.0]):
        assert np.abs(table[:, 1:4] - corner).max(axis=1).min() < TEN_DECIMALS


rows = st.lists(
    st.tuples(
        st.floats(0.01, 2.0),
        st.floats(-2.0, 2.0),
        st.floats(-2.0, 2.0),
        st.floats(-3.1, 3.1),
    ),
    min_size=2,
    max_size=12,
)


@pytest.mark.parametrize("suffix", [".csv", ".json"])
@given(rows=rows)
@settings(deadline=None, max_examples=15, derandomize=True)
def test_any_timed_rows_survive_writing_and_reading(tmp_path_factory, suffix, rows):
    table = np.array(rows)
    times = np.cumsum(table[:, 0])
    try:
        first = Trajectory.from_samples(times, table[:, 1:])
    except NarrowsError:
        return  # nothing moves
    first_times = np.linspace(0.0, first.duration, 200)
    file = tmp_path_factory.mktemp("rows") / f"rows{suffix}"
    write_trajectory(first, file, vehicle=CHAIR)
    back = read_trajectory(file)
    assert isinstance(back, Trajectory)
    # speeds up to 600 m/s times half a unit of the tenth decimal of the time
    np.testing.assert_allclose(back(first_times), first(first_times), atol=1e-6)


def test_a_csv_without_times_is_a_path(tmp_path):
    file = tmp_path / "rows.csv"
    file.write_text("x,y,heading\n0,0,0\n1,0,0\n")
    motion = read_trajectory(file)
    assert isinstance(motion, Path)
    np.testing.assert_allclose(motion.goal, [1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    "text",
    [
        "yaw, X ,Y\n0,0,0\n0,2,0\n",
        "# made elsewhere\n\nx;y;theta\n0;0;0\n2;0;0\n",
        "x\ty\theading_deg\n0\t0\t0\n2\t0\t360\n",
        "\ufeffx_m,y_m,yaw_rad,battery\n0,0,0,full\n2,0,0,low\n",
        '"x","y","heading"\r\n0,0,0\r\n2,0,0\r\n',
    ],
)
def test_headers_may_be_written_as_people_write_them(tmp_path, text):
    file = tmp_path / "rows.csv"
    file.write_text(text, encoding="utf-8", newline="")
    motion = read_trajectory(file)
    np.testing.assert_allclose(motion.goal[:2], [2.0, 0.0])


@pytest.mark.parametrize(
    "document",
    [
        [[0, 0, 0], [2, 0, 0.5]],
        [{"x": 0, "y": 0, "yaw": 0}, {"yaw": 0.5, "y": 0, "x": 2}],
        {"columns": ["heading", "x", "y"], "rows": [[0, 0, 0], [0.5, 2, 0]]},
    ],
)
def test_json_of_three_forms_gives_the_same_path(tmp_path, document):
    file = tmp_path / "rows.json"
    file.write_text(json.dumps(document))
    np.testing.assert_allclose(read_trajectory(file).goal, [2.0, 0.0, 0.5], atol=1e-12)


def test_degrees_are_turned_into_radians(tmp_path):
    file = tmp_path / "rows.csv"
    file.write_text("t,x,y,heading_deg\n0,0,0,0\n1,0,0,90\n")
    assert read_trajectory(file).path.goal[2] == pytest.approx(np.pi / 2)


WRONG_CSV = {
    "": "the file is empty",
    "  \n\n": "the file is empty",
    "# nothing\n": "there is no header",
    "x,y\n0,0\n1,0\n": ":1: there is no column heading; found 'x, y'",
    "0,0,0\n1,0,0\n": ":1: there is no column x",
    "x,y,heading\n": "a motion needs at least two rows; found 'none'",
    "x,y,heading\n0,0,0\n": "a motion needs at least two rows; found '1 row'",
    "x,y,heading\n0,0,0\n1,0\n": ":3: the row and the header differ in length; found '2 values'",
    "x,y,heading\n0,0,0\n1,zero,0\n": ":3: y: this is not a number; found 'zero'",
    "x,y,heading\n0,0,0\n1,,0\n": ":3: y: the value is empty",
    "x,y,heading\n0,0,0\n\n1,nan,0\n": ":4: y: this number is too large or not finite; found 'nan'",
    "x,y,heading\n0,0,0\n1e400,0,0\n": ":3: x: this number is too large or not finite",
    "x,y,heading\n0,0,0\n1_0,0,0\n": ":3: x: this is not a number; found '1_0'",
    "x,y,heading\n0,0,0\n1e9,0,0\n": ":3: x: this number is too large or not finite; found '1e9'",
    "t,x,y,heading\n0,0,0,0\n1,1,0,0\n1,2,0,0\n": ":4: t: times must increase from row to row",
    "x,y,heading,yaw\n0,0,0,0\n1,0,0,0\n": ":1: heading, yaw: this column is there twice",
    "x,y,heading,heading_deg\n0,0,0,0\n1,0,0,0\n": ":1: heading: the heading is there twice",
    "x,y,heading\n1,1,1\n1,1,1\n": "the rows are no motion",
    'x,y,heading\n"0,0,0\n1,0,0\n': "differ in length",
}


@pytest.mark.parametrize(("text", "message"), WRONG_CSV.items())
def test_a_wrong_csv_is_refused_with_its_place(tmp_path, text, message):
    file = tmp_path / "wrong.csv"
    file.write_text(text)
    with pytest.raises(TrajectoryError) as caught:
        read_trajectory(file)
    assert message in str(caught.value)
    assert str(caught.value).startswith(str(file))


WRONG_JSON = {
    "{": ":1: this is not JSON",
    "3": "this JSON is no trajectory; found 'int'",
    "[]": "a motion needs at least two rows",
    "[[0,0,0],[1,0,NaN]]": "this number is not finite; found 'NaN'",
    "[[0,0,0],[1,0,Infinity]]": "this number is not finite",
    "[[0,0,0],[1,0]]": "[1]: a row is as long as its columns are many; found '2 values'",
    "[[0,0,0],[1,0,true]]": "[1].heading: this is not a number",
    "[[0,0,0],7]": "[1]: a row is as long as its columns are many; found 7",
    '[{"x":0,"y":0}]': "there is no column heading",
    '[{"x":0,"y":0,"yaw":0},{"x":1}]': "[1]: the fields differ from the first row's",
    '{"rows":[]}': "columns: the names of the columns are missing",
    '{"columns":["x","y","yaw"]}': "rows: the rows are missing",
    '{"columns":["t","x","y","yaw"],"rows":[[0,0,0,0],[0,1,0,0]]}': "rows[1].t: times must",
    '{"format":"other/1","columns":[],"rows":[]}': "format: this is another format",
    "[[0,0,0],[" + "9" * 5000 + ",0,0]]": "this JSON is no trajectory",
    "[" * 100_000: "this JSON is no trajectory",
}


@pytest.mark.parametrize(("text", "message"), WRONG_JSON.items(), ids=range(len(WRONG_JSON)))
def test_a_wrong_json_is_refused_with_its_place(tmp_path, text, message):
    file = tmp_path / "wrong.json"
    file.write_text(text)
    with pytest.raises(TrajectoryError) as caught:
        read_trajectory(file)
    assert message in str(caught.value)


def test_binary_missing_files_and_folders_are_refused(tmp_path):
    file = tmp_path / "binary.csv"
    file.write_bytes(b"x,y,heading\n\xff\xfe\x00")
    with pytest.raises(TrajectoryError, match="2: this is not text"):
        read_trajectory(file)
    file.write_bytes(b"x,y,heading\n0,0,\x00")
    with pytest.raises(TrajectoryError, match="2: this is not text"):
        read_trajectory(file)
    with pytest.raises(TrajectoryError, match="no such file"):
        read_trajectory(tmp_path / "none.csv")
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(TrajectoryError, match="folder"):
        read_trajectory(tmp_path / "folder.csv")
    with pytest.raises(TrajectoryError, match="cannot be read"):
        read_trajectory("a\0b.csv")


@given(content=st.binary(max_size=200), suffix=st.sampled_from([".csv", ".json"]))
@settings(deadline=None, max_examples=150, derandomize=True)
def test_any_bytes_are_a_motion_or_one_clear_error(tmp_path_factory, content, suffix):
    file = tmp_path_factory.mktemp("bytes") / f"any{suffix}"
    file.write_bytes(b"x,y,heading\n" * (suffix == ".csv") + content)
    with suppress(TrajectoryError):
        read_trajectory(file)


def test_other_suffixes_are_refused_in_both_directions(tmp_path, trajectory):
    for name, message in (("a.mcap", "MCAP is not supported yet"), ("a.txt", "not supported")):
        with pytest.raises(TrajectoryError, match=message):
            read_trajectory(tmp_path / name)
        with pytest.raises(TrajectoryError, match=r"\.csv or \.json"):
            write_trajectory(trajectory, tmp_path / name, vehicle=CHAIR)
    assert not list(tmp_path.iterdir())


def test_a_file_that_cannot_be_written_leaves_nothing_behind(tmp_path, trajectory):
    (tmp_path / "taken").write_text("a file")
    with pytest.raises(InputError, match="cannot be written"):
        write_trajectory(trajectory, tmp_path / "taken" / "a.csv", vehicle=CHAIR)
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        write_trajectory(trajectory, tmp_path / "folder.csv", vehicle=CHAIR)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder.csv", "taken"]


def test_one_fast_step_does_not_make_the_slow_ones_dense():
    motion = Trajectory.from_samples([0.0, 10.0, 10.001], [[0, 0, 0], [0.1, 0, 0], [1.1, 0, 0]])
    assert len(motion.times) < 700  # 10 s at 50 rows a second, 1 m at a row a centimetre
