"""Nothing that is typed leads out of the folder the page was started in."""

import pytest

from narrows.errors import InputError
from narrows.viewer.page_files import page_file

BAD = [
    "",
    " ",
    ".",
    "..",
    "../up",
    "a/b",
    "a\\b",
    "/etc/passwd",
    "~/x",
    "a\nb",
    "a\0b",
    ".hidden",
    "x" * 200,
    "ünïcode",
    "con:",
    "a.",
]


@pytest.mark.parametrize("name", BAD)
def test_names_that_are_no_plain_names_are_refused(name, tmp_path):
    with pytest.raises(InputError, match="no name for a file"):
        page_file(tmp_path, name, ".yaml")


def test_a_plain_name_stays_in_the_folder(tmp_path):
    assert page_file(tmp_path, " door 1.yaml", ".yaml") == tmp_path / "door 1.yaml"


def test_a_file_that_is_there_is_replaced_only_when_told(tmp_path):
    (tmp_path / "door.yaml").write_text("kept")
    with pytest.raises(InputError, match="there is such a file already"):
        page_file(tmp_path, "door", ".yaml")
    assert page_file(tmp_path, "door", ".yaml", replace=True) == tmp_path / "door.yaml"


def test_a_link_out_of_the_folder_is_not_followed(tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "out.yaml").symlink_to(tmp_path / "elsewhere.yaml")
    with pytest.raises(InputError, match="a link to another place"):
        page_file(folder, "out", ".yaml", replace=True)
