"""The broken wire in closed form: each side of its break is a friction bar (solver/README.md, 6).

Unbroken, all wires carry the tension T and nothing slips. The break adds a force n to the broken
wire, -T at its two new ends, which the neighbours take over in equal shares: with m of them, what
they slip by is the displacement of a bar of stiffness ES m / (m + 1), under m times the bound,
that is clamped far away and pulled at the break. Its normal force is a play operator of T, and on a
rising load the broken wire carries min(T, m mu p |x - x_break|): all of it after T / (m mu p).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.discrete.rods import End, Rods
from solver.laws import FrictionLaw
from solver.reference.closed_forms.pulled_bar import ClosedForm, closed_form

STEPS = 100
PRECISION = 1e-13
"""Change of the tension, as a share of the largest, at which it is accepted."""


@dataclass(frozen=True, eq=False)
class BrokenWire:
    """The exact solution at the nodes, without discretisation in space.

    Attributes
    ----------
    tension
        T, which all wires would carry without the break, shape (n_instants,), N. With a rigid grip
        the break makes it less than what was asked for.
    force, neighbour_force
        Axial force of the broken wire and of each neighbour, shape (n_nodes, n_instants), N.
    friction_force
        Friction force on the broken wire over the tributary length of each node, both sides
        together, shape (n_nodes + 1, n_instants), N; the break has two nodes. At a held end it
        cannot be told from the reaction.
    slip
        Displacement of the broken wire over its neighbours, same shape, m.
    """

    tension: Array
    force: Array
    neighbour_force: Array
    friction_force: Array
    slip: Array


def broken_wire(scene: Rods) -> BrokenWire | None:
    """Solution of a strand with a broken wire.

    Returns
    -------
    The solution, or None where no wire is broken, where its neighbours rub on others too and pass
    on what they took over, where friction is not Coulomb's, or not the same between all wires, or
    where the bound changes with time and the grip is rigid or wires slip away from the break.
    """
    if scene.friction_law != FrictionLaw() or scene.factors is not None:
        return None
    if scene.broken is None or scene.rubbing_sides != scene.wires - 1:
        return None
    if scene.right.is_prescribed and scene.bound.ndim > 1:
        return None
    tension = _tension(scene) if scene.right.is_prescribed else scene.load
    sides = _sides(scene, tension)
    if sides is None:
        return None
    left, right = sides
    lost = np.concatenate([left.normal_force, right.normal_force[-2::-1]])
    return BrokenWire(
        tension=tension,
        force=tension - lost,
        neighbour_force=tension + lost / scene.rubbing_sides,
        friction_force=np.concatenate([-left.friction_force, right.friction_force[::-1]]),
        slip=np.concatenate([-left.displacement, right.displacement[::-1]]),
    )


def _sides(scene: Rods, tension: Array) -> tuple[ClosedForm, ClosedForm] | None:
    """Bars left and right of the break, from their far ends to the break, if known."""
    assert scene.broken is not None
    node, sides = scene.broken[1], scene.rubbing_sides
    bars = []
    for elements in (node, scene.elements - node):
        side = Rods(
            length=scene.length * elements / scene.elements,
            stiffness=scene.stiffness * sides / (sides + 1),
            elements=elements,
            substructures=1,
            instants=scene.instants,
            duration=scene.duration,
            left=End(displacement=np.zeros_like(tension)),
            right=End(force=tension),
            bound=sides * scene.bound[: elements + 1],
        )
        bars.append(closed_form(side))
    left, right = bars
    return None if left is None or right is None else (left, right)


def _tension(scene: Rods) -> Array:
    """T under a rigid grip: a neighbour's elongation is given.

    It is T L / ES, plus for each side of the break what has slipped there over m + 1. The second
    part grows with T, and no faster than the first, so halved steps halve the error at least.
    """
    tension = scene.load
    largest = float(np.abs(tension).max())
    for _ in range(STEPS):
        sides = _sides(scene, tension)
        assert sides is not None  # the bound stays the same
        slipped = sum(side.end_displacement for side in sides)
        softer = scene.stiffness / scene.length * slipped / (scene.rubbing_sides + 1)
        change = 0.5 * (scene.load - tension - softer)
        tension = tension + change
        if float(np.abs(change).max()) <= PRECISION * largest:
            break
    return tension
