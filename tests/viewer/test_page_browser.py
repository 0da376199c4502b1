"""The page in a real browser, from end to end."""

import re

import numpy as np
import pytest

from narrows.formats import read_trajectory
from narrows.scene import load_scene
from narrows.verification import verify
from narrows.viewer.page_camera import camera

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
    assert tab.button("Play")
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
    before = sorted(served.folder.rglob("*"))
    tab.tab("Save")
    for name in ("../out", "/etc/cron.d/x", "", "x" * 200):
        tab.type("name", "fine")
        tab.answer_with("goes to fine.*")
        tab.type("name", name)
        tab.answer_with("this is no name for a file")
        tab.click("Scene (.yaml)")
        tab.answer_with("this is no name for a file")
    assert sorted(served.folder.rglob("*")) == before
    assert not list(served.folder.parent.glob("out*"))
    assert served.process.poll() is None


def test_the_goal_is_dragged_and_turned_in_the_scene(served, tab):
    tab.open(served.url)
    tab.tab("Scene")
    scene = load_scene("examples/scenes/door.yaml")
    goal = np.append(scene.goal.pose[:2], 0.03)
    middle = np.add(goal, (0.0, 0.25, 0.0))  # of the body, which reaches further ahead than back
    drag(tab, scene, middle, np.add(middle, (0.5, -0.3, 0.0)))
    tab.verdict_with("changed")
    near = [float(tab.fields(label)[1].get_attribute("value")) for label in ("x [m]", "y [m]")]
    np.testing.assert_allclose(near, [2.1, 3.2], atol=0.06)  # a few pixels
    moved = np.add(goal, (0.5, -0.3, 0.0))
    tip = np.add(moved, (0.0, 0.92, 0.0))  # of its arrow
    drag(tab, scene, tip, np.add(moved, (0.9, 0.0, 0.0)))
    tab.until(lambda: abs(float(tab.fields("heading [°]")[1].get_attribute("value"))) < 6, "a turn")


def drag(tab, scene, begin, end):
    """Drag from a point of the world to another, both shape (3,), [m]."""
    from selenium.webdriver.common.action_chains import ActionChains

    canvas = tab.all("canvas")[0]
    size = canvas.size
    aspect = size["width"] / size["height"]
    places = [pixel(camera(scene, aspect), size, point) for point in (begin, end)]
    half = np.array([size["width"], size["height"]]) / 2
    steps = np.linspace(*places, 8) - half
    chain = ActionChains(tab.driver, duration=60)
    chain.move_to_element_with_offset(canvas, *steps[0].round().astype(int).tolist())
    chain.click_and_hold()
    for step in steps[1:]:
        chain.move_to_element_with_offset(canvas, *step.round().astype(int).tolist())
    chain.pause(0.3).release().perform()


def pixel(seen, size, point):
    """Return where a point of the world is in the picture, from its upper left corner."""
    eye, middle = np.array(seen.position), np.array(seen.look_at)
    ahead = (middle - eye) / np.linalg.norm(middle - eye)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    upward, off = np.cross(right, ahead), point - eye
    scale = size["height"] / (2.0 * np.tan(0.5 * seen.fov)) / (off @ ahead)
    return np.array(
        [size["width"] / 2 + scale * off @ right, size["height"] / 2 - scale * off @ upward]
    )


def test_a_drive_is_judged_and_nothing_is_cut_off(served, tab, tmp_path):
    tab.open(served.url)
    tab.click("Drive")
    tab.verdict_with("reached", "mm clear, driven")
    assert "tracking error [mm]" in tab.now
    tab.until(lambda: len(tab.all(".uplot")) == 3, "three plots")
    tab.type("time [s]", "3.4")
    tab.until(lambda: "at 3.40 s" in tab.now, "the chair before the door")
    wide = "return [document.documentElement.scrollWidth, window.innerWidth]"
    box = "const b = arguments[0].getBoundingClientRect(); return [b.left, b.right]"
    for width, height in ((1280, 800), (800, 600)):
        tab.size(width, height)
        tab.until(lambda w=width: tab.driver.execute_script(wide) == [w, w], "the new size")
        for selector in (".narrows-verdict", ".narrows-now", "button", "input", "canvas", ".uplot"):
            for element in tab.all(selector):
                left, right = tab.driver.execute_script(box, element)
                assert left >= 0.0, selector
                assert right <= width + 1, selector
        # Chair and walls cover a good part of what is not the panel, and stay inside it.
        tab.until(lambda w=width: 0.15 < dark_share(tab, tmp_path, w) < 0.9, "the scene")


