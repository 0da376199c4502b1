"""Claims about the sweep in one process: what is run, what is kept, what is refused."""

import math
import sqlite3

import numpy as np
import pytest

from narrows.errors import StudyError
from narrows.studies.store import read_table
from narrows.studies.sweep import sweep
from narrows.studies.table import RUN_COLUMNS, read_csv


def content(table):
    """Rows without what differs from run to run."""
    return [{k: v for k, v in row.items() if k not in RUN_COLUMNS} for row in table.rows]


def numbered(tmp_path, count=9, **more):
    return [{"number": n, "log": str(tmp_path / "log"), **more} for n in range(count)]


def runs(tmp_path):
    """Numbers of the cases run since the last call."""
    log = tmp_path / "log"
    found = sorted(int(line.split()[0]) for line in log.read_text().splitlines())
    log.write_text("")
    return found


WIDTHS = [{"width": w / 100, "chair": c} for w in (80, 90, 100) for c in ("adaag", "xeno")]


def test_results_depend_on_neither_order_nor_number_of_processes(tmp_path, functions):
    keys = ("width", "chair")
    one = sweep(WIDTHS, functions.draw, table=tmp_path / "a.sqlite", keys=keys)
    back = sweep(WIDTHS[::-1], functions.draw, table=tmp_path / "b.sqlite", keys=keys)
    two = sweep(WIDTHS, functions.draw, table=tmp_path / "c.sqlite", keys=keys, jobs=2)
    turned = sweep(WIDTHS, functions.draw, table=tmp_path / "d.sqlite", keys=keys[::-1])
    assert content(one) == content(back) == content(two)
    assert [row["noise"] for row in one.rows] == [
        turned.where(width=r["width"], chair=r["chair"]).rows[0]["noise"] for r in one.rows
    ]
    assert len({row["noise"] for row in one.rows}) == len(WIDTHS)


def test_another_seed_gives_other_numbers(tmp_path, functions):
    first, second = (
        sweep(
            WIDTHS, functions.draw, table=tmp_path / f"{s}.sqlite", keys=("width", "chair"), seed=s
        )
        for s in (0, 1)
    )
    assert not set(first.column("noise")) & set(second.column("noise"))


def test_resuming_runs_exactly_the_missing_cases(tmp_path, functions):
    cases = numbered(tmp_path)
    table = tmp_path / "t.sqlite"
    sweep(cases[2:5], functions.logged, table=table, keys=("number",))
    assert runs(tmp_path) == [2, 3, 4]
    found = sweep(cases, functions.logged, table=table, keys=("number",))
    assert runs(tmp_path) == [0, 1, 5, 6, 7, 8]
    assert list(found.column("square")) == [n**2 for n in range(9)]


def test_the_table_returned_holds_the_cases_asked_for_and_the_file_all(tmp_path, functions):
    cases = numbered(tmp_path)
    table = tmp_path / "t.sqlite"
    sweep(cases, functions.logged, table=table, keys=("number",))
    assert len(sweep(cases[:2], functions.logged, table=table, keys=("number",))) == 2
    assert len(read_table(table)) == 9


def test_a_case_whose_other_columns_changed_is_run_again(tmp_path, functions):
    table = tmp_path / "t.sqlite"
    sweep(numbered(tmp_path, sleep=0.0), functions.logged, table=table, keys=("number",))
    runs(tmp_path)
    changed = numbered(tmp_path, sleep=0.0)
    changed[4]["sleep"] = 1e-3
    sweep(changed, functions.logged, table=table, keys=("number",))
    assert runs(tmp_path) == [4]


def test_a_failed_case_is_kept_with_its_reason_and_run_again_on_resume(tmp_path, functions):
    cases, table = numbered(tmp_path), tmp_path / "t.sqlite"
    (tmp_path / "log.fail").touch()
    found = sweep(cases, functions.fails_while_told, table=table, keys=("number",))
    assert [row["number"] for row in found.failed.rows] == [0, 3, 6]
    reason = found.failed.rows[1]["reason"]
    assert reason.startswith("ZeroDivisionError: no way through 3 (sweep_cases.py:")
    assert found.failed.rows[1]["square"] is None
    assert len(found.done) == 6
    runs(tmp_path)

    kept = sweep(
        cases, functions.fails_while_told, table=table, keys=("number",), retry_failures=False
    )
    assert runs(tmp_path) == []
    assert len(kept.failed) == 3

    (tmp_path / "log.fail").unlink()
    mended = sweep(cases, functions.fails_while_told, table=table, keys=("number",))
    assert runs(tmp_path) == [0, 3, 6]
    assert len(mended.done) == 9


