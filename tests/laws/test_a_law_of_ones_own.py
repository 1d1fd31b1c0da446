"""A law without an incremental form: LATIN solves it, and claims no proof.

References here are dense time stepping that reads nothing of the engine but the
stiffness.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from contact_problems import friction_of, on_a_support, problem, stiffness, substructure
from small_scenes import SMALL

from solver import End, Latin, Problem, Rods, discrete, solve
from solver.arrays import Array, Indices
from solver.discrete.problem import nothing_acts
from solver.latin import PGD, Ending, Solution, Stop, solve_in_slabs
from solver.latin.end.cost import run_cost
from solver.latin.stages.sliding_body import slide_of
from solver.laws import (
    Component,
    Contact,
    Friction,
    Interface,
    Neumann,
    Perfect,
    SlipFactor,
)
from solver.laws.interface import IncrementalForm, Rule
from solver.laws.unilateral import ContactRule
from solver.reference.assembly import NoReferenceError, assembled_stiffness
from solver.reference.distance import kkt_residual
from solver.reference.incremental import reference_of
from solver.reference.shakedown import shakedown_limit
from solver.reference.solution import fingerprint
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise

T = np.linspace(0.0, 1.0, 9)
PULL = 1e3 * np.minimum(2.0 * T, 1.0)
STEP = T[1] - T[0]
EXACT = Latin(stop=Stop(accuracy=1e-4, tolerance=1e-10, iterations=3000))


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
    """Viscous dampers that are pulled by forces:
    a law that consists of its local stage.
    """

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
    return replace(of, interfaces={**of.interfaces, name: law})


def damped(law: type[Interface], damping: float = 2.0, **rest: Any) -> Problem:
    of = bar()
    load: Any = of.interfaces["load"]
    if law is Dashpot:
        return with_law(
            of, "load", Dashpot(load.rows, np.array([damping]), load.values)
        )
    assert law is DampedLoad
    return with_law(of, "load", DampedLoad(load.rows, load.values, load.macro, damping))


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


def is_honest(solution: Solution) -> bool:
    """Check whether a run has ended without claiming a proof."""
    assert not solution.is_certified
    assert "ertified" not in solution.status.advice
    return solution.status.ending in (
        Ending.CONVERGED,
        Ending.EXHAUSTED,
        Ending.STALLED,
    )


@pytest.mark.parametrize("law", [Dashpot, DampedLoad])
@pytest.mark.parametrize("damping", [0.2, 2.0, 50.0])
def test_a_damper_is_solved_and_ends_by_estimate(
    law: type[Interface], damping: float
) -> None:
    of = damped(law, damping)
    solution = solve(of, EXACT)
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
    rough = solve(of).iterate
    exact = solve(of, EXACT).iterate
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
    solution = solve(with_law(of, "friction", law), EXACT)
    assert solution.status.ending is Ending.CONVERGED
    assert is_honest(solution)
    dampers = friction.by_point(damping)
    load = np.zeros((9, len(T)))
    load[-1] = PULL / units.force
    expected = stepped(of, load, dampers, np.zeros(9)) * units.displacement
    shown = solution.iterate.displacement
    assert shown == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())


class HalfContact(Contact):
    """Contact whose local stage knows half of its friction."""

    def rule(self, k: Array, n_instants: int) -> Rule:
        half = replace(self.tangential, bound=0.5 * self.tangential.bound)
        return ContactRule(self.normal, half, k, n_instants)


class HalfFriction(Friction):
    """Friction that says of itself that it is half as large."""

    def without_slip(
        self, pressing: Array | None, opening: Array | None = None
    ) -> Array:
        return 0.5 * super().without_slip(pressing, opening)


class SameContact(Contact):
    """Contact that is its base's law, and says so."""

    def incremental_form(self) -> IncrementalForm | None:
        return super().incremental_form()


def fields_of(law: object) -> dict[str, Any]:
    return {name: getattr(law, name) for name in law.__dataclass_fields__}  # type: ignore[attr-defined]


def as_contact(kind: type[Contact]) -> Problem:
    of = bar()
    return with_law(of, "friction", kind(**fields_of(of.friction)))


def test_a_contact_with_a_local_stage_of_its_own_is_solved_as_that() -> None:
    solution = solve(as_contact(HalfContact), EXACT)
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
    solution = solve(halved, EXACT)
    assert is_honest(solution)
    bound = np.where(np.arange(9) < 5, 300.0, 150.0)
    expected = reference_of(bar(bound)).displacement
    shown = solution.iterate.displacement
    assert shown == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())


def test_a_subclass_that_says_its_form_is_certified() -> None:
    solution = solve(as_contact(SameContact))
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
    name, law = next(iter(made.rubbing.items()))
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
def test_what_no_incremental_solver_reads_has_neither_reference_nor_certificate(
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
    solution = solve(of, Latin(stop=Stop(accuracy=0.01, tolerance=1e-3, iterations=60)))
    assert is_honest(solution)
    assert solution.iterate.friction_force.shape[1] == of.n_instants
    assert run_cost(of, Latin(), 100, with_reference=True).reference == 0.0


def test_bases_that_nothing_can_prove_do_not_converge() -> None:
    """A run that has converged on a few modes need not be near the answer."""
    method = Latin(
        linear=PGD(modes=2), stop=Stop(accuracy=0.01, tolerance=1e-3, iterations=40)
    )
    solution = solve(damped(Dashpot), method)
    assert is_honest(solution)
    assert solution.status.ending is not Ending.CONVERGED
    assert "Dashpot" in solution.status.advice
    assert "linear to Full()" in solution.status.advice


def test_a_residual_of_fields_is_not_claimed_where_a_law_is_not_read() -> None:
    of = damped(Dashpot)
    with pytest.raises(NoReferenceError, match="Dashpot"):
        kkt_residual(solve(of).iterate, of)


def test_something_may_act_where_a_law_is_not_known() -> None:
    still = bar(force=0.0 * T)
    assert nothing_acts(still)
    load: Any = still.interfaces["load"]
    law = Dashpot(load.rows, np.ones(1), load.values)
    assert not nothing_acts(with_law(still, "load", law))


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


@pytest.mark.parametrize("scene", CATALOGUE)
def test_of_every_scene_incremental_solvers_read_all(scene: str) -> None:
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
    searched = solve(of, replace(EXACT, finish=None)).iterate.displacement
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
    solution = solve(without_contact(), Latin(stop=stop))
    expected = np.outer(np.linspace(0.0, 1.0, 9), PULL) / 1e6
    shown = solution.iterate.displacement
    assert solution.status.ending is Ending.CONVERGED
    assert np.linalg.norm(shown - expected) <= 0.01 * np.linalg.norm(expected)


def test_random_contacts_are_read_in_full() -> None:
    assert on_a_support(np.random.default_rng(3), 4, 0.3).no_reference == ""
