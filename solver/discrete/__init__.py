"""From a structure as plain data to a discrete problem."""

from solver.discrete.plane.stack import Given, Side, Spring, Stack, Support
from solver.discrete.problem import Problem
from solver.discrete.rods.rods import End, Rods
from solver.discrete.rope.rope import Rope
from solver.discrete.structure import Structure

__all__ = [
    "End",
    "Given",
    "Problem",
    "Rods",
    "Rope",
    "Side",
    "Spring",
    "Stack",
    "Structure",
    "Support",
]
