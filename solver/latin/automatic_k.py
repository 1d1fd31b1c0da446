"""The search direction k that needs no tuning (solver/README.md, 5)."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.laws import Bodies

SOFTENING = 2.0
"""k at least, over the slope by which a friction of known bound falls with slip: below once the
slope the local stage has several solutions. Faults with friction_ratio 0.7 to 0.9: 1 % of the
contact force takes 11 to 77 iterations, as many with 1.5 and 3, more than 300 with 1.1 (measured).
"""


def automatic(problem: Problem, *, sticks: bool = False) -> Array:
    """Search direction k of every row by a rule that needs no tuning, shape (n_rows,), scaled.

    It is that of bodies that slip on each other, or of bodies that nowhere do.

    Where bodies rub it is what `solver.laws.around` says, and where contact gives way before it
    slips that in series with its spring; elsewhere the paper's, times a factor. With the spring
    left out, 1e-6 of friction force takes 52 iterations of the bar instead of 16, and 73 of the
    strand instead of 15 (measured, geometric means over contact stiffnesses of 3 to 3000 and four
    load paths). Where friction softens it is more than the slope by which it falls.
    """
    laws = list(problem.rubbing.values())
    around = laws[0].around
    k = problem.direction * around.elsewhere
    for first, second in problem.cuts:
        k[first] *= around.on_cuts
        k[second] *= around.on_cuts
    # Rods on supports of their own slide all alike; of those beside each other one slides far.
    several = 1 if all(law.is_on_support for law in laws) else len(laws)
    parts = several / sliding_share(problem)
    for law in laws:
        law.around.choose(law, k, parts)
        if sticks and isinstance(law.around, Bodies):
            law.around.stick(law, k)
        if law.tangential.softens:
            for rows in law.tangent.sides:
                least = SOFTENING * len(law.tangent.sides) * law.tangential.steepest_fall
                k[rows] = np.maximum(k[rows], least)
        if law.tangential.softness is not None:
            softness = law.in_parallel(law.tangential.softness)[law.points] / law.shares
            for rows in law.tangent.sides:
                k[rows] /= 1.0 + softness * k[rows]
    return k


def sliding_share(problem: Problem) -> float:
    """Estimate the largest share of one frictional interface that ever slides.

    It is that load over all that friction can carry then, between two points and all: the load
    of one body over one interface, where there are several alike. Where displacements are
    prescribed the load is not known beforehand: on a rigid support all may slide; bodies that rub
    on each other carry no more than what the displacement alone makes of a rod, whose scaled
    stiffness is 1. Bodies on supports of their own are taken to slide all along.
    """
    first, *others = problem.rubbing.values()
    if others and all(law.is_on_support for law in problem.rubbing.values()):
        return 1.0
    capacity = first.tangential.bound.sum(axis=0)
    smallest = min(2.0 / len(first.positions), 1.0)
    load = np.zeros(problem.n_instants)
    for pulled in problem.given_forces:
        load += pulled.values.mean(axis=0)
    for moved in problem.given_displacements:
        if moved.values.any():
            if first.is_on_support:
                return 1.0
            load += moved.values.mean(axis=0)
    for part in problem.substructures:
        if part.body_force is not None:
            load += part.body_force.sum(axis=0)
    if not capacity.all():
        return 1.0
    return float(np.clip((np.abs(load) / capacity).max(), smallest, 1.0))
