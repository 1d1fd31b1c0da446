"""Bodies that can move though all contacts are closed and stick."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.arrays import Indices, linked
from solver.discrete.problem import Problem
from solver.laws import Contact
from solver.refusal import RefusedError, Words


class LooseBodiesError(RefusedError):
    """Refused structure: bodies can move though all contacts are closed and stick."""

    @classmethod
    def of(cls, names: Sequence[str]) -> LooseBodiesError:
        """Refusal of a structure with loose bodies of given names."""
        return cls(
            "Bodies.held",
            Words(f"displacements that leave free: {', '.join(names)}"),
            "holds and joints that leave no body free to move or to turn, where all "
            "contacts are closed and stick",
            "hold one more node or axis, or add a joint",
        )


def loose_bodies(problem: Problem) -> Indices:
    """Indices of the bodies that can move though all contacts are closed and stick.

    Shape (n,); empty along rods, and beside a user's law, which may hold what it likes.
    """
    if problem.inside is None or problem.user_laws:
        return np.zeros(0, dtype=np.intp)
    tied = [np.zeros((2, 0), dtype=np.intp)]
    jumps = list[tuple[Indices, Indices]]()
    for law in problem.contacts.laws.values():
        # Two points in contact leave no motion of one body beside the other.
        is_wide = (law.sizes > 1)[law.interface_of_pairs] & law.opens
        for above, below in _pairs_that_hold(problem, law):
            tied.append(np.stack([above[is_wide], below[is_wide]]))
            jumps.append((above[~is_wide], below[~is_wide]))
    bodies = problem.inside.body_of_dofs
    groups = _groups(bodies, np.concatenate(tied, axis=1))
    fixed, _ = problem.prescribed
    free = problem.inside.free_groups(groups, fixed, jumps)
    return np.unique(bodies[np.isin(groups, free)])


def _groups(bodies: Indices, tied: Indices) -> Indices:
    """Group of tied bodies of every degree of freedom, (n_dofs,); -1 with the ground.

    `bodies` are those of the degrees of freedom, (n_dofs,), `tied` pairs of degrees of
    freedom, (2, n_pairs), in which -1 is the ground.
    """
    ground = int(bodies.max()) + 1
    first, second = np.append(bodies, ground)[tied]
    _, groups = linked(first, second, ground + 1)
    group_of_dofs = groups[bodies]
    group_of_dofs[group_of_dofs == groups[ground]] = -1
    return group_of_dofs


def _pairs_that_hold(problem: Problem, law: Contact) -> list[tuple[Indices, Indices]]:
    """Degrees of freedom above and below that a closed, sticking contact ties.

    Shape (n_pairs,) each, by components; -1 is a support. A spring ties one
    component.
    """
    components = law.components
    if law.is_spring:
        components = law.components[:1]
    pairs = list[tuple[Indices, Indices]]()
    for component in components:
        above = problem.row_dofs[component.above]
        below = np.full_like(above, -1)
        if component.below is not None:
            below = problem.row_dofs[component.below]
        pairs.append((above, below))
    return pairs
