"""The multiscale LATIN method: parts to put one together, its iterates, and a driver to an end."""

from solver.latin.acceleration.anderson import Anderson
from solver.latin.criteria.converged import Accuracy, Indicator
from solver.latin.criteria.criterion import Criterion
from solver.latin.criteria.limits import Iterations, Seconds
from solver.latin.criteria.status import Ending, Status
from solver.latin.direction.rules import Auto, Paper
from solver.latin.direction.update import FromStatus
from solver.latin.finish.status_step import StatusStep
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.iterations import iterations
from solver.latin.linear.parts import PGD, Full
from solver.latin.method import Latin
from solver.latin.slabs import solve_in_slabs
from solver.latin.solve import Record, Solution, judged, record, solve
from solver.latin.start.nested import Nested
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
    "Seconds",
    "Solution",
    "Status",
    "StatusStep",
    "StopRules",
    "iterations",
    "judged",
    "record",
    "solve",
    "solve_in_slabs",
]
