"""Jobs beside the page: answered, refused, broken, cancelled, told; the next is none the worse."""

import os
import queue
import time
from types import MappingProxyType

import pytest

from narrows.errors import InputError
from narrows.viewer.page_jobs import JobRunner

pytestmark = pytest.mark.slow
PATIENCE = 30.0  # s


def doubled(report, value):
    report(0.5)
    return 2 * value


def refused(report):
    raise InputError("no", field="width", value=-1)


def broken(report):
    os._exit(7)


def endless(report):
    report("begun")
    while True:
        time.sleep(0.01)


def beating(report, file):
    with file.open("w") as beats:
        while True:
            beats.write(".")
            beats.flush()
            report("begun")
            time.sleep(0.01)


def echo(report):
    while report.latest() is None:
        time.sleep(0.001)
    return MappingProxyType({"heard": report.latest()})


@pytest.fixture(scope="module")
def runner():
    runner = JobRunner()
    yield runner
    runner.close()


@pytest.fixture
def told():
    return queue.Queue()


def test_a_job_reports_and_answers(runner, told):
    runner.start(doubled, 21, heard=told.put)
    kinds = [told.get(timeout=PATIENCE) for _ in range(2)]
    assert [(one.kind, one.value) for one in kinds] == [("progress", 0.5), ("result", 42)]


def test_wrong_input_is_told_in_words(runner, told):
    runner.start(refused, heard=told.put)
    answer = told.get(timeout=PATIENCE)
    assert (answer.kind, answer.value) == ("refused", "width: no; found -1")


def test_a_process_that_dies_is_told_and_the_next_works(runner, told):
    runner.start(broken, heard=told.put)
    answer = told.get(timeout=PATIENCE)
    assert answer.kind == "broken"
    assert "exit code 7" in answer.value
    runner.start(doubled, 1, heard=told.put)
    assert told.get(timeout=PATIENCE).kind == "progress"


def test_a_cancelled_job_is_heard_of_no_more(runner, told):
    job = runner.start(endless, heard=told.put)
    assert told.get(timeout=PATIENCE).value == "begun"
    job.cancel()
    job.cancel()  # twice does no harm
    later = queue.Queue()
    runner.start(doubled, 1, heard=later.put)
    assert later.get(timeout=PATIENCE).kind == "progress"
    assert told.empty()


def test_a_job_can_be_told_something_while_it_runs(runner, told):
    job = runner.start(echo, heard=told.put)
    job.tell((0.5, -0.25))
    assert told.get(timeout=PATIENCE).value == {"heard": (0.5, -0.25)}


def test_a_closed_runner_says_that_it_is():
    runner = JobRunner()
    runner.close()
    answers = []
    runner.start(doubled, 1, heard=answers.append).cancel()
    assert answers[0].kind == "broken"


def test_closing_ends_what_never_ends_by_itself(told, tmp_path):
    runner, file = JobRunner(), tmp_path / "beats"
    runner.start(beating, file, heard=told.put)
    assert told.get(timeout=PATIENCE).kind == "progress"
    runner.close()
    end, before = time.monotonic() + PATIENCE, -1
    while file.stat().st_size != before and time.monotonic() < end:
        before = file.stat().st_size
        time.sleep(0.1)
    assert file.stat().st_size == before
