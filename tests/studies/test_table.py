"""Claims about tables in memory, in CSV and in half-written files."""

import math

import numpy as np
import pytest

from narrows.errors import InputError, StudyError
from narrows.studies.table import Table, read_csv

TABLE = Table(
    ("width", "chair"),
    ("width", "chair", "spare", "note", "status", "reason"),
    (
        {"width": 0.9, "chair": "b", "spare": 1e-17, "note": None, "status": "done", "reason": ""},
        {"width": 10, "chair": "a", "spare": None, "note": 3, "status": "failed", "reason": "x,y"},
        {
            "width": 0.9,
            "chair": "a",
            "spare": math.inf,
            "note": "t",
            "status": "done",
            "reason": "",
        },
    ),
)


def test_rows_are_sorted_by_the_value_of_the_keys_not_their_text():
    assert [(row["width"], row["chair"]) for row in TABLE.rows] == [
        (0.9, "a"), (0.9, "b"), (10, "a"),
    ]  # fmt: skip


def test_columns_are_arrays_with_nan_where_a_row_has_nothing():
    np.testing.assert_array_equal(TABLE.column("spare"), [math.inf, 1e-17, math.nan])
    assert TABLE.column("note").tolist() == ["t", None, 3]
    assert TABLE.done.column("width").tolist() == [0.9, 0.9]
    assert len(TABLE.where(chair="a", width=10)) == 1


def test_an_unknown_column_names_the_nearest():
    for ask in (TABLE.column, lambda name: TABLE.where(**{name: 1})):
        with pytest.raises(StudyError, match=r"found 'spar'; allowed: spare\?"):
            ask("spar")


def test_csv_reads_back_exactly(tmp_path):
    TABLE.write_csv(tmp_path / "t.csv")
    back = read_csv(tmp_path / "t.csv", ("width", "chair"))
    assert back.columns == TABLE.columns
    expected = [{**row, "reason": row["reason"] or None} for row in TABLE.rows]
    assert list(back.rows) == expected


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "lacks key columns"),
        (b"a,b\n1,2\n", "1: the table lacks key columns"),
        (b"width,chair\n1\n", "2: the row has 1 cells, the header 2"),
        (b"width,chair\n\xff,1\n", "cannot be read"),
        (None, "cannot be read"),
    ],
)
def test_csv_that_is_no_table_is_refused_with_its_place(tmp_path, content, said):
    file = tmp_path / "t.csv"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(StudyError) as refused:
        read_csv(file, ("width", "chair"))
    assert said in str(refused.value)
    assert str(file) in str(refused.value)


def test_a_csv_that_cannot_be_written_says_where_and_leaves_nothing(tmp_path):
    (tmp_path / "t.csv").mkdir()
    with pytest.raises(InputError, match=r"t\.csv: the file cannot be written"):
        TABLE.write_csv(tmp_path / "t.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["t.csv"]
