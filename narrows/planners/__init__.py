"""Planners: from a scene to a certified trajectory."""
