"""Scenes whose answers are known: validation, stability, and error against run time."""
