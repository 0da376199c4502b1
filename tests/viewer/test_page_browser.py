"""The page in a real browser, from end to end."""

import re
import time

import numpy as np
import pytest

from narrows.formats import read_trajectory
from narrows.scene import load_scene
from narrows.verification import verify

pytestmark = pytest.mark.slow


def seconds(text):
    return float(re.search(r"at ([0-9.]+) s", text)[1])


def test_a_chair_is_changed_planned_narrowed_played_saved_and_found_again(served, tab):
    tab.open(served.url)
    tab.tab("Chair")
    tab.type("width [m]", "0.7")
    tab.verdict_with("changed", "nothing is proven any more")
    tab.click("Plan")
    assert re.search(r"certified\n\d+ mm clear, proven", tab.verdict_with("certified"))

    tab.tab("Scene")
    tab.type("door width [m]", "0.66")
    tab.verdict_with("changed")
    tab.click("Plan")
    tab.verdict_with("impassable", "40 mm missing")  # 0.70 - 0.66

    tab.type("door width [m]", "0.9")
    tab.verdict_with("changed")
    tab.click("Plan")
    tab.verdict_with("certified", "mm clear")

    tab.tab("Drive")
    tab.click("Play")
    tab.until(lambda: seconds(tab.now) > 0.5, "half a second of the motion")
    tab.click("Pause")
    tab.type("time [s]", "4.25")
    tab.until(lambda: "at 4.25 s" in tab.now, "the time typed")

    tab.tab("Save")
    for kind, ending in (("Scene", "yaml"), ("Trajectory", "csv"), ("Replay", "html")):
        tab.click(f"{kind} (.{ending})")
        tab.answer_with(f"written: door-page.{ending}")

    scene = load_scene(served.folder / "door-page.yaml")
    assert scene.vehicle.width == pytest.approx(0.7, abs=1e-9)
    assert verify(scene, read_trajectory(served.folder / "door-page.csv")).is_certified

    tab.open(served.url)  # a reload starts from the scene that was given
    tab.verdict_with("not planned yet")
    tab.tab("Chair")
    assert tab.field("width [m]").get_attribute("value") == "0.67"


def test_the_replay_plays_from_a_file_without_network(served, tab):
    tab.open(served.url)
    tab.click("Plan")
    tab.verdict_with("certified")
    tab.tab("Save")
    tab.type("name", "alone")
    tab.click("Replay (.html)")
    tab.answer_with("written: alone.html")
    tab.driver.execute_cdp_cmd("Network.enable", {})
    offline = {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0}
    tab.driver.execute_cdp_cmd("Network.emulateNetworkConditions", offline)
    tab.driver.get((served.folder / "alone.html").as_uri())
    tab.verdict_with("certified", "mm clear")
    clock = "return document.querySelector('input[inputmode=decimal]').value"
    tab.until(lambda: float(tab.driver.execute_script(clock)) > 0.3, "a replay that plays")
    asked = "return performance.getEntriesByType('resource').map(e => e.name)"
    assert not [name for name in tab.driver.execute_script(asked) if name.startswith("http")]


def test_a_drive_is_judged_and_its_error_plotted(served, tab):
    tab.open(served.url)
    tab.click("Drive")
    tab.verdict_with("reached", "mm clear, driven")
    assert "tracking error [mm]" in tab.now
    tab.until(lambda: len(tab.all(".uplot")) == 3, "three plots")


def test_two_pages_keep_their_own_state(served, tab):
    first = tab.driver.current_window_handle
    tab.open(served.url)
    tab.tab("Chair")
    tab.type("width [m]", "0.8")
    tab.verdict_with("changed")
    tab.driver.switch_to.new_window("tab")
    tab.open(served.url)
    tab.click("Plan")
    tab.verdict_with("certified")
    tab.tab("Chair")
    assert tab.field("width [m]").get_attribute("value") == "0.67"
    tab.driver.close()
    tab.driver.switch_to.window(first)
    tab.verdict_with("changed")
    assert tab.field("width [m]").get_attribute("value") == "0.8"


def test_what_makes_no_sense_is_answered_in_place_and_the_server_lives(served, tab):
    tab.open(served.url)
    tab.tab("Chair")
    tab.type("width [m]", "9")
    tab.answer_with("width: found 9; allowed: 0.2 to 2 m")
    tab.click("Plan")
    tab.verdict_with("the scene cannot be used", "Mend that first")
    tab.type("width [m]", "0.67")
    tab.verdict_with("changed")
    tab.tab("Scene")
    tab.until(lambda: tab.field("margin [m]").is_displayed(), "the scene's fields")
    tab.type("corridor width [m]", "0.9")
    tab.answer_with("the chair at the start overlaps", "mm")
    tab.tab("Save")
    for name in ("../out", "/etc/cron.d/x", "a/b", "", "..", "x" * 200, "con\u0000"):
        tab.type("name", name)
        tab.click("Scene (.yaml)")
        tab.answer_with("this is no name for a file") if name else None
    assert sorted(file.name for file in served.folder.parent.rglob("*.yaml")) == sorted(
        file.name for file in served.folder.glob("*.yaml")
    )
    assert served.process.poll() is None


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (800, 600)])
def test_nothing_is_cut_off(served, tab, width, height, tmp_path):
    tab.size(width, height)
    tab.open(served.url)
    tab.click("Plan")
    tab.verdict_with("certified")
    wide = "return document.documentElement.scrollWidth"
    assert tab.driver.execute_script(wide) <= width
    box = "const b = arguments[0].getBoundingClientRect(); return [b.left, b.right]"
    for selector in (".narrows-verdict", ".narrows-now", "button", "input", "canvas", ".uplot"):
        for element in tab.all(selector):
            left, right = tab.driver.execute_script(box, element)
            assert left >= 0.0, selector
            assert right <= width + 1, selector
    # The chair and the walls cover a good part of what is not the panel.
    time.sleep(0.5)  # one frame drawn by the processor
    tab.driver.save_screenshot(str(tmp_path / "page.png"))
    from PIL import Image

    pixels = np.asarray(Image.open(tmp_path / "page.png").convert("RGB"), dtype=int)
    scene = pixels[:, : width - 340]
    assert (scene.sum(axis=2) < 690).mean() > 0.2
