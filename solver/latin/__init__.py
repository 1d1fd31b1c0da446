"""The multiscale LATIN method: its parts, its iterates, and the driver of a run."""

from solver.latin.anderson import Anderson
from solver.latin.direction.directions import Auto, Paper
from solver.latin.end.certified import Answer
from solver.latin.end.status import Decision, Ending, Status
from solver.latin.end.status_step import StatusStep
from solver.latin.end.stop import Stop
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.iteration import iterations
from solver.latin.method import Latin
from solver.latin.slabs import solve_in_slabs
from solver.latin.solve import Record, Solution, judged, record, solve
from solver.latin.stages.linear import Full
from solver.latin.stages.pgd import PGD
from solver.latin.start import Nested
from solver.latin.stop_rules import StopState

__all__ = [
    "PGD",
    "Anderson",
    "Answer",
    "Auto",
    "Checkpoint",
    "Decision",
    "Ending",
    "Full",
    "Iterate",
    "Latin",
    "Nested",
    "Paper",
    "Record",
    "Solution",
    "Status",
    "StatusStep",
    "Stop",
    "StopState",
    "iterations",
    "judged",
    "record",
    "solve",
    "solve_in_slabs",
]
