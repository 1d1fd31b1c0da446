"""Closed forms of a pulled bar, and of a broken wire (MATHEMATICS.md, 6, 8, 14).

Under Coulomb friction sliding needs all strength between a section and the free end,
R(x) = integral of mu p from x to L. So the normal force N(x, t) follows the load F(t)
with play R(x), for every strength mu p >= 0 along the bar and every load path from
rest, full sliding included.

Where the strength changes with time this holds as long as the friction force stays
within it, to an element's length: a bar that stuck under more than its strength has
fallen to slips in its middle, which is beyond this closed form.

Unbroken, all wires carry the tension T and nothing slips. A break adds a force n to the
broken wire, -T at its two new ends, which the m neighbours take over in equal shares.
The slip between them is the displacement of a bar of stiffness ES m / (m + 1), under m
times the strength, that is clamped far away and pulled at the break. On a rising load
the broken wire carries min(T, m mu p |x - x_break|): all of T from a distance
T / (m mu p) on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from solver.arrays import ROUNDING, Array
from solver.discrete.rods.end import End
from solver.discrete.rods.rods import Rods
from solver.laws import FrictionLaw
from solver.laws.play import play

SECTIONS = 4096
"""Smallest number of sections over which the strain is integrated along the bar."""
AT_ONCE = 60_000
"""Number of forces, at sections and instants, computed at once: few enough for a
cache."""
STEPS = 100
"""Largest number of steps to the tension under a rigid grip."""
PRECISION = 1e-13
"""Change of the tension, as a share of the largest, at which it is accepted."""


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """The exact solution at positions of nodes, without discretisation in space.

    In time it is exact where the load is monotone between instants.

    Attributes
    ----------
    normal_force
        Axial force N, shape (n_nodes, n_instants), N.
    friction_force
        Friction force on the bar over the tributary length of each node, same shape, N.
        A solution with a clamped node cannot tell it from the reaction there.
    displacement
        Displacement, same shape, m. The integral over the strain has an error below
        1.5e-8 (mu p L) L / ES for each load reversal remembered: 1e-6 of the end's
        displacement from an eighth of mu p L on.
    """

    normal_force: Array
    friction_force: Array
    displacement: Array

    @property
    def end_displacement(self) -> Array:
        """Displacement of the free end, shape (n_instants,), m."""
        return np.asarray(self.displacement[-1])


def closed_form(scene: Rods) -> ClosedForm | None:
    """Solution of a bar whose strength mu p is linear between nodes and instants.

    None for a bar that more than a force at its end moves, or of varying section, where
    friction is not Coulomb's, and where a falling strength makes the bar slip in its
    middle.
    """
    if not scene.is_only_pulled or scene.section is not None:
        return None
    if scene.friction_law != FrictionLaw():
        return None
    free_end = np.zeros_like(scene.strengths[:1])
    slack = np.concatenate([_grip_beyond(scene, 0.0), free_end])
    # Tributary lengths end in the middles of elements, so friction is the difference
    # of the normal force between these.
    between = np.concatenate([slack[:1], _grip_beyond(scene, 0.5), slack[-1:]])
    friction = -np.diff(_normal_force(scene, between), axis=0)
    bound = -np.diff(between, axis=0)
    blurred = ROUNDING * (slack.max() + np.abs(scene.load).max())
    if np.any(np.abs(friction) > bound + blurred):
        return None
    nodal = _normal_force(scene, slack)
    elongation = _mean_normal_force(scene, nodal) * scene.length / scene.elements
    elongation /= scene.stiffness
    displacement = np.zeros_like(nodal)
    np.cumsum(elongation, axis=0, out=displacement[1:])
    return ClosedForm(nodal, friction, displacement)


def _grip_beyond(scene: Rods, share: float | Array) -> Array:
    """Friction R from a section to the end, at a share of each element's length, N.

    Of shares of shape (n_shares, 1, 1): (n_shares, ...).
    """
    size = scene.length / scene.elements
    left = scene.strengths[:-1]
    right = scene.strengths[1:]
    whole = 0.5 * size * (left + right)
    beyond = np.cumsum(whole[::-1], axis=0)[::-1] - whole
    rest = 1.0 - share
    within = 0.5 * size * rest * (rest * left + (1.0 + share) * right)
    return np.asarray(beyond + within)


def _normal_force(scene: Rods, slack: Array) -> Array:
    """Normal force at sections with friction R to the end, (n_sections, n_instants), N.

    The slack has the shape (n_sections, n_instants or 1), N.
    """
    return play(np.broadcast_to(scene.load, (len(slack), len(scene.load))), slack)


def _mean_normal_force(scene: Rods, nodal: Array) -> Array:
    """Mean normal force in each element, (n_elements, n_instants), N.

    By the trapezoidal rule, from that at the nodes, shape (n_nodes, n_instants), N.
    """
    parts = -(-SECTIONS // scene.elements)
    total = 0.5 * (nodal[:-1] + nodal[1:])
    shares = np.arange(1, parts)[:, None, None] / parts
    size = max(AT_ONCE // nodal.size, 1)
    for first in range(0, parts - 1, size):
        slack = _grip_beyond(scene, shares[first : first + size])
        forces = _normal_force(scene, slack.reshape(-1, slack.shape[-1]))
        total += forces.reshape(-1, *total.shape).sum(axis=0)
    mean: Array = total / parts
    return mean


def pulled_compliant_bar(
    force: float, length: float, stiffness: float, strength: float, density: float
) -> tuple[float, float]:
    """End displacement of a bar on a compliant support, and its zone of slip, m.

    With beta the root of the springs' density over ES, a zone of length s at the end
    slips under F = q s + q / (beta tanh(beta (L - s))), and beyond it the bar stands on
    springs.

    Parameters
    ----------
    force, length, stiffness
        F, N, grown from zero, at most what a bar that slips almost throughout carries;
        L, m; ES, N.
    strength, density
        q = mu p, N/m; tangential stiffness of the support per length, N/m^2.
    """
    beta = np.sqrt(density / stiffness)

    def carried(zone: float) -> float:
        on_springs = strength / (beta * np.tanh(beta * (length - zone)))
        return float(strength * zone + on_springs)

    if force <= carried(0.0):
        return float(force * np.tanh(beta * length) / (stiffness * beta)), 0.0
    # A zone as long as the bar would carry an infinite force.
    zone = float(
        scipy.optimize.brentq(lambda s: carried(s) - force, 0.0, length * (1.0 - 1e-12))
    )
    elongation = (force * zone - 0.5 * strength * zone**2) / stiffness
    return float(strength / density + elongation), zone


def pulled_changing_bar(
    force: float, stiffness: float, strength: float, ratio: float, slip_length: float
) -> float:
    """End displacement, m, under a growing force, where friction changes with slip.

    It holds while no point has slipped farther than friction changes (MATHEMATICS.md,
    14).

    Parameters
    ----------
    force, stiffness
        F, N: less than what makes all of the bar slip, and than q / gamma where it
        softens; ES, N.
    strength, ratio, slip_length
        q before any slip, N/m; the last strength over it, not 1; and the slip from
        which on it is the last, m: more than what is returned.
    """
    slope = strength * (ratio - 1.0) / slip_length
    gamma = np.sqrt(abs(slope) / stiffness)
    share = force * gamma / strength
    if slope > 0.0:
        return float(strength / slope * (np.sqrt(1.0 + share**2) - 1.0))
    return float(strength / -slope * (1.0 - np.sqrt(1.0 - share**2)))


@dataclass(frozen=True, eq=False)
class BrokenWire:
    """The exact solution at the nodes, without discretisation in space.

    Attributes
    ----------
    force, neighbour_force
        Axial force of the broken wire and of each neighbour, shape (n_nodes,
        n_instants), N.
    friction_force
        Friction force on the broken wire over the tributary length of each node, both
        sides together, shape (n_nodes + 1, n_instants), N; the break has two nodes. At
        a held end it cannot be told from the reaction.
    slip
        Slip: displacement of the broken wire relative to its neighbours, same shape, m.
    """

    force: Array
    neighbour_force: Array
    friction_force: Array
    slip: Array


def broken_wire(scene: Rods) -> BrokenWire | None:
    """Solution of a strand with a broken wire.

    Returns
    -------
    The solution. None where no wire is broken; where its neighbours rub on others, too,
    and pass on what they took over; where friction is not Coulomb's, or not the same
    between all wires; or where the strength changes with time, and the grip is rigid or
    wires slip away from the break.
    """
    if scene.friction_law != FrictionLaw() or np.any(scene.factors != 1.0):
        return None
    if scene.broken is None or scene.rubbing_sides != scene.wires - 1:
        return None
    if scene.right.is_prescribed and scene.strength.ndim > 1:
        return None
    if scene.right.is_prescribed:
        tension = _tension(scene)
    else:
        tension = scene.load
    sides = _sides(scene, tension)
    if sides is None:
        return None
    left, right = sides
    lost = np.concatenate([left.normal_force, right.normal_force[-2::-1]])
    return BrokenWire(
        force=tension - lost,
        neighbour_force=tension + lost / scene.rubbing_sides,
        friction_force=np.concatenate(
            [-left.friction_force, right.friction_force[::-1]]
        ),
        slip=np.concatenate([-left.displacement, right.displacement[::-1]]),
    )


def _sides(scene: Rods, tension: Array) -> tuple[ClosedForm, ClosedForm] | None:
    """Bars left and right of the break, from far end to break; None if unknown."""
    assert scene.broken is not None
    node = scene.broken[1]
    sides = scene.rubbing_sides
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
            strength=sides * scene.strength[: elements + 1],
        )
        bars.append(closed_form(side))
    left, right = bars
    if left is None or right is None:
        return None
    return (left, right)


def _tension(scene: Rods) -> Array:
    """Tension T under a prescribed elongation of a rigid grip, (n_instants,), N.

    The elongation is T L / ES, plus for each side of the break the slip there over
    m + 1. That slip grows with T no faster than T L / ES, so a step of half the
    residual halves the error at least.
    """
    tension = scene.load
    largest = float(np.abs(tension).max())
    for _ in range(STEPS):
        sides = _sides(scene, tension)
        assert sides is not None  # the strength stays the same
        slipped = sum(side.end_displacement for side in sides)
        softer = scene.stiffness / scene.length * slipped / (scene.rubbing_sides + 1)
        change = 0.5 * (scene.load - tension - softer)
        tension = tension + change
        if float(np.abs(change).max()) <= PRECISION * largest:
            break
    return tension
