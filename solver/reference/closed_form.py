"""The friction bar in closed form: its normal force is a play operator (solver/README.md, 6).

Sliding needs the whole bound between a section and the free end, R(x) = integral of mu p from x to
L. So the normal force N(x, t) follows the load F(t) with play R(x): on a rising load it is the
larger of its old value and F - R, on a falling one the smaller of its old value and F + R. This
holds for every bound mu p >= 0 along the bar and every load path from rest, full sliding included,
and gives the loading, unloading and reloading formulas of solver/README.md, 6 for a uniform bound.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.discrete.rods_data import RodsData
from solver.laws import Coulomb
from solver.laws.play import play

SECTIONS = 4096
"""Sections, at least, over which the strain is integrated along the bar."""
AT_ONCE = 60_000
"""Forces, at sections and instants, that are found in one go: few enough to stay in a cache."""


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """The exact solution at the nodes of a mesh, without discretisation in space.

    In time it is exact where the load is monotone between instants.

    Attributes
    ----------
    normal_force
        Axial force N, shape (n_nodes, n_instants), N.
    friction_force
        Friction force on the bar over the tributary length of each node, same shape, N. At the
        clamp it is that of the first half element, which a solution with a clamped node cannot
        tell from the reaction.
    displacement
        Same shape, m. The integral over the strain has an error below 1.5e-8 (mu p L) L / ES for
        each load reversal remembered: 1e-6 of the end's displacement from an eighth of mu p L on.
    """

    normal_force: Array
    friction_force: Array
    displacement: Array

    @property
    def end_displacement(self) -> Array:
        """Displacement of the free end, shape (n_instants,), m."""
        found: Array = self.displacement[-1]
        return found


def closed_form(scene: RodsData) -> ClosedForm | None:
    """Solve the friction bar in closed form (solver/README.md, 6).

    Parameters
    ----------
    scene
        The bar; its bound mu p is linear between nodes.

    Returns
    -------
    The solution, or None for a bar whose support moves or that carries body forces: there, the
    normal force is no play operator of the load. Also None for a bar of varying section, and
    where friction is not Coulomb's.
    """
    if scene.support is not None or scene.body_force is not None or scene.section is not None:
        return None
    if scene.friction_law != Coulomb():
        return None
    nodal = _normal_force(scene, _grip_beyond(scene, 0.0, with_end=True))
    middle = _normal_force(scene, _grip_beyond(scene, 0.5))
    sections = np.concatenate([nodal[:1], middle, nodal[-1:]])
    elongation = _mean_normal_force(scene, nodal) * scene.length / scene.elements / scene.stiffness
    displacement = np.zeros_like(nodal)
    np.cumsum(elongation, axis=0, out=displacement[1:])
    return ClosedForm(nodal, -np.diff(sections, axis=0), displacement)


def _grip_beyond(scene: RodsData, share: float | Array, *, with_end: bool = False) -> Array:
    """Give R at a share of every element's length, shape (n_elements,), N; then at L if wanted.

    Of shares of shape (n_shares, 1) it gives (n_shares, n_elements).
    """
    size = scene.length / scene.elements
    left, right = scene.bound[:-1], scene.bound[1:]
    whole = 0.5 * size * (left + right)
    beyond = np.cumsum(whole[::-1])[::-1] - whole
    rest = 1.0 - share
    found = beyond + 0.5 * size * rest * (rest * left + (1.0 + share) * right)
    return np.append(found, 0.0) if with_end else found


def _normal_force(scene: RodsData, reach: Array) -> Array:
    return play(np.broadcast_to(scene.load, (len(reach), len(scene.load))), reach)


def _mean_normal_force(scene: RodsData, nodal: Array) -> Array:
    """Average over each element, shape (n_elements, n_instants), by the trapezoidal rule."""
    parts = -(-SECTIONS // scene.elements)
    total = 0.5 * (nodal[:-1] + nodal[1:])
    shares = np.arange(1, parts)[:, None] / parts
    size = max(AT_ONCE // nodal.size, 1)
    for first in range(0, parts - 1, size):
        reach = _grip_beyond(scene, shares[first : first + size])
        forces = _normal_force(scene, reach.ravel())
        total += forces.reshape(-1, *total.shape).sum(axis=0)
    mean: Array = total / parts
    return mean
