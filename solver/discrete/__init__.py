"""From a structure as plain data to a discrete problem."""

from __future__ import annotations

from functools import singledispatch

from solver.discrete.plane import bodies_problem
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body import Body, Held, Load, NodeSpring
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.lattice import Lattice
from solver.discrete.plane.makers.band import Band
from solver.discrete.plane.meshes import Mesh
from solver.discrete.plane.rectangles import stack_problem
from solver.discrete.plane.rectangles.sides import Side, SideComponent, Spring, Support
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.problem import Problem
from solver.discrete.rods import cut_rods
from solver.discrete.rods.end import End
from solver.discrete.rods.rods import Rods
from solver.discrete.rope import cut_rope
from solver.discrete.rope.rope import Rope
from solver.discrete.structure import Structure
from solver.refusal import RefusedError, Words

__all__ = [
    "Beam",
    "Bodies",
    "Body",
    "End",
    "Held",
    "Joint",
    "Lattice",
    "Load",
    "Mesh",
    "NodeSpring",
    "Problem",
    "Rods",
    "Rope",
    "Side",
    "SideComponent",
    "Spring",
    "Stack",
    "Structure",
    "Support",
    "discretise",
]


@singledispatch
def discretise(structure: Structure) -> Problem:
    """Make the discrete problem of a structure.

    Data of a structure does not know its mesher; a structure of a user is added by
    `discretise.register`.

    Raises
    ------
    RefusedError
        For a structure without a mesher, or one that its mesher refuses.
    """
    raise RefusedError(
        "structure",
        Words(f"of type {type(structure).__name__}"),
        "Bodies, Rods, Rope, Stack, or a type whose mesher is registered",
        "register a function that makes its problem by discretise.register",
    )


discretise.register(Rods, cut_rods.problem_of)
discretise.register(Rope, cut_rope.problem_of)
discretise.register(Stack, stack_problem.problem_of)
discretise.register(Bodies, bodies_problem.problem_of)
discretise.register(Band, bodies_problem.problem_of_band)
