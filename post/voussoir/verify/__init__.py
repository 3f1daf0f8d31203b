"""Proofs of a folder of results, recomputed with nothing of the program that made them.

A deck and its files (`deck`, `blocks`, `lines`) say what is there, corners say where blocks touch (`contacts`), and
from both follow loads and laws (`loads`, `fill`, `water`). Forces and velocities are checked against them (`proofs`,
`tables`), limits in fractions (`exact`).
"""
