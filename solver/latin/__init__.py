"""The multiscale LATIN method: a generator of iterates, and a driver with stop rules."""

from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.iterations import iterations
from solver.latin.solve import Record, Solution, judged, record, solve
from solver.latin.stop import Ending, Status, StopRules, Verdict

__all__ = [
    "Checkpoint",
    "Ending",
    "Iterate",
    "Record",
    "Solution",
    "Status",
    "StopRules",
    "Verdict",
    "iterations",
    "judged",
    "record",
    "solve",
]
