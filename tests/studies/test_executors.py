"""Claims about worker processes, tried on real ones with real signals."""

import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import time
from collections import deque
from pathlib import Path

import pytest

from narrows.errors import StudyError
from narrows.studies.case import Task
from narrows.studies.executors import LocalProcesses, assign
from narrows.studies.store import read_table
from narrows.studies.sweep import sweep
from narrows.studies.worker import Worker, prepare_workers

SCRIPT = """
import sys
sys.path.insert(0, {here!r})
from pathlib import Path
import sweep_cases
from narrows.studies.sweep import sweep

if __name__ == "__main__":
    folder = Path({folder!r})
    log = str(folder / "log")
    cases = [{{"number": n, "log": log, "sleep": 0.05}} for n in range({count})]
    cases[{long}]["sleep"] = {long_s}
    sweep(cases, sweep_cases.logged, table=folder / "t", keys=("number",), jobs=2)
"""
COUNT = 60
LONG = 12  # takes longer, so that it can be caught running


def numbers(count):
    return [{"number": n} for n in range(count)]


def living(session):
    """Processes of a session that still run (a zombie does not)."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except OSError:  # it ended meanwhile
            continue
        if int(fields[3]) == session and fields[0] != "Z":
            found.append(int(stat.parent.name))
    return found


def wait_until(condition, seconds=300.0):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return False


def start(folder, long_s):
    """Start a sweep of COUNT cases with two workers in a session of its own."""
    script = SCRIPT.format(
        here=str(Path(__file__).parent), folder=str(folder), count=COUNT, long=LONG, long_s=long_s
    )
    file = folder / "script.py"
    file.write_text(script)
    return subprocess.Popen(
        [sys.executable, str(file)], start_new_session=True, stderr=subprocess.PIPE
    )


def logged_runs(folder):
    log = folder / "log"
    return [int(line.split()[0]) for line in log.read_text().splitlines()] if log.exists() else []


def test_a_worker_that_dies_costs_exactly_its_case(tmp_path, functions):
    found = sweep(
        numbers(40), functions.kills_itself, table=tmp_path / "t", keys=("number",), jobs=2
    )
    assert [row["number"] for row in found.failed.rows] == list(range(1, 40, 2))
    assert {row["reason"] for row in found.failed.rows} == {"worker killed (SIGKILL)"}
    assert [row["square"] for row in found.done.rows] == [n**2 for n in range(0, 40, 2)]


def test_a_worker_that_leaves_is_told_from_one_that_is_killed(tmp_path, functions):
    found = sweep(numbers(2), functions.leaves, table=tmp_path / "t", keys=("number",), jobs=2)
    assert {row["reason"] for row in found.rows} == {"worker ended by itself (exit code 3)"}


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_case_out_of_time_is_stopped_and_the_others_are_done(tmp_path, functions, jobs):
    found = sweep(
        numbers(5),
        functions.hangs,
        table=tmp_path / "t",
        keys=("number",),
        jobs=jobs,
        timeout_s=2.0,
    )
    [late] = found.failed.rows
    assert late["number"] == 1
    assert late["reason"] == "timed out after 2 s"
    assert late["wall_s"] >= 2.0
    assert late["cpu_s"] is None
    assert len(found.done) == 4


def test_a_function_that_cannot_be_sent_is_refused_before_anything_runs(tmp_path):
    with pytest.raises(StudyError, match="top level of a module, or jobs=1"):
        sweep(numbers(2), lambda case, rng: {}, table=tmp_path / "t", keys=("number",), jobs=2)


def test_a_function_that_workers_cannot_import_is_refused(tmp_path, functions, monkeypatch):
    monkeypatch.setattr(sys, "path", [p for p in sys.path if p != str(Path(__file__).parent)])
    with pytest.raises(StudyError, match="cannot load the study's function: ModuleNotFoundError"):
        sweep(numbers(2), functions.hangs, table=tmp_path / "t", keys=("number",), jobs=2)


def test_a_script_without_a_guarded_entry_is_told_so(tmp_path):
    script = tmp_path / "unguarded.py"
    script.write_text(
        "from pathlib import Path\n"
        "from narrows.studies.sweep import sweep\n"
        "def f(case, rng): return {}\n"
        f"table = Path({str(tmp_path / 't')!r})\n"
        "sweep([{'a': 1}, {'a': 2}], f, table=table, keys=('a',), jobs=2)\n"
    )
    command = [sys.executable, str(script)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == 1
    assert "ended before it could start" in done.stderr


def test_a_worker_that_dies_idle_takes_no_case_with_it(functions):
    prepare_workers(functions.hangs)
    worker = Worker(pickle.dumps(Task(functions.hangs, ("number",), 0)))
    assert worker.connection.poll(20.0)
    assert worker.receive() is None
    assert worker.is_idle
    os.kill(worker.pid, signal.SIGKILL)
    assert worker.connection.poll(20.0)  # the end of its pipe
    waiting = deque([0, 1])
    assign(worker, waiting, numbers(2))
    assert worker.is_stopped
    assert list(waiting) == [0, 1]


def test_closing_the_outcomes_early_stops_the_workers(functions):
    task = Task(functions.hangs, ("number",), 0)
    outcomes = LocalProcesses(jobs=2).outcomes(task, numbers(3))
    next(outcomes)
    assert len(multiprocessing.active_children()) == 2
    outcomes.close()
    assert not multiprocessing.active_children()


@pytest.mark.slow
def test_a_worker_killed_from_outside_costs_exactly_its_case(tmp_path):
    sweeping = start(tmp_path, long_s=10.0)
    assert wait_until(lambda: LONG in logged_runs(tmp_path))
    runs = [line.split() for line in (tmp_path / "log").read_text().splitlines()]
    [worker] = [int(worker) for number, worker in runs if int(number) == LONG]
    os.kill(worker, signal.SIGKILL)
    _, errors = sweeping.communicate(timeout=600)
    assert sweeping.returncode == 0, errors
    found = read_table(tmp_path / "t")
    assert [(row["number"], row["reason"]) for row in found.failed.rows] == [
        (LONG, "worker killed (SIGKILL)")
    ]
    assert len(found.done) == COUNT - 1
    assert sorted(logged_runs(tmp_path)) == list(range(COUNT))  # nothing ran twice


@pytest.mark.slow
@pytest.mark.parametrize("how", ["kill the parent", "interrupt the group"])
def test_a_stopped_sweep_keeps_its_rows_leaves_no_process_and_resumes(tmp_path, how):
    sweeping = start(tmp_path, long_s=60.0)
    assert wait_until(lambda: len(logged_runs(tmp_path)) >= 20)
    if how == "kill the parent":
        os.kill(sweeping.pid, signal.SIGKILL)
    else:
        os.killpg(sweeping.pid, signal.SIGINT)
    _, errors = sweeping.communicate(timeout=600)
    if how == "interrupt the group":
        assert errors.decode().rstrip().endswith("KeyboardInterrupt")
        assert errors.count(b"Traceback") == 1  # the parent's; the workers leave quietly
    assert sweeping.returncode == {"k": -signal.SIGKILL, "i": -signal.SIGINT}[how[0]]
    assert wait_until(lambda: not living(sweeping.pid)), living(sweeping.pid)

    kept = {row["number"] for row in read_table(tmp_path / "t").done.rows}
    begun = set(logged_runs(tmp_path))
    assert kept <= begun
    assert len(begun - kept) <= 4  # two running, and two that ended while the parent was stopped
    assert len(kept) < COUNT
    (tmp_path / "log").unlink()

    again = start(tmp_path, long_s=0.05)
    _, errors = again.communicate(timeout=600)
    assert again.returncode == 0, errors
    assert sorted(logged_runs(tmp_path)) == sorted(set(range(COUNT)) - kept)
    found = read_table(tmp_path / "t")
    assert list(found.column("square")) == [n**2 for n in range(COUNT)]
    assert len(found.done) == COUNT
