"""Perception: from what sensors return to what stands, what is free and what is not known."""