def test_without_resume_all_is_run_and_the_old_table_kept_beside(tmp_path, functions):
    cases, table = numbered(tmp_path), tmp_path / "t.sqlite"
    sweep(cases, functions.logged, table=table, keys=("number",))
    runs(tmp_path)
    sweep(cases[:4], functions.logged, table=table, keys=("number",), resume=False)
    assert runs(tmp_path) == [0, 1, 2, 3]
    assert len(read_table(table)) == 4
    assert len(read_table(tmp_path / "t.sqlite.previous")) == 9


def test_every_row_says_where_it_comes_from(tmp_path, functions):
    row = sweep(WIDTHS, functions.draw, table=tmp_path / "t", keys=("width", "chair"), seed=7).rows[
        0
    ]
    assert row["seed"] == 7
    assert row["wall_s"] >= 0.0
    assert row["cpu_s"] >= 0.0
    assert row["machine"]
    with sqlite3.connect(tmp_path / "t") as connection:
        query = "SELECT DISTINCT json_extract(versions, '$.numpy') FROM cases"
        assert connection.execute(query).fetchall() == [(np.__version__,)]
    connection.close()


def test_values_come_back_as_they_were_and_unstorable_ones_fail_alone(tmp_path, functions):
    cases = [{"name": name} for name in functions.VALUES]
    table = sweep(cases, functions.returns_case_value, table=tmp_path / "t", keys=("name",))
    found = {row["name"]: row for row in table.rows}
    assert math.isnan(found["nan"]["value"])
    assert found["inf"]["value"] == -math.inf
    assert found["float"]["value"] == 0.1 + 0.2
    assert found["int"]["value"] == 2**62
    assert found["true"]["value"] == 1
    assert found["text"]["value"] == 'a "b", c\nü'
    assert found["none"]["value"] is None
    assert found["none"]["status"] == "done"
    assert found["other"]["only_here"] == 1.5
    assert found["other"]["value"] is None
    failed = {row["name"]: row["reason"] for row in table.failed.rows}
    assert set(failed) == {
        "list", "huge", "nothing", "clash", "case_clash", "reserved", "bad_name",
    }  # fmt: skip
    assert "value: a column holds one scalar; found [1, 2]" in failed["list"]
    assert failed["clash"] == "result column 'name' has the name of another column"


def test_sql_leaves_nan_out_of_averages(tmp_path, functions):
    cases = [{"name": name} for name in ("nan", "float", "true")]
    sweep(cases, functions.returns_case_value, table=tmp_path / "t", keys=("name",))
    connection = sqlite3.connect(tmp_path / "t")
    [(mean, count)] = connection.execute("SELECT avg(value), count(value) FROM cases").fetchall()
    connection.close()
    assert count == 2
    assert mean == pytest.approx((1 + 0.3) / 2, rel=1e-12)


def test_numbers_that_are_equal_are_the_same_case(tmp_path, functions):
    table = tmp_path / "t"
    for width in (1, 1.0, np.float64(1.0), np.int32(1)):
        cases = [{"number": width, "log": str(tmp_path / "log")}]
        sweep(cases, functions.logged, table=table, keys=("number",))
    assert len(read_table(table)) == 1