LAYERED = """
name: a stool and a box beside the way
vehicle: narrow-arcs
world:
  solids:
    - {polygon: [[-0.8, 1.9], [3.6, 1.9], [3.6, 2.0], [-0.8, 2.0]], name: wall}
    - {circle: [1.6, 0.9, 0.2], z: [0, 0.5], name: stool}
    - {polygon: [[0.9, -1.5], [1.5, -1.5], [1.5, -1.0], [0.9, -1.0]], z: [0, 0.6], name: box}
start: {x: 0, y: 0, heading_deg: 0}
goal: {x: 2.4, y: 0, heading_deg: 0, position_tolerance: 0.2, heading_tolerance_deg: 30}
"""


def test_what_the_navigator_knows_and_who_is_in_control_are_shown_and_replayed(
    serving, tab, tmp_path
):
    (tmp_path / "layers.yaml").write_text(LAYERED)
    tab.open(serving("layers.yaml").url)
    tab.choose("who drives", "zone navigator")
    tab.click("Drive")
    tab.verdict_with("mm clear, driven")
    tab.until(lambda: "intrusion" in tab.now and len(tab.all(".uplot")) == 3, "its curves")
    for layer in ("rays", "points", "unknown", "zone"):
        tab.tick(layer)
    tab.type("time [s]", "9")
    tab.until(lambda: "at 9.00 s\nin control: " in tab.now, "who is in control")
    seen(tab, tmp_path / "page-layers.png")
    tab.tab("Save")
    tab.click("Replay (.html)")
    tab.answer_with("written: layers-page.html")
    plays_alone(tab, tmp_path / "layers-page.html")
    (legend,) = tab.all("#narrows-banner")
    assert "in control: " in legend.text
    assert "zone" in legend.text
    assert "shown: rays, points, unknown, zone" in legend.text


def plays_alone(tab, file):
    """See that a replay plays from a file, without network."""
    network = {"latency": 0, "downloadThroughput": -1, "uploadThroughput": -1}
    tab.driver.execute_cdp_cmd("Network.enable", {})
    tab.driver.execute_cdp_cmd("Network.emulateNetworkConditions", {"offline": True, **network})
    tab.driver.get(file.as_uri())
    tab.verdict_with("mm clear")
    clock = "return document.querySelector('input[inputmode=decimal]').value"
    tab.until(lambda: float(tab.driver.execute_script(clock)) > 0.3, "a replay that plays")
    asked = "return performance.getEntriesByType('resource').map(e => e.name)"
    assert not [name for name in tab.driver.execute_script(asked) if name.startswith("http")]
    tab.driver.execute_cdp_cmd("Network.emulateNetworkConditions", {"offline": False, **network})


def dark_share(tab, folder, width):
    """Return how much of the scene is not background."""
    from PIL import Image

    file = folder / f"page-{width}.png"
    seen(tab, file)
    pixels = np.asarray(Image.open(file).convert("RGB"), dtype=int)
    return (pixels[:, : width - 340].sum(axis=2) < 690).mean()


def seen(tab, file):
    """Keep what is seen, without the hint of what the pointer is at."""
    from selenium.webdriver.common.action_chains import ActionChains

    ActionChains(tab.driver).move_to_element(tab.all(".narrows-verdict")[0]).perform()
    tab.until(lambda: not tab.all("[role=tooltip]"), "the end of hints")
    tab.driver.save_screenshot(str(file))
