"""The search direction k of every boundary row, constant in a run."""

from __future__ import annotations

import numpy as np

from solver.definitions import SettingError
from solver.discrete.problem import Array, Indices, Problem, sliding_rows
from solver.laws import Contact, Dirichlet, Friction, Neumann, Perfect
from solver.scenes.plane import PlaneSettings
from solver.settings import Settings

FRICTION_FACTOR = 2.0
"""k of a friction point over the geometric mean of the two stiffnesses in play, ES/s and ES/h.
Measured with Anderson acceleration and a nested start, sine and decaying cycles of 300 to 2400 N:
1 % of friction force within 23 iterations with 1.5 and 2, 19 with 3, 28 with 1, 43 with 4; and
1e-6 the later the larger it is."""
CUT_FACTOR = 10.0
"""k of a cut over the paper's ES/l_sub. Measured with 1 to 50 substructures: 1 % of friction force
takes 16 to 17 iterations with 10, 16 to 20 with 3, 16 to 19 with 100, 16 to 31 with 1."""
PLANE_FACTOR = 8.0
"""k of cuts and supports in the plane over the paper's E/l_sub per area."""
CONTACT_STIFFNESS = 7.0
"""k per area of a contact in the plane, times its length over E. With both, 1 % of the contact
force takes 8 to 14 iterations, 7 to 11 with Anderson acceleration, and differs by at most two from
4 to 64 substructures: pressed flat, on a parabola, tilted, and a quarter as high; 48 and 96
elements along (measured). Twice as much takes up to 20."""
RESOLVED, FINER = 96.0, 1.0 / 3.0
"""Elements along a support from which its k grows with their number, and to which power. What is
local then is stiffer than the body as a whole, so a constant k finds it ever later. Block of
768 x 384 elements on a parabola: 1 % of the contact force takes 14 iterations, 1e-4 takes 52; 13
and 104 with a constant k, 18 and 47 with three times as much; flat, 17 and 53, instead of 29 and
62. With the power 1/2, of the geometric mean of global and local stiffness, 1 % takes 21 if k grows
from 48 elements on; and 96 x 96 need more than 15 without acceleration (measured). Layers, where k
is of their sliding, gain nothing."""
SLIDING_BETWEEN_BODIES = 1.0 / 7.0
"""The tangential k between two bodies over the normal one: layers slide on each other along their
length. Measured as `SLENDER` is: at most 45 iterations; 76 with half as much, 67 with twice."""
SLENDER = 40.0
"""How many times as long as thick two bodies in contact may be before k must be smaller. Measured
on 2 to 10 layers, 10 to 1000 times as long as thick, friction 0.3 and 1, one to four substructures
along and one or two up, pressures that let them slide: 1 % of the contact force takes 10 to 45
iterations. At most 54 with half of it, 46 with twice, 82 with four times; layers 1000 times as long
as thick take more than 150 with no such limit."""


