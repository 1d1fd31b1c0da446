"""Laws that incremental solvers read in full, or else refuse with the reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from contact_problems import friction_of, on_a_support, problem, stiffness, substructure
from small_scenes import SMALL
from user_laws import (
    EXACT,
    PULL,
    DampedLoad,
    Dashpot,
    HalfContact,
    HalfFriction,
    SameContact,
    T,
    as_contact,
    bar,
    damped,
    fields_of,
    is_honest,
    with_law,
)

from solver import Latin, Problem, solve
from solver.arrays import Indices
from solver.discrete.problem import is_unloaded
from solver.latin import Ending, Stop
from solver.latin.run_cost import run_cost
from solver.latin.stages.sliding_body import slide_of
from solver.laws import Component, Contact, Neumann, Perfect, SlipFactor
from solver.reference.assembly import NoReferenceError
from solver.reference.distance import kkt_residual
from solver.reference.incremental import reference_of
from solver.reference.shakedown import shakedown_limit
from solver.reference.solution import fingerprint
from solver.scenes import CATALOGUE, discretise


def test_a_subclass_with_an_incremental_form_is_certified() -> None:
    solution = solve(as_contact(SameContact), watch=False)
    assert solution.is_certified
    expected = reference_of(bar()).displacement
    shown = solution.iterate.displacement
    assert shown == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())


def own_friction() -> Problem:
    of = bar()
    half = HalfFriction(**fields_of(of.friction.tangential))
    return with_law(of, "friction", replace(of.friction, tangential=half))


def two_slip_factors() -> Problem:
    of = CATALOGUE["strand"].checked({"elements": 8, "instants": 5, "wires": 3})
    made = discretise(of)
    name, law = next(iter(made.contacts.items()))
    along = replace(law.tangential, slip_factor=SlipFactor((0.0, 1.0), (1.0, 0.5)))
    return with_law(made, name, replace(law, tangential=along))


def glued_apart() -> Problem:
    """Two bodies that are glued, of degrees of freedom of their own."""
    random = np.random.default_rng(1)
    parts = [
        substructure(
            stiffness(random, 2), (2 * one, 2 * one), random.normal(size=(2, 5))
        )
        for one in range(2)
    ]
    law = support_of(np.array([0, 2]))
    glue = Perfect(np.array([1]), np.array([3]), np.eye(1))
    return problem(parts, {"support": law, "glue": glue}, 5)


def support_of(rows: Indices, bound: float = 0.3) -> Contact:
    along = np.arange(len(rows))
    return Contact(
        tangential=friction_of(Component(rows), bound=bound),
        points=along,
        positions=1.0 * along,
        weights=np.ones(len(rows)),
    )


def uneven_pairs() -> Problem:
    """Two pairs of one point whose degrees of freedom differ."""
    random = np.random.default_rng(2)
    part = substructure(stiffness(random, 2), (0, 0), random.normal(size=(2, 5)))
    law = replace(
        support_of(np.arange(2)), points=np.zeros(2, int), positions=np.zeros(1)
    )
    return problem([part], {"support": law}, 5)


def without_contact() -> Problem:
    of = bar()
    law = of.friction
    free = Neumann(
        law.rows, np.zeros((len(law.rows), len(T))), np.zeros((len(law.rows), 0))
    )
    return with_law(of, "friction", free)


UNREAD: dict[str, tuple[Callable[[], Problem], str]] = {
    "a law of one's own": (lambda: damped(Dashpot), 'Dashpot of the interface "load"'),
    "a load with a damper": (lambda: damped(DampedLoad), "DampedLoad"),
    "a contact with a local stage": (lambda: as_contact(HalfContact), "HalfContact"),
    "a friction of its own": (own_friction, 'Contact of the interface "friction"'),
    "two slip factors": (two_slip_factors, "slip factor"),
    "glue between two numbers": (glued_apart, "glued"),
    "pairs that differ": (uneven_pairs, 'interface "support"'),
    "no contact": (without_contact, "contact"),
}


@pytest.mark.parametrize("case", UNREAD)
def test_laws_without_incremental_form_have_neither_reference_nor_certificate(
    case: str,
) -> None:
    make, words = UNREAD[case]
    of = make()
    for judge in (
        reference_of,
        fingerprint,
        lambda some: shakedown_limit(some, slice(None)),
    ):
        with pytest.raises(NoReferenceError, match=words) as refused:
            judge(of)
        assert "judge the run by its estimate" in str(refused.value)
    solution = solve(
        of, Latin(stop=Stop(accuracy=0.01, tolerance=1e-3, iterations=60)), watch=False
    )
    assert is_honest(solution)
    assert solution.iterate.friction_force.shape[1] == of.n_instants
    assert run_cost(of, Latin(), with_reference=True).reference == 0.0


def test_a_residual_of_fields_is_not_claimed_where_a_law_is_not_read() -> None:
    of = damped(Dashpot)
    with pytest.raises(NoReferenceError, match="Dashpot"):
        kkt_residual(solve(of, watch=False).iterate, of)


def test_a_structure_with_an_unknown_law_is_not_unloaded() -> None:
    still = bar(force=0.0 * T)
    assert is_unloaded(still)
    load: Any = still.interfaces["load"]
    law = Dashpot(load.rows, np.ones(1), load.values)
    assert not is_unloaded(with_law(still, "load", law))


@pytest.mark.parametrize("scene", CATALOGUE)
def test_incremental_solvers_read_all_laws_of_every_scene(scene: str) -> None:
    assert discretise(CATALOGUE[scene].checked(SMALL[scene])).no_reference == ""


def test_friction_beside_a_full_matrix_is_no_rod() -> None:
    """The solver of rods would read two diagonals of it alone."""
    random = np.random.default_rng(5)
    size = 5
    part = substructure(stiffness(random, size), (0, 0), random.normal(size=(size, 7)))
    of = problem([part], {"support": support_of(np.arange(size))}, 7)
    reference = reference_of(of)
    assert reference.converged.all()
    assert kkt_residual(reference, of) < 1e-9


def test_a_cap_on_friction_of_known_bound_is_kept_by_both() -> None:
    of = bar()
    law = of.friction
    cap = 0.5 * law.tangential.bound[:, 0]
    capped = replace(law, tangential=replace(law.tangential, cap=cap))
    expected = reference_of(bar(strength=150.0)).displacement
    of = with_law(of, "friction", capped)
    size = 1e-6 * np.abs(expected).max()
    assert reference_of(of).displacement == pytest.approx(expected, abs=size)
    searched = solve(of, replace(EXACT, finish=None), watch=False).iterate.displacement
    assert searched == pytest.approx(expected, abs=1e3 * size)


def test_a_body_that_slides_as_a_whole_is_not_shifted_where_something_else_pulls() -> (
    None
):
    settings = CATALOGUE["incline"].checked(
        {"elements": 8, "elements_up": 4, "instants": 9}
    )
    of = discretise(settings)
    k = np.ones(of.n_rows)
    assert slide_of(of, k) is not None
    spring: Any = of.interfaces["spring"]
    law = HalfContact(**fields_of(spring))
    assert slide_of(with_law(of, "spring", law), k) is None


@pytest.mark.parametrize(
    "stop", [Stop(accuracy=0.01), Stop(accuracy=0.01, tolerance=1e-3)]
)
def test_without_contact_an_estimate_is_no_smaller_than_the_error(stop: Stop) -> None:
    """All that acts is a force at the end: u = F x / ES."""
    solution = solve(without_contact(), Latin(stop=stop), watch=False)
    expected = np.outer(np.linspace(0.0, 1.0, 9), PULL) / 1e6
    shown = solution.iterate.displacement
    assert solution.status.ending is Ending.CONVERGED
    assert np.linalg.norm(shown - expected) <= 0.01 * np.linalg.norm(expected)


def test_random_contacts_are_read_in_full() -> None:
    assert on_a_support(np.random.default_rng(3), 4, 0.3).no_reference == ""
