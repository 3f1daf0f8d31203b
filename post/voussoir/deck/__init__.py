"""Decks from Python: written, built of arches and blocks, read from drawings, and run."""
