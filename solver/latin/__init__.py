"""The multiscale LATIN method: a generator of iterates, and a driver with stop rules."""

from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.iterations import iterations
from solver.latin.solve import Ending, Record, Solution, Status, StopRules, record, solve

__all__ = [
    "Checkpoint",
    "Ending",
    "Iterate",
    "Record",
    "Solution",
    "Status",
    "StopRules",
    "iterations",
    "record",
    "solve",
]
