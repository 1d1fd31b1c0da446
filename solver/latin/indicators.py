"""The k-free indicator: how far fields violate the laws (MATHEMATICS.md, 4)."""

from __future__ import annotations

import numpy as np

from solver.arrays import ROUNDING, Array
from solver.discrete.contact_groups import ContactGroup
from solver.discrete.problem import Problem
from solver.laws.contact import Violation
from solver.laws.interface import beyond, squared

SMALL_CONTACT = 1e3
"""Ratio of the largest force to a contact force up to which the contact force counts as
being as large."""
STILL = 1e-6
"""Share of the displacement of one element under the largest force, up to which a
structure counts as not moving."""


def violation_of(problem: Problem, displacement: Array, force: Array) -> float:
    """Violation of the laws by W and F, independent of k (MATHEMATICS.md, 4).

    Friction with bound q and slip increment v violates its law by q|v| + F v with F cut
    to |F| <= q, which is nowhere negative and zero exactly where Coulomb's law holds,
    and by the excess of |F| over q times the mean slip. In unilateral contact q = mu N
    with the pressing force N, and the violation with the opening g is also N g where
    both are positive, tension times the mean slip, and overlap times the mean force.

    The violation of the worst interface is divided by the mean of dissipation plus the
    largest elastic energy, so that it is defined where nothing slides. The relative
    gaps of displacements and of forces at all other interfaces are added. The sum is
    divided by the share of the largest force that friction can carry, if below one, so
    that a small friction force is held to the same standard. The result is zero if and
    only if all laws hold, up to the rounding of the fields.

    `displacement` and `force` have shape (n_rows, n_instants), scaled.
    """
    displacement, force = _as_lengths(problem, displacement, force)
    noise = _rounding(displacement, force)
    groups = [
        group
        for group in problem.contacts.groups
        if group.law.incremental_form() is not None
    ]
    violations = [group.law.violation(displacement, force, noise) for group in groups]
    energy = _elastic_energy(problem, displacement, beyond(force, noise))
    energy += sum(float(violation.dissipated.sum()) for violation in violations)
    largest_friction = sum(float(violation.bound.sum()) for violation in violations)
    # Where nothing can dissipate any force sets the scale.
    if largest_friction == 0.0:
        largest_friction = float(np.abs(force).sum())
    mean_slip = ratio(energy, largest_friction)
    energies = [
        _worst(group, violation, mean_slip)
        for group, violation in zip(groups, violations, strict=True)
    ]
    worst = max(energies, default=0.0)
    # Against the mean energy per interface, so that many that hold do not hide one that
    # does not.
    total = ratio(len(problem.contacts) * worst, energy)
    total += _gap_of_bonds(problem, displacement, force, noise)
    return total / _share_of_friction(problem, force)


def _as_lengths(
    problem: Problem, displacement: Array, force: Array
) -> tuple[Array, Array]:
    """W and F, with turns of beams at their cuts as lengths, and moments as forces.

    A turn counts as what it moves at the distance of a scaled length, so that the unit
    of length does not matter. All have shape (n_rows, n_instants), scaled.
    """
    turns = problem.turns_at_cuts
    if not turns.size:
        return displacement, force
    length = problem.scales.displacement
    moved = displacement.copy(order="K")
    moved[turns] *= length
    pushed = force.copy(order="K")
    pushed[turns] /= length
    return moved, pushed


def _worst(group: ContactGroup, violation: Violation, mean_slip: float) -> float:
    """Largest violation of the law at any interface of a group: an energy, scaled."""
    mean_force: Array | float = 0.0
    if violation.pressing is not None:
        pressed = np.maximum(violation.pressing, 0.0).mean(axis=1)
        pairs = group.interfaces[group.law.points]
        # Interfaces of a group lie in one array, and each has its own mean.
        means = group.sums(pressed) / group.sums(np.ones_like(pressed))
        mean_force = means[pairs, None]
    energy = violation.energy(mean_slip, mean_force)
    return float(group.sums(energy.sum(axis=1)).max())


def _elastic_energy(problem: Problem, displacement: Array, force: Array) -> float:
    """Largest elastic energy over time, by the work of interfaces and body forces.

    `displacement` and `force` have shape (n_rows, n_instants), scaled.
    """
    if problem.body_force_on_rows is not None:
        force = force + problem.body_force_on_rows
    work = np.einsum("ij,ij->j", displacement, force)
    return 0.5 * max(float(work.max(initial=0.0)), 0.0)


def _rounding(displacement: Array, force: Array) -> float:
    """Largest rounding of W and F, or all displacement where the structure sticks.

    `displacement` and `force` have shape (n_rows, n_instants), scaled.
    """
    moved = float(np.abs(displacement).max())
    pulled = float(np.abs(force).max())
    # A structure that sticks everywhere hardly moves, and its slips are rounding.
    if moved <= STILL * pulled / len(force):
        return max(moved, ROUNDING * pulled)
    return ROUNDING * (moved + pulled)


def _share_of_friction(problem: Problem, force: Array) -> float:
    """Share of the largest force that friction and contacts can carry, at most 1.

    `force` has shape (n_rows, n_instants), scaled.
    """
    largest = float(np.abs(force).max())
    laws = [group.law for group in problem.contacts.groups]
    carried = max((law.carried(force) for law in laws), default=0.0)
    by_friction = sum(law.capacity(problem.is_held) for law in laws)
    capacity = max(by_friction, SMALL_CONTACT * carried)
    if capacity > 0.0 and largest > 0.0:
        return min(capacity / largest, 1.0)
    return 1.0


def _gap_of_bonds(
    problem: Problem, displacement: Array, force: Array, noise: float
) -> float:
    """Sum of relative gaps of displacements and of forces at all other interfaces.

    `displacement` and `force` have shape (n_rows, n_instants), scaled; gaps up to
    `noise` are rounding.
    """
    k = problem.direction
    gaps_of_laws = [law.gaps(displacement, force, noise, k) for law in problem.laws]
    apart = sum(gaps.displacement for gaps in gaps_of_laws)
    unbalanced = sum(gaps.force for gaps in gaps_of_laws)
    of_displacement = np.sqrt(ratio(apart, squared(displacement)))
    of_force = np.sqrt(ratio(unbalanced, squared(force)))
    return float(of_displacement + of_force)


def ratio(part: float, whole: float) -> float:
    """Quotient: 0 for 0 / 0, and infinite for other numbers over 0."""
    if part == 0.0:
        return 0.0
    if whole != 0.0:
        return part / whole
    return float("inf")
