"""What a tab has under way: the newest counts, the cancelled is heard of no more."""

import pytest

from narrows.viewer.page_guard import Guard
from narrows.viewer.page_report import Told
from narrows.viewer.page_task import Task


class Part:
    """A bar or a button."""

    def __init__(self):
        """Out of sight, nothing done."""
        self.visible = self.animated = False
        self.value = 0.0

    def on_click(self, function):
        self.click = function


class Gui:
    """A page of a bar and a button."""

    def __init__(self):
        """Make both."""
        self.bar, self.button = Part(), Part()

    def add_progress_bar(self, *arguments, **options):
        return self.bar

    def add_button(self, *arguments, **options):
        return self.button


class Runner:
    """Takes down what is started, and answers when told to."""

    def __init__(self):
        """Start empty."""
        self.heard, self.cancelled = [], []

    def start(self, work, *arguments, heard):
        self.heard.append(heard)
        number, cancelled = len(self.heard) - 1, self.cancelled

        class Job:
            def cancel(self):
                cancelled.append(number)

            def tell(self, value):
                heard(Told("progress", value))

        return Job()


@pytest.fixture
def page():
    class Page:
        def __init__(self):
            self.gui, self.runner = Gui(), Runner()
            self.said, self.moved, self.done = [], [], []
            moved, ended = lambda *told: self.moved.append(told), lambda: None
            say = self.said.append
            self.task = Task(self.gui, Guard(), self.runner, say, moved, ended)

        def ask(self):
            self.task.ask("planning", print, (), self.done.append)

    page = Page()
    yield page
    page.task.end()


def test_a_result_ends_the_work(page):
    page.ask()
    assert page.gui.bar.visible
    assert page.gui.button.visible
    page.runner.heard[0](Told("progress", 0.25))
    assert page.gui.bar.value == 25.0
    page.runner.heard[0](Told("result", "a plan"))
    assert page.done == ["a plan"]
    assert not page.gui.bar.visible
    page.runner.heard[0](Told("result", "another"))
    assert page.done == ["a plan"]


def test_a_newer_request_replaces_an_older_one(page):
    page.ask()
    page.ask()
    assert page.runner.cancelled == [0]
    page.runner.heard[0](Told("result", "old"))
    page.runner.heard[1](Told("result", "new"))
    assert page.done == ["new"]


def test_what_was_cancelled_is_heard_of_no_more(page):
    page.ask()
    page.gui.button.click(None)
    assert page.runner.cancelled == [0]
    assert page.said[-1].headline == "cancelled"
    page.runner.heard[0](Told("result", "late"))
    assert page.done == []


def test_work_that_breaks_says_so_and_other_work_says_nothing_of_itself(page):
    page.ask()
    page.runner.heard[0](Told("broken", "exit code 7"))
    assert (page.said[-1].headline, page.said[-1].text) == ("no answer", "exit code 7")
    before = len(page.said)
    page.task.also(print, (), page.done.append)
    page.runner.heard[1](Told("broken", "exit code 7"))
    assert len(page.said) == before
    page.task.also(print, (), page.done.append)
    page.runner.heard[2](Told("result", "a place"))
    assert page.done == ["a place"]


def test_a_chair_on_its_way_is_shown_with_who_is_in_control(page):
    page.ask()
    page.runner.heard[0](Told("progress", {"pose": [1, 2, 3], "time": 0.5, "state": "braking"}))
    assert page.moved == [([1, 2, 3], 0.5, "braking")]
