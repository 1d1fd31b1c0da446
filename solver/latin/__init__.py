"""The multiscale LATIN method: parts to put one together, its iterates, and a driver to an end."""

from solver.latin.acceleration import Anderson
from solver.latin.criteria import Accuracy, Indicator, Iterations, Seconds
from solver.latin.criterion import Criterion
from solver.latin.direction import Auto, Paper
from solver.latin.direction_update import FromStatus
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.iterations import iterations
from solver.latin.method import Latin
from solver.latin.nested import Nested
from solver.latin.solve import Record, Solution, judged, record, solve
from solver.latin.stages import PGD, Full, References
from solver.latin.status import Ending, Status
from solver.latin.status_step import StatusStep
from solver.latin.stop import Decision, StopRules

__all__ = [
    "PGD",
    "Accuracy",
    "Anderson",
    "Auto",
    "Checkpoint",
    "Criterion",
    "Decision",
    "Ending",
    "FromStatus",
    "Full",
    "Indicator",
    "Iterate",
    "Iterations",
    "Latin",
    "Nested",
    "Paper",
    "Record",
    "References",
    "Seconds",
    "Solution",
    "Status",
    "StatusStep",
    "StopRules",
    "iterations",
    "judged",
    "record",
    "solve",
]
