"""Tests are the same in every run: drawn examples depend on the test alone, not on the day."""

from hypothesis import settings

settings.register_profile("the same every time", derandomize=True, deadline=None)
settings.load_profile("the same every time")
