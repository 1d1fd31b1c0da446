"""A bar with laws of one's own: dampers, and contacts with rules of their own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from solver import End, Latin, Problem, Rods, discrete
from solver.arrays import Array, Indices
from solver.latin import Ending, Solution, Stop
from solver.laws import Contact, Friction, Interface, Neumann
from solver.laws.interface import IncrementalForm, Rule
from solver.laws.unilateral import ContactRule

T = np.linspace(0.0, 1.0, 9)
PULL = 1e3 * np.minimum(2.0 * T, 1.0)
STEP = T[1] - T[0]
"""Instants, s; the force over time, N; the distance of instants, s."""
EXACT = Latin(stop=Stop(accuracy=1e-4, tolerance=1e-10, iterations=3000))
"""Method whose stop rules are so tight that the search finds the answer."""


def viscous(rows: Indices, damping: Array, force: Array, k: Array) -> Rule:
    """The local stage of F = F_d - c dW/dt, by backward Euler from rest."""
    stiffness = k[rows]
    per_step = damping / STEP

    def rule(incoming: Array, displacement: Array, _instants: slice) -> None:
        before = np.zeros(len(rows))
        for instant in range(len(T)):
            given = (
                stiffness * incoming[rows, instant]
                + force[:, instant]
                + per_step * before
            )
            before = given / (stiffness + per_step)
            displacement[rows, instant] = before

    return rule


@dataclass(frozen=True)
class Dashpot(Interface):
    """Viscous dampers that are pulled by forces: a law of nothing but its rule."""

    rows: Indices
    damping: Array
    force: Array

    remembers = True

    def rule(self, k: Array, n_instants: int) -> Rule:
        return viscous(self.rows, self.damping, self.force, k)


@dataclass(frozen=True)
class DampedLoad(Neumann):
    """A load beside a damper: a known law whose local stage is another."""

    damping: float = 0.0

    remembers = True

    def rule(self, k: Array, n_instants: int) -> Rule:
        return viscous(self.rows, np.full(len(self.rows), self.damping), self.values, k)


def bar(strength: float | Array = 300.0, force: Array = PULL) -> Problem:
    """A bar that is held at its left end and pulled at the other; SI units."""
    return discrete.discretise(
        Rods(
            length=1.0,
            stiffness=1e6,
            elements=8,
            substructures=2,
            strength=np.full(9, strength),
            left=End(displacement=0.0 * T),
            right=End(force=force),
            instants=T,
            duration=1.0,
        )
    )


def with_law(of: Problem, name: str, law: Interface) -> Problem:
    """A problem with another law at one of its interfaces."""
    return replace(of, interfaces={**of.interfaces, name: law})


def damped(law: type[Interface], damping: float = 2.0) -> Problem:
    """The bar whose end is pulled beside a damper, with one of the two laws of it."""
    of = bar()
    load: Any = of.interfaces["load"]
    if law is Dashpot:
        return with_law(
            of, "load", Dashpot(load.rows, np.array([damping]), load.values)
        )
    assert law is DampedLoad
    return with_law(of, "load", DampedLoad(load.rows, load.values, load.macro, damping))


def is_honest(solution: Solution) -> bool:
    """Check whether a run has ended without claiming a proof."""
    assert not solution.is_certified
    assert "ertified" not in solution.status.advice
    return solution.status.ending in (
        Ending.CONVERGED,
        Ending.EXHAUSTED,
        Ending.STALLED,
    )


class HalfContact(Contact):
    """Contact whose local stage knows half of its friction."""

    def rule(self, k: Array, n_instants: int) -> Rule:
        half = replace(self.tangential, bound=0.5 * self.tangential.bound)
        return ContactRule(self.normal, half, k, n_instants)


class HalfFriction(Friction):
    """Friction that says of itself that it is half as large."""

    def bound_before_slip(
        self, pressing: Array | None, opening: Array | None = None
    ) -> Array:
        return 0.5 * super().bound_before_slip(pressing, opening)


class SameContact(Contact):
    """Contact that is its base's law, and says so."""

    def incremental_form(self) -> IncrementalForm | None:
        return super().incremental_form()


def fields_of(law: object) -> dict[str, Any]:
    return {name: getattr(law, name) for name in law.__dataclass_fields__}  # type: ignore[attr-defined]


def as_contact(kind: type[Contact]) -> Problem:
    of = bar()
    return with_law(of, "friction", kind(**fields_of(of.friction)))
