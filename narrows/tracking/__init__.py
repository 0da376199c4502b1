"""Trackers: from a planned motion and the pose believed to be true, a command a period."""
