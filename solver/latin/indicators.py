"""Indicators that the iteration computes of itself; none is an error (solver/README.md, 4)."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from solver.arrays import ROUNDING, Array
from solver.discrete.contacts import ContactGroup
from solver.discrete.problem import Problem
from solver.laws.contact import Behaviour
from solver.laws.interface import beyond, squared

if TYPE_CHECKING:
    from solver.latin.iterate import Iterate


def latin_indicator(iterate: Iterate) -> float:
    """Eta, the relative squared distance of linear and local stage (paper, eq. 2).

    With ||s||^2 = integral of k W^2 + F^2/k = 1/2 integral of k [(W + F/k)^2 + (W -
    F/k)^2]. Zero when both stages are zero.
    """

    def weighted(field: Array) -> float:
        return float(iterate.k @ (field * field @ weights))

    weights = iterate.problem.time_weights
    local_outgoing = 2.0 * iterate.local_displacement - iterate.local_incoming
    distance = weighted(iterate.outgoing - local_outgoing)
    distance += weighted(iterate.incoming - iterate.local_incoming)
    size = weighted(iterate.outgoing) + weighted(iterate.incoming)
    size += weighted(local_outgoing) + weighted(iterate.local_incoming)
    return ratio(2.0 * distance, size)


CREEP = 1e-2
"""Share of the largest slip of an interface from which on a slip is one whatever the
stages differ by, so that an early iterate shows where it slips."""


def contact_status(iterate: Iterate, creep: Array | float = CREEP) -> NDArray[np.int8]:
    """Contact status of the local stage, as `Iterate.status`, shape (n_points, n_instants).

    A point that comes to rest goes on creeping in the local stage for a hundred
    iterations: by no more than both stages still differ by (measured). So what counts
    as slip is more than they differ by in any slip of the interface, though never more
    than `creep` times the largest, (n_interfaces,) or one for all. In a certified
    solution, where they agree, all that is more than rounding counts. Bar of 50
    elements at its end, with the paper's options: all statuses are right; with rounding
    alone as the limit 23.5 % are wrong.
    """
    moved = iterate.local_displacement
    force = iterate.boundary_local_force
    linear = iterate.boundary_displacement, iterate.boundary_force
    groups = iterate.problem.contact_groups
    creep = np.broadcast_to(creep, len(iterate.problem.rubbing))
    n_points = sum(len(group.points) for group in groups)
    status = np.empty((n_points, moved.shape[1]), dtype=np.int8)
    for group in groups:
        slip = group.slip(moved, force)
        apart = np.abs(slip - group.slip(*linear))
        far = np.abs(slip)
        normal = group.law.normal
        if normal is not None:
            touches = group.law.by_point(force[normal.component.above]) > 0.0
            far = np.where(touches, far, 0.0)
            apart = np.where(touches, apart, 0.0)
        still = np.minimum(
            creep[group.numbers] * group.largest(far), group.largest(apart)
        )
        status[group.points] = group.status(moved, force, slip=slip, still=still)
    return status


SMALL_CONTACT = 1e3
"""A contact force this many times smaller than the largest force still counts as one as
large."""
STILL = 1e-6
"""Share of what the largest force does to one element, below which a structure does not
move."""


def behaviour_of(problem: Problem, displacement: Array, force: Array) -> float:
    """Violation of the laws by W and F, (n_rows, n_instants), whatever k (solver/README.md, 4).

    Friction with bound q and slip increment v: q|v| + F v with F cut to |F| <= q, which
    is nowhere negative and zero exactly where Coulomb's law holds, and the excess of
    |F| over q times the mean slip. In unilateral contact q = mu N with the pressing
    force N, and with the opening g also N g where both are positive, tension times the
    mean slip, and overlap times the mean force. Of the interface where it is worst it
    is divided by the mean of dissipation plus the largest elastic energy, so that it is
    defined where nothing slides; the relative gap of displacements and of forces at all
    other interfaces is added; and all is divided by the share of the largest force that
    friction can carry, if below one, so that a small friction force is held to the same
    standard. Zero if and only if all laws hold, up to the rounding of the fields.
    """
    noise = _rounding(displacement, force)
    groups = _known_groups(problem)
    behaviours = [group.law.behaviour(displacement, force, noise) for group in groups]
    energy = _elastic_energy(problem, displacement, beyond(force, noise)) + sum(
        float(behaviour.dissipated.sum()) for behaviour in behaviours
    )
    allowance = sum(float(behaviour.bound.sum()) for behaviour in behaviours)
    allowance = allowance or float(np.abs(force).sum())
    mean_slip = ratio(energy, allowance)
    worst = max(
        map(partial(_worst, mean_slip=mean_slip), groups, behaviours), default=0.0
    )
    # Against the mean energy per interface, so that many that hold do not hide one that
    # does not.
    total = ratio(len(problem.rubbing) * worst, energy) + _gap_of_bonds(
        problem, displacement, force, noise
    )
    return total / _share_of_friction(problem, force)


def _known_groups(problem: Problem) -> list[ContactGroup]:
    """Groups of contacts whose laws are those that `Contact.behaviour` says."""
    groups = problem.contact_groups
    return [group for group in groups if group.law.incremental_form() is not None]


def _worst(group: ContactGroup, behaviour: Behaviour, mean_slip: float) -> float:
    """Violation of the law at that interface of a group where it is largest."""
    mean_force: Array | float = 0.0
    if behaviour.pressing is not None:
        pressed = np.maximum(behaviour.pressing, 0.0).mean(axis=1)
        pairs = group.interfaces[group.law.points]
        means = group.sums(pressed) / group.sums(np.ones_like(pressed))
        mean_force = means[pairs, None]
    violation = behaviour.violation(mean_slip, mean_force)
    return float(group.sums(violation.sum(axis=1)).max())


def _elastic_energy(problem: Problem, displacement: Array, force: Array) -> float:
    """The largest elastic energy over time; body forces work on it like the interfaces."""
    if problem.body_force_on_rows is not None:
        force = force + problem.body_force_on_rows
    work = np.einsum("ij,ij->j", displacement, force)
    return 0.5 * max(float(work.max(initial=0.0)), 0.0)


def _rounding(displacement: Array, force: Array) -> float:
    """What rounding makes of W and F alike; where all sticks, all that an iterate moves."""
    moved = float(np.abs(displacement).max())
    pulled = float(np.abs(force).max())
    if moved <= STILL * pulled / len(force):
        return max(moved, ROUNDING * pulled)
    return ROUNDING * (moved + pulled)


def _share_of_friction(problem: Problem, force: Array) -> float:
    """Share of the largest force that friction, or contact that may open, can carry; at most 1."""
    largest = float(np.abs(force).max())
    laws = [group.law for group in problem.contact_groups]
    carried = max((law.carried(force) for law in laws), default=0.0)
    capacity = max(
        sum(law.capacity(problem.is_held) for law in laws), SMALL_CONTACT * carried
    )
    if capacity > 0.0 and largest > 0.0:
        return min(capacity / largest, 1.0)
    return 1.0


def _gap_of_bonds(
    problem: Problem, displacement: Array, force: Array, noise: float
) -> float:
    k = problem.direction
    gaps_of_laws = [law.gaps(displacement, force, noise, k) for law in problem.laws]
    apart = sum(gaps.displacement for gaps in gaps_of_laws)
    unbalanced = sum(gaps.force for gaps in gaps_of_laws)
    return float(
        np.sqrt(ratio(apart, squared(displacement)))
        + np.sqrt(ratio(unbalanced, squared(force)))
    )


def ratio(part: float, whole: float) -> float:
    """Divide, where nothing of nothing is zero and something of nothing is infinite."""
    if part == 0.0:
        return 0.0
    if whole != 0.0:
        return part / whole
    return float("inf")
