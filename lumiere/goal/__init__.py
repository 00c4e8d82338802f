"""Rendering to a goal: until the picture's error, as it can be told from the picture's own samples, is small enough (docs/goal.md)."""
