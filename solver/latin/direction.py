"""The search direction k of every boundary row, constant in a run."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.definitions import SettingError
from solver.discrete.problem import Problem
from solver.laws import Dirichlet, Neumann, Perfect
from solver.settings import Settings


def search_direction(problem: Problem, settings: Settings) -> Array:
    """Give k of every row, shape (n_rows,), scaled.

    It is the paper's, or the automatic one, times the settings' factors.
    """
    k: Array = settings.k_scale * _by_rule(problem, settings.search_direction)
    along, across = settings.k_factors
    for law in problem.rubbing.values():
        for rows in law.tangent.sides:
            k[rows] *= along
        if law.normal is not None:
            for rows in law.normal.sides:
                k[rows] *= across
    return np.ascontiguousarray(k)


def _by_rule(problem: Problem, rule: str) -> Array:
    match rule:
        case "paper":
            return problem.direction
        case "auto":
            return automatic(problem)
        case _:
            raise SettingError("search_direction", rule, "paper, auto", "choose one of these")


def automatic(problem: Problem) -> Array:
    """Give k of every row by a rule that needs no tuning, shape (n_rows,), scaled.

    Where bodies rub it is what `solver.laws.around` says, and where contact gives way before it
    slips that in series with its spring; elsewhere the paper's, times a factor. With the spring
    left out, 1e-6 of friction force takes 52 iterations of the bar instead of 16, and 73 of the
    strand instead of 15 (measured, geometric means over contact stiffnesses of 3 to 3000 and four
    load paths).
    """
    laws = list(problem.rubbing.values())
    around = laws[0].around
    k = problem.direction * around.elsewhere
    for cut in problem.of_law(Perfect):
        k[cut.first] *= around.on_cuts
        k[cut.second] *= around.on_cuts
    parts = len(laws) / sliding_share(problem)
    for law in laws:
        law.around.choose(law, k, parts)
        if law.compliance.any():
            softness = law.compliance[law.points] / law.shares
            for rows in law.tangent.sides:
                k[rows] /= 1.0 + softness * k[rows]
    return k


def sliding_share(problem: Problem) -> float:
    """Estimate the share of one frictional interface that slides at the largest load.

    It is that load over all that friction can carry, between two points and all of them: the load
    of one body over one interface, where there are several alike. Where displacements are
    prescribed the load is not known beforehand: on a rigid support all may slide; bodies that rub
    on each other carry no more than what the displacement alone makes of a rod, whose scaled
    stiffness is 1.
    """
    first, *_ = problem.rubbing.values()
    capacity = float(first.bound.sum())
    smallest = min(2.0 / len(first.positions), 1.0)
    load = np.zeros(problem.n_instants)
    for pulled in problem.of_law(Neumann):
        load += pulled.force.mean(axis=0)
    for moved in problem.of_law(Dirichlet):
        if moved.acts:
            if first.is_on_support:
                return 1.0
            load += moved.displacement.mean(axis=0)
    for part in problem.substructures:
        if part.body_force is not None:
            load += part.body_force.sum(axis=0)
    largest = float(np.abs(load).max())
    return float(np.clip(largest / capacity, smallest, 1.0)) if capacity > 0.0 else 1.0