def test_csv_is_sorted_exact_and_the_same_again(tmp_path, functions):
    written = []
    for name, cases in (("a", WIDTHS), ("b", WIDTHS[::-1])):
        table = sweep(cases, functions.draw, table=tmp_path / name, keys=("width", "chair"))
        table.write_csv(tmp_path / f"{name}.csv", with_runs=False)
        written.append((tmp_path / f"{name}.csv").read_bytes())
    assert written[0] == written[1]
    back = read_csv(tmp_path / "a.csv", keys=("width", "chair"))
    assert list(back.column("noise")) == list(table.column("noise"))  # every bit
    assert [(r["width"], r["chair"]) for r in back.rows] == sorted(
        (c["width"], c["chair"]) for c in WIDTHS
    )
    assert {path.name for path in tmp_path.iterdir()} == {"a", "b", "a.csv", "b.csv"}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"keys": ("width",)}, "made with keys 'width, chair', not 'width'"),
        ({"seed": 3}, "made with seed '0', not '3'"),
        ({"version": "2"}, "made with version '1', not '2'"),
        ({"function": "logged"}, "made with function 'draw', not 'logged'"),
    ],
)
def test_a_table_of_another_design_is_refused_and_says_what_to_do(
    tmp_path, functions, change, said
):
    table = tmp_path / "t.sqlite"
    sweep(WIDTHS[::2], functions.draw, table=table, keys=("width", "chair"))
    options = {"keys": ("width", "chair"), **change}
    function = getattr(functions, options.pop("function", "draw"))
    with pytest.raises(StudyError) as refused:
        sweep(WIDTHS[::2], function, table=table, **options)
    assert said in str(refused.value)
    assert "without --resume" in str(refused.value)
    assert "another --out" in str(refused.value)
    assert str(table) in str(refused.value)
    assert len(read_table(table)) == 3


def test_a_file_that_is_no_table_is_refused_and_left_alone(tmp_path, functions):
    for name, bytes_ in (("text", b"not a database at all" * 50), ("other", None)):
        file = tmp_path / name
        if bytes_ is None:
            connection = sqlite3.connect(file)
            connection.execute("CREATE TABLE cats (name)")
            connection.close()
        else:
            file.write_bytes(bytes_)
        before = file.read_bytes()
        with pytest.raises(StudyError, match="another --out"):
            sweep(WIDTHS, functions.draw, table=file, keys=("width", "chair"))
        with pytest.raises(StudyError):
            read_table(file)
        if bytes_:
            assert file.read_bytes() == before


@pytest.mark.parametrize(
    ("cases", "said"),
    [
        ([{"width": 1.0, "chair": "a"}, {"width": 1, "chair": "a"}], "keys of an earlier one"),
        ([{"width": 1.0}], "chair: a case lacks a key column"),
        ([{"width": float("nan"), "chair": "a"}], "width: a key must equal itself"),
        ([{"width": None, "chair": "a"}], "width: a key must equal itself"),
        ([{"width": [1.0], "chair": "a"}], "width: a column holds one scalar"),
        ([{"width": 1.0, "chair": "a", "Status": 1}], "status: the table needs this column"),
        ([{"width": 1.0, "chair": "a", 'x"; DROP': 1}], "must read like a variable's"),
    ],
)
def test_cases_that_cannot_be_told_apart_or_stored_are_refused(tmp_path, functions, cases, said):
    with pytest.raises(StudyError) as refused:
        sweep(cases, functions.draw, table=tmp_path / "t", keys=("width", "chair"))
    assert said in str(refused.value)
    assert not list(tmp_path.iterdir())


def test_a_second_run_on_the_same_table_is_refused_while_the_first_lasts(tmp_path, functions):
    table = tmp_path / "t"

    def again(case, rng):
        with pytest.raises(StudyError, match="being written by another run"):
            sweep(WIDTHS, functions.draw, table=table, keys=("width", "chair"))
        return {"rows": len(read_table(table))}  # reading is never refused

    found = sweep(WIDTHS, again, table=table, keys=("width", "chair"))
    assert [row["rows"] for row in found.rows] == list(range(6))
    assert {path.name for path in tmp_path.iterdir()} == {"t"}


def test_ctrl_c_in_process_leaves_the_finished_rows(tmp_path, functions):
    def interrupted(case, rng):
        if case["width"] == 1.0:
            raise KeyboardInterrupt
        return {"x": 1}

    with pytest.raises(KeyboardInterrupt):
        sweep(WIDTHS, interrupted, table=tmp_path / "t", keys=("width", "chair"))
    assert len(read_table(tmp_path / "t").done) == 4


def test_nothing_to_do_is_an_empty_table(tmp_path, functions):
    assert len(sweep([], functions.draw, table=tmp_path / "t", keys=("width",), jobs=2)) == 0
