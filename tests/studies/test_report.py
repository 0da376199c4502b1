"""Claims about the tables in reports."""

import math

import numpy as np
import pytest

from narrows.errors import StudyError
from narrows.studies.report import markdown_table

ROWS = [
    {"chair": "adaag", "spare": 21.4, "tries": np.int64(3), "is_clear": True},
    {"chair": "a|b\nc", "spare": None, "tries": 12, "is_clear": False},
    {"chair": "xeno", "spare": -0.04, "tries": 0},
]


def test_a_table_reads_as_written_here():
    columns = {"chair": "Chair", "spare": "Spare [mm]", "tries": "Tries", "is_clear": "Clear"}
    assert markdown_table(ROWS, columns, {"spare": ".1f"}).splitlines() == [
        "| Chair | Spare [mm] | Tries | Clear |",
        "|---|---:|---:|---|",
        "| adaag | 21.4 | 3 | yes |",
        "| a\\|b c | – | 12 | no |",
        "| xeno | 0.0 | 0 | – |",  # no "-0.0"
    ]


def test_floats_without_a_format_get_four_digits_and_nan_is_shown():
    rows = [{"x": 0.123456}, {"x": math.nan}, {"x": -math.inf}, {"x": np.float64(1e-7)}]
    assert markdown_table(rows, ["x"]).splitlines()[2:] == [
        "| 0.1235 |", "| nan |", "| -inf |", "| 1e-07 |",
    ]  # fmt: skip


def test_no_rows_leave_the_heading():
    assert markdown_table([], ["x"]) == "| x |\n|---|"


@pytest.mark.parametrize(
    ("columns", "formats", "said"),
    [
        ([], {}, "needs columns"),
        (["spare"], {"spar": ".1f"}, "a format for no column; found 'spar'; allowed: spare"),
        (["spare"], {"spare": ".1q"}, "spare: the format does not apply"),
    ],
)
def test_what_cannot_be_a_table_is_refused(columns, formats, said):
    with pytest.raises(StudyError) as refused:
        markdown_table(ROWS, columns, formats)
    assert said in str(refused.value)
