"""Consistency of a problem: rows, names, instants and displacements that fit together.

Each check refuses what does not fit by a `RefusedError`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from solver.arrays import Indices
from solver.checks import ALIKE
from solver.discrete.contacts import Contacts
from solver.discrete.substructure import Substructure
from solver.laws import Interface
from solver.laws.interface import PrescribedRows
from solver.refusal import RefusedError, Words


def check_cover(
    owners: str, what: str, count: int, parts: list[Indices], *, once: bool = False
) -> None:
    """Refuse parts that do not cover all indices from 0 to `count` - 1.

    With `once`, refuse numbers that occur more than once, too.
    """
    numbers = np.concatenate([np.zeros(0, dtype=np.intp), *parts])
    smallest = int(numbers.min(initial=0))
    if smallest < 0:
        raise RefusedError(
            f"Problem.{owners}",
            Words(f"{what} {smallest}"),
            f"each {what} from 0 on",
            "number them anew",
        )
    largest = int(numbers.max(initial=-1))
    times = np.bincount(numbers, minlength=count)
    if once:
        wrong = times != 1
    else:
        wrong = times == 0
    if largest < count and not wrong.any():
        return
    if largest >= count:
        number = largest
    else:
        number = int(np.argmax(wrong))
    how_often = "at least once"
    if once:
        how_often = "once"
    allowed = f"each {what} from 0 to {count - 1} {how_often}"
    shown = Words(f"{what} {number}, {times[number]} times")
    raise RefusedError(f"Problem.{owners}", shown, allowed, "number them anew")


def check_names(contacts: Contacts) -> None:
    """Refuse names of several interfaces, and an order that omits an interface."""
    names = contacts.names_of_laws
    if len(set(names)) < len(names) or sorted(contacts.names) != sorted(names):
        raise RefusedError(
            "Problem.order",
            Words(f"of {len(contacts.names)} names"),
            f"all {len(names)} interfaces with friction once",
            "give each a name of its own, and all of them a place",
        )


def check_instants(
    n_instants: int,
    interfaces: Mapping[str, Interface],
    substructures: Sequence[Substructure],
) -> None:
    """Refuse laws and body forces with values for another number of instants."""
    for name, law in interfaces.items():
        if law.n_instants not in (None, n_instants):
            raise _other_instants(f"interfaces[{name!r}]", law.n_instants, n_instants)
    for number, part in enumerate(substructures):
        if part.body_force is not None and part.body_force.shape[1] != n_instants:
            where = f"substructures[{number}].body_force"
            raise _other_instants(where, part.body_force.shape[1], n_instants)


def _other_instants(where: str, count: int | None, n_instants: int) -> RefusedError:
    """Refusal of values for another number of instants."""
    return RefusedError(
        f"Problem.{where}",
        Words(f"of {count} instants"),
        f"as many as Problem.instants has, {n_instants}",
        "give one value an instant",
    )


def check_prescribed(given: Sequence[PrescribedRows], row_dofs: Indices) -> None:
    """Refuse displacements that differ at one degree of freedom.

    `row_dofs` are the degrees of freedom under all rows, shape (n_rows,).
    """
    if len(given) < 2:
        return
    dofs = np.concatenate([row_dofs[each.rows] for each in given])
    values = np.concatenate([each.values for each in given])
    _, first, inverse = np.unique(dofs, return_index=True, return_inverse=True)
    differences = np.abs(values - values[first][inverse])
    largest = float(np.abs(values).max(initial=0.0))
    if float(differences.max(initial=0.0)) > ALIKE * largest:
        number = int(differences.max(axis=1).argmax())
        raise RefusedError(
            "Problem.interfaces",
            Words(f"two displacements of degree of freedom {dofs[number]}"),
            "one displacement of each",
            "prescribe it once, or both alike",
        )