def search_direction(problem: Problem, settings: Settings) -> Array:
    """Give k of every row, shape (n_rows,), scaled.

    It is the paper's, or the automatic one, times the settings' factors.
    """
    k: Array = settings.k_scale * _by_rule(problem, settings.search_direction)
    for law in problem.rubbing.values():
        for rows in sliding_rows(law):
            k[rows] *= settings.k_friction_scale
        if isinstance(law, Contact) and isinstance(settings, PlaneSettings):
            for rows in pressing_rows(law):
                k[rows] *= settings.k_normal_scale
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

    Small k converges fast globally and slowly locally, large k the reverse (theory.md, 5). Along
    rods, what is global on the frictional interface is the length s that is expected to slide,
    what is local the distance h of its points. So k of a point is `FRICTION_FACTOR` times the
    geometric mean of ES/s and ES/h, for which neither end is slower than the other, and a row's
    share of it is by tributary length, so that cuts change nothing. Of the n contacts of a strand
    only those of the broken wire slide far: s is a mean over all of them, and k grows by sqrt(n).
    For 1 % of the friction force that takes 31 iterations instead of 67 with 10 wires, 65 instead
    of 109 with 20, 147 instead of 191 with 40; half and twice as much k takes 49 and 49 with 10,
    79 and 75 with 20 (measured, the middle one broken, 40 elements). Where the section varies, ES
    is that around the point: with ten thousand times more at the load than at the clamp, 1 % of
    friction force takes 45 iterations, and more than 1500 with the mean. On cuts, k is
    `CUT_FACTOR` times the paper's. In the plane k is that of a body as a whole on contacts, and
    `PLANE_FACTOR` times the paper's elsewhere, also on cuts along slender
    substructures: a smaller k there is no better, where the macro basis grows with their length
    (measured).
    """
    k = problem.direction.copy()
    if problem.of_law(Contact):
        k *= PLANE_FACTOR
        for law in problem.rubbing.values():
            assert isinstance(law, Contact)
            _touching(law, k)
        return k
    parts = len(problem.rubbing) / sliding_share(problem)
    for law in problem.rubbing.values():
        assert isinstance(law, Friction)
        length = law.weights.sum()
        spacing = length / max(len(law.positions) - 1, 1)
        stiffness = FRICTION_FACTOR * np.sqrt(length / spacing * parts)
        for rows in sliding_rows(law):
            k[rows] = stiffness * law.weights / spacing
            if law.modulus is not None:
                k[rows] *= law.modulus
    for cut in problem.of_law(Perfect):
        assert isinstance(cut, Perfect)
        k[cut.first] *= CUT_FACTOR
        k[cut.second] *= CUT_FACTOR
    return k


def _touching(law: Contact, k: Array) -> None:
    """Write k of a contact in the plane.

    A thin body on a rigid support is squeezed, with the stiffness E / d of its depth d: 1 % of the
    contact force takes 9 and 14 iterations where it is 100 and 1000 times as long as high, 15 and
    67 without (measured).
    """
    length = law.weights.sum()
    if law.below is None:
        finer = max((len(law.positions) - 1) / RESOLVED, 1.0) ** FINER
        pressing = sliding = max(CONTACT_STIFFNESS * finer, length / law.depth)
    else:
        pressing = CONTACT_STIFFNESS * _slender(law)
        sliding = SLIDING_BETWEEN_BODIES * pressing
    share = law.weights / length
    for rows, modulus in zip(pressing_rows(law), law.moduli, strict=False):
        k[rows] = modulus * pressing * share
    for rows, modulus in zip(sliding_rows(law), law.moduli, strict=False):
        k[rows] = modulus * sliding * share


def _slender(law: Contact) -> float:
    """Give the factor on k between two bodies that are thin beside their length.

    Layers slide like the rods of `automatic`: what is global is the stiffness E d / l^2 per area
    of a rod of depth d along the contact's length l, what is local E d / (l h) with the distance h
    of its points, or with d where that is larger. Their geometric mean is E / l times the root of
    d / l min(1, d / h). Bending is softer still, but the macro forces see to its long waves.
    """
    length = float(law.weights.sum())
    spacing = length / max(len(law.positions) - 1, 1)
    resolved = min(law.depth / spacing, 1.0)
    return float(np.sqrt(min(SLENDER * law.depth / length * resolved, 1.0)))


def pressing_rows(law: Contact) -> tuple[Indices, ...]:
    """Give the rows of the normal components, of both sides."""
    return (law.normal,) if law.below is None else (law.normal, law.below[0])


def sliding_share(problem: Problem) -> float:
    """Estimate the share of one frictional interface that slides at the largest load.

    It is that load over all that friction can carry, between two points and all of them: the load
    of one body over one interface, where there are several alike. Where displacements are
    prescribed the load is not known beforehand: on a rigid support all may slide; bodies that rub
    on each other carry no more than what the displacement alone makes of a rod, whose scaled
    stiffness is 1.
    """
    first, *_ = problem.rubbing.values()
    assert isinstance(first, Friction)
    capacity = float(first.bound.sum())
    smallest = min(2.0 / len(first.positions), 1.0)
    load = np.zeros(problem.n_instants)
    for law in problem.interfaces.values():
        if isinstance(law, Neumann):
            load += law.force.mean(axis=0)
        elif isinstance(law, Dirichlet) and law.displacement.any():
            if first.below is None:
                return 1.0
            load += law.displacement.mean(axis=0)
    for part in problem.substructures:
        if part.body_force is not None:
            load += part.body_force.sum(axis=0)
    largest = float(np.abs(load).max())
    return float(np.clip(largest / capacity, smallest, 1.0)) if capacity > 0.0 else 1.0
