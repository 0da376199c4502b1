"""A page served as the command line serves it, and a real browser without a window."""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PATIENCE = 60.0  # s: a loaded machine that renders without a graphics card
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
)


def found(*names):
    return next((path for path in map(shutil.which, names) if path), None)


class Tab:
    """A browser tab with a page, by the words that a person reads."""

    def __init__(self, driver):
        """Drive the tab that is in front."""
        self.driver = driver

    def until(self, condition, what):
        """Wait for a condition; an element that is just being replaced counts as not yet."""
        from selenium.common.exceptions import WebDriverException

        end, seen = time.monotonic() + PATIENCE, None
        while time.monotonic() < end:
            try:
                seen = condition()
            except WebDriverException as error:
                seen = error.msg
            else:
                if seen:
                    return seen
            time.sleep(0.02)
        shown = f"verdict: {self.verdict}; answers: {self.answers}"
        raise AssertionError(f"{what} did not come; seen last: {seen}; {shown}")

    def open(self, url):
        self.driver.get(url)
        self.until(lambda: self.verdict, "the page")
        for button in self.all(".mantine-Notification-closeButton"):
            button.click()  # "software rendering"

    def all(self, selector):
        from selenium.webdriver.common.by import By

        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def one(self, xpath):
        from selenium.webdriver.common.by import By

        return self.driver.find_element(By.XPATH, xpath)

    def size(self, width, height):
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)

    @property
    def verdict(self):
        return " | ".join(element.text for element in self.all(".narrows-verdict"))

    @property
    def answers(self):
        return " | ".join(element.text for element in self.all(".narrows-answer"))

    @property
    def now(self):
        return " ".join(element.text for element in self.all(".narrows-now"))

    def verdict_with(self, *words):
        self.until(lambda: all(word in self.verdict for word in words), f"a verdict with {words}")
        return self.verdict

    def answer_with(self, *words):
        self.until(lambda: all(word in self.answers for word in words), f"an answer with {words}")

    def button(self, text):
        path = f"//button[not(@role='tab')][normalize-space()='{text}']"
        return self.until(lambda: self.one(path), f"a button {text!r}")

    def click(self, text):
        self.until(lambda: self.button(text).click() or True, f"a button {text!r}")

    def tab(self, text):
        path = f"//*[@role='tab'][normalize-space()='{text}']"
        self.until(lambda: self.one(path).click() or True, f"a tab {text!r}")

    def field(self, label):
        near = "ancestor::*[.//input][1]//input[not(@type='hidden')]"
        path = f"//label[normalize-space()='{label}']/{near}"
        return self.until(lambda: self.one(path), f"a field {label!r}")

    def fields(self, label):
        """Return all fields of a label that are seen, from the top."""
        from selenium.webdriver.common.by import By

        near = "ancestor::*[.//input][1]//input[not(@type='hidden')]"
        path = f"//label[normalize-space()='{label}']/{near}"
        found = self.driver.find_elements(By.XPATH, path)
        return [field for field in found if field.is_displayed()]

    def choose(self, label, option):
        self.field(label).click()

        def choice():
            shown = [part for part in self.all("[role=option]") if part.text == option]
            return shown[0].click() or True

        self.until(choice, f"an option {option!r}")

    def tick(self, label):
        """Tick a box, if it is not."""

        def is_ticked():
            return self.field(label).is_selected() or self.field(label).click()

        self.until(is_ticked, f"a box {label!r}")

    def type(self, label, text):
        from selenium.webdriver.common.keys import Keys

        field = self.field(label)
        field.send_keys(Keys.CONTROL, "a")
        field.send_keys(text or Keys.DELETE)
        self.driver.execute_script("arguments[0].blur()", field)


@dataclass
class Served:
    """A page that is being served.

    Attributes:
        url: Where.
        folder: The folder it was started in.
        process: The command.
        begun: When the command was given [s].
    """

    url: str
    folder: Path
    process: subprocess.Popen
    begun: float


def serve(folder, *arguments):
    begun = time.monotonic()
    command = [sys.executable, "-m", "narrows.cli", "view", "--no-open", "--port", "0", *arguments]
    process = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    line = process.stdout.readline()
    url = re.search(r"http://\S+", line)
    assert url, line + process.stdout.read()
    return Served(url[0], Path(folder), process, begun)


def end(served):
    served.process.send_signal(signal.SIGINT)
    return served.process.wait(15)


@pytest.fixture(scope="session")
def driver(tmp_path_factory):
    """Return a browser, or skip with the reason."""
    chromium = found("chromium", "chromium-browser", "google-chrome")
    chromedriver = found("chromedriver")
    if not (chromium and chromedriver):
        pytest.skip(
            "no Chromium with its ChromeDriver on this machine: apt-get install chromium-driver"
        )
    selenium = pytest.importorskip("selenium", reason="selenium is not installed (extra dev)")
    assert selenium
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service

    options = Options()
    profile = tmp_path_factory.mktemp("profile")
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.binary_location = chromium
    service = Service(chromedriver, log_output=subprocess.DEVNULL, env=dict(os.environ))
    browser = webdriver.Chrome(options=options, service=service)
    yield browser
    browser.quit()


@pytest.fixture
def tab(driver):
    """Return a tab of its own, 1280 x 800."""
    driver.switch_to.new_window("window")
    window = driver.current_window_handle
    tab = Tab(driver)
    tab.size(1280, 800)
    yield tab
    driver.switch_to.window(window)
    driver.close()
    driver.switch_to.window(driver.window_handles[0])


def kept(folder, *scene, quiet=True):
    """Serve a page while a test uses it, and see that it ended well, without a word if quiet."""
    pytest.importorskip("viser", reason="viser is not installed (extra view)")
    served = serve(folder, *scene)
    yield served
    assert end(served) == 0
    with served.process.stdout as told:
        assert not quiet or told.read() == "ended\n"


@pytest.fixture(scope="module")
def harassed(tmp_path_factory):
    """Return a page for strangers, who may make it complain in its terminal."""
    yield from kept(tmp_path_factory.mktemp("harassed"), quiet=False)


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """Return the default page, served from a folder of its own for all tests of a file."""
    yield from kept(tmp_path_factory.mktemp("page"))


@pytest.fixture
def serving(tmp_path):
    """Return what serves a page anew, each time it is called: of a scene file, or the default."""
    with contextlib.ExitStack() as stack:
        pages = contextlib.contextmanager(kept)
        yield lambda *scene: stack.enter_context(pages(tmp_path, *scene))
