"""Reasons why the incremental solvers cannot solve a problem.

They read the incremental forms of all laws, one degree of freedom where rows are glued,
and the mean of the pairs of a point: they would leave out anything else.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Indices, linked
from solver.discrete.contacts import Contacts
from solver.laws import Contact, Interface, SlipFactor
from solver.laws.interface import IncrementalForm
from solver.laws.play import PLAIN

_BY_ESTIMATE = "judge the run by its estimate alone"
_OF_ONES_OWN = f"define its incremental_form, or {_BY_ESTIMATE}"


def reason_against_reference(
    interfaces: Mapping[str, Interface],
    contacts: Contacts,
    dofs: Indices,
    parts: Indices,
) -> str:
    """Reason why a problem has no incremental reference, with a remedy, or "".

    `dofs` and `parts` are the degree of freedom, and the substructure, of every
    boundary row, (n_rows,).
    """
    forms = list[IncrementalForm]()
    for name, law in interfaces.items():
        form = law.incremental_form()
        if form is None:
            return (
                f'The law {type(law).__name__} of the interface "{name}" does not say '
                "how it enters the incremental problem, so that there is no reference: "
                f"{_OF_ONES_OWN}."
            )
        if form.contact is not None and form.contact is not law:
            return (
                f'The interface "{name}" enters as a contact that it is not: '
                f"{_OF_ONES_OWN}."
            )
        forms.append(form)
    if not contacts:
        return (
            "No interface is one of contact, so that there is nothing to solve "
            f"instant by instant: add a contact, or {_BY_ESTIMATE}."
        )
    cuts = [form.glued for form in forms if form.glued is not None]
    sides = np.concatenate([np.zeros((2, 0), dtype=np.intp), *cuts], axis=1)
    if not _are_glued_as_numbered(sides, dofs, parts):
        return (
            "Rows of one degree of freedom are not glued, or glued rows have two, "
            "so that no matrix of the whole structure says what holds: number them "
            f"alike, or {_BY_ESTIMATE}."
        )
    for name, contact in contacts.laws.items():
        if not _has_points(contact, dofs):
            return (
                f'Pairs of one point of the interface "{name}" differ in their '
                "degrees of freedom, gap or friction: give each a point of its "
                f"own, or {_BY_ESTIMATE}."
            )
    if len(_slip_factors(contacts)) > 1:
        return (
            "Slip changes friction otherwise on one interface than on another: "
            f"give all of them the same slip factor, or {_BY_ESTIMATE}."
        )
    return ""


def _are_glued_as_numbered(sides: Indices, dofs: Indices, parts: Indices) -> bool:
    """Check whether rows share a degree of freedom exactly if a law glues them.

    `sides` are the glued rows of both sides, (2, n_glued), `dofs` and `parts` those of
    all rows, (n_rows,).
    """
    n_dofs = int(dofs.max(initial=0)) + 1
    # All rows of one substructure at one degree of freedom are one node.
    keys = parts * n_dofs + dofs
    nodes, node_of_row = np.unique(keys, return_inverse=True)
    first, second = node_of_row[sides]
    n_glued, glued = linked(first, second, len(nodes))
    # Each group of glued nodes has one degree of freedom, and no other group has it.
    of_nodes = nodes % n_dofs
    n_pairs = len(np.unique(glued * n_dofs + of_nodes))
    return bool(n_pairs == n_glued == len(np.unique(of_nodes)))


def _has_points(law: Contact, dofs: Indices) -> bool:
    """Check whether all pairs of a point have equal degrees of freedom, gap and mu.

    `dofs` are the degrees of freedom of all rows, (n_rows,).
    """
    if len(law.points) == len(law.positions):
        return True
    fields: list[NDArray[Any]] = [law.tangential.friction]
    for component in law.components:
        fields.extend([dofs[rows] for rows in component.sides])
    if law.normal is not None:
        fields.append(law.normal.gap)
    _, first = np.unique(law.points, return_index=True)
    same = first[law.points]
    return all(np.array_equal(field, field[same]) for field in fields)


def _slip_factors(contacts: Contacts) -> set[SlipFactor]:
    """Slip-dependent factors of all interfaces with friction."""
    laws = [law.tangential for law in contacts.laws.values()]
    return {law.slip_factor or PLAIN for law in laws if law.has_friction}
