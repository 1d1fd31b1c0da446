"""The multiscale LATIN method: parts to put one together, its iterates, and a driver to an end."""

from solver.latin.acceleration.anderson import Anderson
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
from solver.latin.status import Ending, Status
from solver.latin.stop import Decision, Stop, StopState

__all__ = [
    "PGD",
    "Anderson",
    "Auto",
    "Checkpoint",
    "Decision",
    "Ending",
    "FromStatus",
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
