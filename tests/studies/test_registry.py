"""Claims about finding studies and running one by its name."""

import subprocess
import sys

import pytest

from narrows import studies
from narrows.errors import StudyError

STUDY = '''
"""A study for the tests."""
SUMMARY = "measures nothing, twice"
def run(out, *, jobs, resume, seed, width=0.9):
    (out / "made").touch()
    return f"# Nothing\\n\\n{jobs} {resume} {seed} {width}\\n"
'''


@pytest.fixture
def door_test(tmp_path, monkeypatch):
    """Add a folder with one study, one machine part and one broken study to the package."""
    folder = tmp_path / "more"
    folder.mkdir()
    (folder / "door_test.py").write_text(STUDY)
    (folder / "engine.py").write_text('"""No SUMMARY of its own."""\n')
    (folder / "broken.py").write_text('SUMMARY = "fails when imported"\nraise RuntimeError\n')
    monkeypatch.setattr(studies, "__path__", [*studies.__path__, str(folder)])
    yield
    sys.modules.pop("narrows.studies.door_test", None)


def test_studies_are_found_and_not_imported(door_test):
    assert studies.summaries()["door-test"] == "measures nothing, twice"
    assert "broken" in studies.names()  # importing it would raise
    assert "engine" not in studies.names()
    assert not {"sweep", "store", "table", "registry"} & set(studies.names())
    assert "narrows.studies.door_test" not in sys.modules


def test_a_study_is_run_and_its_report_written(door_test, tmp_path):
    out = tmp_path / "deep" / "out"
    report = studies.run("door-test", out, jobs=2, resume=True, seed=5, width=0.8)
    assert report.text == "# Nothing\n\n2 True 5 0.8\n"
    assert report.file.read_text() == report.text
    assert {path.name for path in out.iterdir()} == {"made", "report.md"}


def test_an_unknown_study_names_the_nearest(door_test, tmp_path):
    with pytest.raises(StudyError, match=r"found 'dor-test'; allowed: door-test\?"):
        studies.run("dor-test", tmp_path)
    with pytest.raises(StudyError, match=r"allowed: .*door-test"):
        studies.run("zzz", tmp_path)


def test_wrong_options_are_refused_before_anything_is_made(door_test, tmp_path):
    out = tmp_path / "out"
    with pytest.raises(StudyError, match="no such option; found 'widht'; allowed: width"):
        studies.run("door-test", out, widht=1.0)
    with pytest.raises(StudyError, match=r"jobs: .*allowed: >= 1"):
        studies.run("door-test", out, jobs=0)
    assert not out.exists()


def test_a_folder_that_cannot_be_made_is_refused(door_test, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(StudyError, match="the folder cannot be used"):
        studies.run("door-test", tmp_path / "file")


def test_listing_the_studies_imports_nothing_heavy():
    code = (
        "import sys, narrows; before = {*sys.modules}\n"
        "from narrows import studies; studies.names(); added = {*sys.modules} - before\n"
        "print({'casadi', 'tqdm', 'scipy', 'numpy', 'matplotlib', 'multiprocessing'} & added)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
