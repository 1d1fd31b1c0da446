"""A law without an incremental form: LATIN solves it, and claims no proof.

References here are dense time stepping that reads nothing of the engine but the
stiffness.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from user_laws import (
    EXACT,
    PULL,
    STEP,
    DampedLoad,
    Dashpot,
    HalfContact,
    T,
    as_contact,
    bar,
    damped,
    is_honest,
    with_law,
)

from solver import Latin, Problem, solve
from solver.arrays import Array, Indices
from solver.latin import PGD, Ending, Stop, solve_in_slabs
from solver.laws import Component, Contact, Interface
from solver.laws.interface import Rule
from solver.reference.assembly import assembled_stiffness
from solver.reference.incremental import reference_of
from solver.refusal import RefusedError


def stepped(of: Problem, load: Array, damping: Array, bound: Array) -> Array:
    """Dense time stepping, node by node to rest, (n_dofs, n_instants), scaled.

    The increment minimises an energy with a term |v| at each node, held at the first of
    them.
    """
    matrix = assembled_stiffness(of).toarray() + np.diag(damping / STEP)
    elastic = matrix - np.diag(damping / STEP)
    moved = np.zeros(len(matrix))
    found = []
    for force in load.T:
        pull = force - elastic @ moved
        step = np.zeros_like(moved)
        for _ in range(3000):
            before = step.copy()
            for node in range(1, len(step)):
                left = (
                    pull[node] - matrix[node] @ step + matrix[node, node] * step[node]
                )
                rest = max(abs(left) - bound[node], 0.0)
                step[node] = np.copysign(rest, left) / matrix[node, node]
            if np.abs(step - before).max() <= 1e-16:
                break
        moved = moved + step
        found.append(moved)
    return np.stack(found, axis=1)


def exact_of_damped(damping: float = 2.0) -> Array:
    of = bar()
    law = of.friction
    units = of.scales
    bound = law.by_point(law.tangential.bound)[:, 0]
    load = np.zeros((9, len(T)))
    dampers = np.zeros(9)
    load[-1] = PULL / units.force
    dampers[-1] = damping
    return stepped(of, load, dampers, bound) * units.displacement


@pytest.mark.parametrize("law", [Dashpot, DampedLoad])
@pytest.mark.parametrize("damping", [0.2, 2.0, 50.0])
def test_a_damper_is_solved_and_ends_by_estimate(
    law: type[Interface], damping: float
) -> None:
    of = damped(law, damping)
    solution = solve(of, EXACT, watch=False)
    assert is_honest(solution)
    assert solution.status.ending is Ending.CONVERGED
    assert law.__name__ in solution.status.advice
    expected = exact_of_damped(damping)
    shown = solution.iterate.displacement
    assert shown == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize("damping", [0.2, 2.0, 50.0])
def test_an_estimate_is_no_smaller_than_the_error(damping: float) -> None:
    """For friction and for the damper's force, at the default accuracy."""
    of = damped(Dashpot, damping)
    rough = solve(of, watch=False).iterate
    exact = solve(of, EXACT, watch=False).iterate
    law: Any = of.interfaces["load"]
    for rows in (of.friction.tangent.above, law.rows):
        found = rough.boundary_force[rows]
        expected = exact.boundary_force[rows]
        assert np.linalg.norm(found - expected) <= 0.01 * np.linalg.norm(expected)


def test_a_support_of_dampers_alone_needs_no_contact() -> None:
    """Dampers all along: (K + C/dt) u = F + C/dt u of the instant before."""
    of = bar()
    friction = of.friction
    units = of.scales
    damping = 3.0 * friction.weights
    force = np.zeros((len(damping), len(T)))
    law = Dashpot(friction.tangent.above, damping, force)
    solution = solve(with_law(of, "friction", law), EXACT, watch=False)
    assert solution.status.ending is Ending.CONVERGED
    assert is_honest(solution)
    dampers = friction.by_point(damping)
    load = np.zeros((9, len(T)))
    load[-1] = PULL / units.force
    expected = stepped(of, load, dampers, np.zeros(9)) * units.displacement
    shown = solution.iterate.displacement
    assert shown == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())


def test_a_contact_with_a_local_stage_of_its_own_is_solved_as_that() -> None:
    solution = solve(as_contact(HalfContact), EXACT, watch=False)
    assert is_honest(solution)
    assert solution.status.ending is Ending.CONVERGED
    expected = reference_of(bar(strength=150.0)).displacement
    shown = solution.iterate.displacement
    assert shown == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())


def test_two_contacts_of_one_kind_keep_their_own_local_stages() -> None:
    """Points of one class are solved together, those of another are not among them."""
    of = bar()
    whole = of.friction
    rows = whole.tangent.above
    left = np.flatnonzero(whole.points < 5)
    right = np.flatnonzero(whole.points >= 5)

    def part(kind: type[Contact], own: Indices) -> Contact:
        points = whole.points[own] - whole.points[own].min()
        along = replace(
            whole.tangential,
            component=Component(rows[own]),
            bound=whole.tangential.bound[own],
            friction=whole.tangential.friction[own],
        )
        return kind(
            tangential=along,
            points=points,
            positions=whole.positions[np.unique(whole.points[own])],
            weights=whole.weights[own],
        )

    others = {name: law for name, law in of.interfaces.items() if name != "friction"}
    halved = replace(
        of,
        interfaces={**others, "a": part(Contact, left), "b": part(HalfContact, right)},
    )
    solution = solve(halved, EXACT, watch=False)
    assert is_honest(solution)
    bound = np.where(np.arange(9) < 5, 300.0, 150.0)
    expected = reference_of(bar(bound)).displacement
    shown = solution.iterate.displacement
    assert shown == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())


def test_bases_that_nothing_can_prove_do_not_converge() -> None:
    """A run that has converged on a few modes need not be near the answer."""
    method = Latin(
        linear=PGD(modes=2), stop=Stop(accuracy=0.01, tolerance=1e-3, iterations=40)
    )
    solution = solve(damped(Dashpot), method, watch=False)
    assert is_honest(solution)
    assert solution.status.ending is not Ending.CONVERGED
    assert "Dashpot" in solution.status.advice
    assert "linear to Full()" in solution.status.advice


@pytest.mark.parametrize("law", [Dashpot, DampedLoad])
def test_slabs_of_time_refuse_what_remembers_more_than_sliders(
    law: type[Interface],
) -> None:
    with pytest.raises(RefusedError, match="load"):
        solve_in_slabs(damped(law), Latin(), 4)


@dataclass(frozen=True)
class Elastic(Interface):
    """Springs to the ground, which say nothing of some instants alone."""

    rows: Indices

    def rule(self, k: Array, n_instants: int) -> Rule:
        def pull(incoming: Array, displacement: Array, _instants: slice) -> None:
            displacement[self.rows] = 0.5 * incoming[self.rows]

        return pull


def test_slabs_of_time_refuse_a_law_that_does_not_say_what_it_is_in_them() -> None:
    of = with_law(bar(), "load", Elastic(bar().interfaces["load"].rows))
    with pytest.raises(RefusedError, match=r"Elastic\.during"):
        solve_in_slabs(of, Latin(), 4)
