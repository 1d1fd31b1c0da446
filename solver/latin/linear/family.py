"""Substructures that share a separated basis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.reduction.basis import ReductionRecord, SeparatedBasis


@dataclass
class Family:
    """One basis and the substructures of a group that use it.

    Attributes
    ----------
    members
        Places of the substructures in their group.
    basis
        Of y = W + F/k; columns run through the members, then through the instants.
    incoming_modes
        W - F/k of every mode, shape (n_boundary, n_modes).
    record
        What the last iteration did.
    """

    members: list[int]
    basis: SeparatedBasis
    incoming_modes: Array
    record: ReductionRecord

    def columns(self, field: Array) -> Array:
        """Take the members of a group field as one matrix, shape (n_boundary, n_columns).

        It is a view of the field if there is one member, otherwise a copy.
        """
        return members_of(field, self.members).reshape(len(field), -1, order="F")

    def time_functions(self, place: int) -> Array:
        """Give one member's time functions, shape (n_modes, n_instants)."""
        return self.basis.time_functions[:, place :: len(self.members)]


def members_of(field: Array, members: list[int]) -> Array:
    """Give the members of a group field, shape (n_boundary, n_members, n_instants).

    It is a view of the field if there is one member, otherwise a copy.
    """
    if len(members) == 1:
        return field[:, members[0] : members[0] + 1]
    return np.asfortranarray(field[:, members])
