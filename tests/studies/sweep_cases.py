"""Case functions for the tests of the sweep, in a module that worker processes can import."""

import os
import signal
import time
from pathlib import Path


def draw(case, rng):
    return {"x": case["width"] * 2, "noise": rng.normal(), "steps": int(rng.integers(100))}


def log_run(case):
    """Append a line for this run; one write of one short line is atomic."""
    with Path(case["log"]).open("a") as log:
        log.write(f"{case['number']} {os.getpid()}\n")


def logged(case, rng):
    log_run(case)
    time.sleep(case.get("sleep", 0.0))
    return {"square": case["number"] ** 2, "noise": rng.normal()}


def fails_while_told(case, rng):
    log_run(case)
    if case["number"] % 3 == 0 and Path(case["log"] + ".fail").exists():
        raise ZeroDivisionError(f"no way\nthrough {case['number']}")
    return {"square": case["number"] ** 2}


def kills_itself(case, rng):
    if case["number"] % 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return {"square": case["number"] ** 2}


def leaves(case, rng):
    os._exit(3)


def hangs(case, rng):
    while case["number"] == 1:  # deaf to everything but SIGKILL
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        time.sleep(0.05)
    return {"square": case["number"] ** 2}


def returns_case_value(case, rng):
    return VALUES[case["name"]]


VALUES = {
    "nan": {"value": float("nan")},
    "inf": {"value": -float("inf")},
    "float": {"value": 0.1 + 0.2},
    "int": {"value": 2**62},
    "true": {"value": True},
    "none": {"value": None},
    "text": {"value": 'a "b", c\nü'},
    "other": {"only_here": 1.5},
    "list": {"value": [1, 2]},
    "huge": {"value": 2**70},
    "nothing": None,
    "clash": {"name": "x"},
    "case_clash": {"VALUE": 1},
    "reserved": {"status": 1},
    "bad_name": {"max speed": 1},
}
