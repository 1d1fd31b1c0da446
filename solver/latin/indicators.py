"""Indicators that the iteration computes of itself; none is an error (theory.md, 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.discrete.problem import Array, Problem
from solver.latin.iterate import Iterate
from solver.laws import Dirichlet, Neumann, Perfect


def latin_indicator(iterate: Iterate) -> float:
    """Compute eta, the relative squared distance of linear and local stage (paper, eq. 2).

    With ||s||^2 = integral of k W^2 + F^2/k = 1/2 integral of k [(W + F/k)^2 + (W - F/k)^2].
    Zero when both stages are zero.
    """

    def squared(field: Array) -> float:
        return float(iterate.k @ (field * field @ weights))

    weights = iterate.problem.time_weights
    local_outgoing = 2.0 * iterate.local_displacement - iterate.local_incoming
    distance = squared(iterate.outgoing - local_outgoing)
    distance += squared(iterate.incoming - iterate.local_incoming)
    size = squared(iterate.outgoing) + squared(iterate.incoming)
    size += squared(local_outgoing) + squared(iterate.local_incoming)
    return ratio(2.0 * distance, size)


ROUNDING = 64.0 * float(np.finfo(float).eps)
"""Share of the largest displacement, or of that under the largest force, that rounding blurs."""


@dataclass(frozen=True)
class BehaviourIndicator:
    """How far the linear stage is from the behaviour of the interfaces, without k.

    Attributes
    ----------
    total
        Violation of friction as a share of the energy in play, plus the relative gap of
        displacements and of forces at all other interfaces; over the share of the largest force
        that friction can carry, if below one, so that a small friction force is held to the same
        standard. Zero if and only if all laws hold, up to the rounding of the fields.
    map
        Local violation of friction, shape (n_points, n_instants), a share of the energy in play
        for each point and instant, times their number: 1 means as much as the mean energy.
    """

    total: float
    map: Array

    @property
    def largest(self) -> float:
        """Largest entry of the map."""
        return float(self.map.max(initial=0.0))


def behaviour_indicator(iterate: Iterate) -> BehaviourIndicator:
    """Check the linear stage's fields against the interface laws alone (theory.md, 4).

    Friction with bound q and slip increment v: q|v| + F v with F cut to |F| <= q, which is
    nowhere negative and zero exactly where Coulomb's law holds, and the excess of |F| over q
    times the mean slip. Divided by the dissipation plus the largest elastic energy, so that it is
    defined where nothing slides.
    """
    return behaviour_of(iterate.problem, iterate.boundary_displacement, iterate.boundary_force)


def behaviour_of(problem: Problem, displacement: Array, force: Array) -> BehaviourIndicator:
    """Check W and F of the boundary, shape (n_rows, n_instants), as `behaviour_indicator` does."""
    law = problem.friction
    noise = _rounding(displacement, force)
    slip = _beyond(np.diff(displacement[law.rows], axis=1, prepend=0.0), 2.0 * noise)
    bound = law.bound[:, None]
    friction = force[law.rows]
    held = np.clip(friction, -bound, bound)
    dissipated = bound * np.abs(slip)
    energy = 0.5 * float(np.einsum("ij,ij->j", displacement, force).max(initial=0.0))
    energy += float(dissipated.sum())
    allowance = float(law.bound.sum()) * problem.n_instants or float(np.abs(force).sum())
    mean_slip = ratio(energy, allowance)
    violation = dissipated + held * slip + np.abs(friction - held) * mean_slip
    map_ = np.zeros((len(law.positions), problem.n_instants))
    np.add.at(map_, law.points, np.maximum(violation, 0.0))
    total = ratio(float(map_.sum()), energy)
    map_ *= ratio(map_.size, energy) if energy else 0.0
    total += _gap_of_bonds(problem, displacement, force, noise)
    return BehaviourIndicator(total / _share_of_friction(problem, force), map_)


def _rounding(displacement: Array, force: Array) -> float:
    """Give the displacement that rounding alone makes; a scaled structure's compliance is near 1.

    It knows no k, so that the indicator sees none.
    """
    return ROUNDING * float(np.abs(displacement).max() + np.abs(force).max())


def _beyond(field: Array, noise: float) -> Array:
    """Give a field with what may be rounding taken as zero."""
    return np.where(np.abs(field) > noise, field, 0.0)


def _share_of_friction(problem: Problem, force: Array) -> float:
    """Give the share of the largest force that friction can carry beside the supports, at most 1.

    It is 1 where there is no friction.
    """
    law = problem.friction
    held = np.isin(problem.row_dofs[law.rows], problem.prescribed[0])
    capacity, largest = float(law.bound[~held].sum()), float(np.abs(force).max())
    return min(capacity / largest, 1.0) if capacity > 0.0 and largest > 0.0 else 1.0


def _gap_of_bonds(problem: Problem, displacement: Array, force: Array, noise: float) -> float:
    gap_w, gap_f = 0.0, 0.0
    for law in problem.interfaces.values():
        if isinstance(law, Perfect):
            gap_w += _squared(
                _beyond(displacement[law.first] - displacement[law.second], 2.0 * noise)
            )
            gap_f += _squared(force[law.first] + force[law.second])
        elif isinstance(law, Dirichlet):
            gap_w += _squared(_beyond(displacement[law.rows] - law.displacement, noise))
        elif isinstance(law, Neumann):
            gap_f += _squared(force[law.rows] - law.force)
    return float(
        np.sqrt(ratio(gap_w, _squared(displacement))) + np.sqrt(ratio(gap_f, _squared(force)))
    )


def _squared(field: Array) -> float:
    return float(np.vdot(field, field))


def ratio(part: float, whole: float) -> float:
    """Divide, where nothing of nothing is zero and something of nothing is infinite."""
    if part == 0.0:
        return 0.0
    return part / whole if whole != 0.0 else float("inf")
