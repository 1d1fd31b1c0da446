"""A slab of time: a problem at some of its instants, from where its bodies stand before them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.laws import Contact, Interface


def slab_of(problem: Problem, some: slice, start: Mapping[str, Array] | None = None) -> Problem:
    """Give a problem at some instants.

    Parameters
    ----------
    problem
        Of the whole interval.
    some
        Instants that follow each other.
    start
        Where the sliders of every interface with friction stand before the first of them, as
        `Friction.slider` gives it, shape (n_pairs,) each, scaled; None at zero.

    Raises
    ------
    RefusedError
        If a law remembers more than that.
    """
    parts = tuple(
        part if part.body_force is None else replace(part, body_force=part.body_force[:, some])
        for part in problem.substructures
    )
    interfaces = {
        name: _begun(law.during(some), start.get(name) if start else None)
        for name, law in problem.interfaces.items()
    }
    return replace(
        problem,
        substructures=parts,
        interfaces=interfaces,
        instants=problem.instants[some],
        rest=None if problem.rest is None else problem.rest[:, some],
    )


def _begun(law: Interface, start: Array | None) -> Interface:
    return law.begun(start) if isinstance(law, Contact) and start is not None else law
