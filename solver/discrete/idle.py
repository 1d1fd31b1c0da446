"""Whether anything acts on a structure at all."""

from __future__ import annotations

from solver.discrete.problem import Problem


def nothing_acts(problem: Problem) -> bool:
    """Whether all that is given is zero: loads, displacements, overlaps; so is the answer."""
    if any(law.acts for law in problem.interfaces.values()):
        return False
    forces = (part.body_force for part in problem.substructures if part.body_force is not None)
    return not any(force.any() for force in forces)
