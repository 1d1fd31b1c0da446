"""The path of a point between friction law and equilibrium, over the iterations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from scipy import sparse

from app.frame import LINEAR, LOCAL, Floats
from app.messages import Needs
from app.worker.cells import floats, thinned
from app.worker.extras import Sampled
from app.worker.geometry import MOST_POINTS
from solver.arrays import Array, Indices, sparse_factor
from solver.discrete import Problem
from solver.latin import Iterate
from solver.laws import Contact
from solver.reference.assembly import assembled_stiffness, jumps
from solver.reference.solution import Reference

LARGEST = 20_000
"""Largest number of degrees of freedom for which the stiffness at a point is found: its
factor takes a third of a second."""
HELD = 1e-12
"""Springs that hold bodies which contact alone holds, over the stiffest degree of
freedom."""
STRAIGHT = 1e-6
"""Distance up to which a point lies on the line along k, over its largest force."""


@dataclass(frozen=True, eq=False)
class IterateStages:
    """Jump and force of pairs in both stages, shape (n_pairs, n_instants), scaled.

    With two bodies the force of a linear stage is that of both sides, each by its share
    in the springs k: so both stages lie on lines along k. `k` is that of these springs
    in series, shape (n_pairs,).
    """

    k: Array
    jump: dict[str, Array]
    force: dict[str, Array]

    @classmethod
    def of(
        cls, iterate: Iterate, law: Contact, pairs: Indices, columns: Indices
    ) -> IterateStages:
        """Both stages of an iterate at some pairs and instants."""
        soft = np.zeros(len(pairs))
        jump = dict.fromkeys((LOCAL, LINEAR), 0.0)
        strain = dict.fromkeys((LOCAL, LINEAR), 0.0)
        for rows, sign in zip(law.tangent.sides, (1.0, -1.0), strict=False):
            soft += 1.0 / iterate.k[rows[pairs]]
            seen = np.ix_(rows[pairs], columns)
            moved = iterate.local_displacement[seen]
            jump[LOCAL] += sign * moved
            strain[LOCAL] += sign * (moved - iterate.local_incoming[seen])
            outgoing = iterate.outgoing[seen]
            incoming = iterate.incoming[seen]
            jump[LINEAR] += 0.5 * sign * (outgoing + incoming)
            strain[LINEAR] += 0.5 * sign * (outgoing - incoming)
        force = {stage: value / soft[:, None] for stage, value in strain.items()}
        return cls(1.0 / soft, jump, force)


class ContactPoint:
    """A point of an interface, whose pairs have equal motion; SI, per length or area.

    `pairs` are its pairs, shape (n,), and `number` is its own among the points.
    """

    def __init__(self, problem: Problem, name: str, number: int) -> None:
        self.law = law = problem.contacts[name]
        self.number = number
        self.pairs: Indices = np.flatnonzero(law.points == number)
        scales = problem.scales
        self.slip_unit = law.slip_ratio * scales.displacement
        self.force_unit = scales.force / float(law.weights[self.pairs].sum())

    def way(self, iterate: Iterate, columns: Indices) -> tuple[float, Array, Array]:
        """Slope k, and slip and force of both stages, (2, n_instants) each.

        The slip of several pairs is their mean by k, so that the point moves along k.
        """
        stages = IterateStages.of(iterate, self.law, self.pairs, columns)
        slope = float(stages.k.sum())
        points = []
        for stage in (LOCAL, LINEAR):
            slip = stages.k @ stages.jump[stage] / slope * self.slip_unit
            force = stages.force[stage].sum(axis=0) * self.force_unit
            points.append(np.stack([slip, force]))
        return slope * self.force_unit / self.slip_unit, *points

    def law_at(self, iterate: Iterate, columns: Indices) -> dict[str, Any]:
        """The law at instants, as in the local stage of an iterate.

        "bound", the largest friction, and "slider", where the slider stood before, both
        (n_instants,); "soft", the compliance of the spring in series.
        """
        law = self.law
        displacement = iterate.local_displacement
        force = iterate.boundary_local_force
        bound = law.violation(displacement, force, 0.0).bound[self.pairs].sum(axis=0)
        friction = law.tangential
        slider = friction.slider(displacement, force)[self.pairs].mean(axis=0)
        start = 0.0
        if friction.start is not None:
            start = friction.start[self.pairs].mean()
        before = np.append(start, slider[:-1])
        soft = float(law.in_parallel(friction.compliance)[self.number])
        return {
            "bound": floats(bound[columns] * self.force_unit),
            "slider": floats(before[columns] * self.slip_unit),
            "soft": soft * self.slip_unit / self.force_unit,
        }


def zigzag(
    sampled: Sampled,
    past: Sequence[Iterate],
    solution: Reference | Iterate | None,
    iterate: Iterate,
    needs: Needs,
) -> dict[str, Any]:
    """The path of a point of the selected interface, and the fields of all its points.

    Of the past iterates, at all shown instants: "iterations", their numbers, from 0 for
    a start from nothing; "local" and "linear", slip, m, and friction force on the body
    above per length or area, of each stage, (n_iterates, 2, n_instants); "straight",
    whether the way to either stage goes along k, same shape; "k", the slope of this
    line. Of the iterate itself: the law (`ContactPoint.law_at`), and "fields", friction
    in both stages at points "x", (2, n_points, n_instants).

    "position" is that of the point, m; "star", slip and force of the solution, (2,
    n_instants), None while it is not known; "balance", the stiffness at the point
    (`stiffness_at`), per length or area, None where it is not found.
    """
    problem = sampled.problem
    columns = sampled.columns
    name = needs.interface
    law = problem.contacts[name]
    seen = _chosen(solution or iterate, law, needs)
    point = ContactPoint(problem, name, seen)
    star = None
    if solution is not None:
        contact = solution.contact(name)
        length = law.by_point(law.weights)[point.number]
        force = contact.tangential_force[point.number] / length
        star = floats(np.stack([contact.slip[point.number], force])[:, columns])
    balance = stiffness_at(sampled, name, point.number)
    if balance is not None:
        balance *= point.force_unit / point.slip_unit
    kept = thinned(len(law.positions), MOST_POINTS)
    shown = {
        "position": float(law.positions[point.number]),
        "star": star,
        "balance": balance,
        "x": floats(law.positions[kept]),
        "fields": _fields(problem, law, iterate, columns)[:, kept],
    }
    return shown | _way(point, past, columns) | point.law_at(iterate, columns)


def _way(
    point: ContactPoint, past: Sequence[Iterate], columns: Indices
) -> dict[str, Any]:
    """The stages of past iterates at a point, and which steps are along k."""
    begins = past[0].number == 1 and not past[0].local_incoming.any()
    numbers = [0] * begins + [iterate.number for iterate in past]
    local = np.full((len(numbers), 2, len(columns)), np.nan)
    # A run that starts from nothing begins at zero, before any local stage.
    linear = np.zeros_like(local)
    straight = np.zeros(local.shape, dtype=bool)
    slope = 0.0
    for index, iterate in enumerate(past, int(begins)):
        slope, local[index], linear[index] = point.way(iterate, columns)
        straight[index, 1] = _is_along(-slope, local[index], linear[index])
        if index:
            straight[index, 0] = _is_along(slope, linear[index - 1], local[index])
    return {
        "iterations": numbers,
        "local": floats(local),
        "linear": floats(linear),
        "straight": straight,
        "k": slope,
    }


def _is_along(slope: float, start: Array, end: Array) -> Array:
    """Check whether steps go along a slope, from and to (2, n_instants) each."""
    slip, force = end - start
    size = np.abs(np.stack([start, end])).max(axis=(0, 2))
    tolerance = STRAIGHT * max(size[1], abs(slope) * size[0])
    return np.abs(force - slope * slip) <= tolerance


def _fields(
    problem: Problem, law: Contact, iterate: Iterate, columns: Indices
) -> Floats:
    """Friction of both stages per length or area, (2, n_points, n_instants)."""
    stages = IterateStages.of(iterate, law, np.arange(len(law.points)), columns)
    unit = problem.scales.force / law.by_point(law.weights)[:, None]
    return floats(
        np.stack([law.by_point(stages.force[each]) * unit for each in (LOCAL, LINEAR)])
    )


def _chosen(shown: Reference | Iterate, law: Contact, needs: Needs) -> int:
    """Index of the selected point, or of one in the middle of what slips.

    It is taken at the instant at which friction takes most energy; where nothing slips
    it is that of the largest friction.
    """
    if needs.position is not None:
        return int(np.abs(law.positions - needs.position).argmin())
    contact = shown.contact(needs.interface)
    force = np.abs(contact.tangential_force)
    slips = np.abs(contact.status) == 1
    # The two pairs of a point on a cut do not move as one before the end.
    slips[np.bincount(law.points, minlength=len(slips)) > 1] = False
    energy = slips * force * np.abs(np.diff(contact.slip, axis=1, prepend=0.0))
    slipping = np.flatnonzero(energy[:, energy.sum(axis=0).argmax()])
    if not len(slipping):
        return int(force.max(axis=1).argmax())
    return int(slipping[len(slipping) // 2])


@lru_cache(maxsize=1)
def stiffness_at(sampled: Sampled, name: str, point: int) -> float | None:
    """Stiffness of the structure against a friction force at a point, scaled.

    All other contact forces stay as they are: so it is zero where they alone hold a
    body. It is None where the point cannot move, and for very large structures.
    """
    problem = sampled.problem
    if problem.n_dofs > LARGEST:
        return None
    place = problem.contacts.forces[name][-1].start + point
    pulled = jumps(problem)[[place]].toarray()[0]
    pulled[problem.prescribed[0]] = 0.0
    if not pulled.any():
        return None
    free = np.setdiff1d(np.arange(problem.n_dofs), problem.prescribed[0])
    stiffness = assembled_stiffness(problem)[free][:, free]
    springs = sparse.diags_array(HELD * stiffness.diagonal())
    factor = sparse_factor(sparse.csc_array(stiffness + springs))
    return 1.0 / float(pulled[free] @ factor.solve(pulled[free]))
