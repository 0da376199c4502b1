"""Planners: from a scene to a certified trajectory, or why there is none."""

from .ladder import RUNGS, plan

__all__ = ["RUNGS", "plan"]
