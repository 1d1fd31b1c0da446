"""Whether anything acts on a structure at all."""

from __future__ import annotations

from solver.discrete.problem import Problem
from solver.laws import Contact, Dirichlet, Neumann


def nothing_acts(problem: Problem) -> bool:
    """Tell whether all that is given is zero: loads, displacements, overlaps; so is the answer."""
    given = [part.body_force for part in problem.substructures if part.body_force is not None]
    for law in problem.interfaces.values():
        match law:
            case Dirichlet(displacement=values) | Neumann(force=values):
                given.append(values)
            case Contact(gap=gap) if gap.min(initial=0.0) < 0.0:
                return False
    return not any(values.any() for values in given)
