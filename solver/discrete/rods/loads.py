"""Loads of a rod, as its support sees them, and the length that they let slide."""

from __future__ import annotations

import numpy as np
from numpy.linalg import LinAlgError
from scipy.linalg import solveh_banded

from solver.arrays import Array
from solver.discrete.rods.end import End
from solver.discrete.rods.rods import Rods

FEWEST = 3
"""Fewest elements of a rod that has two nodes between clamped ends."""


def force_of_strains(rods: Rods, stiffness: Array) -> Array | None:
    """Axial force equivalent to the strains of heat and settlement in elements.

    Shape (n_elements, n_instants), scaled as `stiffness`, (n_elements,); None where
    nothing strains them.
    """
    strain = rods.strain
    if rods.settlement is not None:
        # Seen from a support that moves by s, a rod is as if it shrank by ds/dx.
        moved = np.diff(rods.settlement, axis=0) * (rods.elements / rods.length)
        if strain is None:
            strain = -moved
        else:
            strain = strain - moved
    if strain is None:
        return None
    return strain * stiffness[:, None]


def displacement_of(end: End, rods: Rods, node: int) -> Array:
    """Displacement of an end's clamp or spring, seen from the support at a node.

    Shape (n_instants,), m.
    """
    assert end.displacement is not None
    if rods.settlement is None:
        return end.displacement
    return np.asarray(end.displacement - rods.settlement[node])


def sliding_length(rods: Rods) -> float:
    """Length over which the displacement of a rod without friction varies, m.

    That is sqrt(3) |u| / |u'| at the instant of the largest load: the whole length of a
    rod that is pulled at its end, and 0.28 of a wavelength where u is a wave. The whole
    length, too, where nothing moves, nothing but friction holds the rod, or a mesh of
    one or two elements tells nothing. Between two ends whose displacement is given at
    most half the length: half a wave fits there, behind one such end a quarter.
    """
    longest = rods.length
    if all(end.is_prescribed for end in rods.ends.values()):
        longest *= 0.5
    is_held = any(end.displacement is not None for end in rods.ends.values())
    if not is_held or rods.elements < FEWEST:
        return longest
    try:
        moved = _motion_without_friction(rods)
    except LinAlgError:
        # A spring as soft as rounding holds no more than friction does.
        return longest
    largest = float(np.abs(moved).max())
    if largest == 0.0:
        return longest
    moved /= largest
    strain = np.diff(moved) * (rods.elements / rods.length)
    # A soft spring moves a rod as a whole.
    least = np.sqrt(3.0) * np.linalg.norm(moved) / rods.length
    varying = rods.length * float(least / max(least, np.linalg.norm(strain)))
    return min(varying, longest)


def _motion_without_friction(rods: Rods) -> Array:
    """Displacement of a rod that an end holds, without friction, (n_nodes,), m.

    At the instant of the largest force on a node.
    """
    stiffness = np.full(rods.elements, rods.stiffness * rods.elements / rods.length)
    if rods.section is not None:
        stiffness *= rods.section
    before = np.append(0.0, stiffness)
    diagonal = np.append(stiffness, 0.0) + before
    force = _force_along(rods, stiffness)
    held = np.zeros_like(force)
    for node, beside, end in ((0, 1, rods.left), (-1, -2, rods.right)):
        if end.is_prescribed:
            held[node] = displacement_of(end, rods, node)
            force[beside] += stiffness[node] * held[node]
        elif end.force is not None:
            force[node] += end.force
        elif end.is_on_spring:
            diagonal[node] += end.spring
            force[node] += end.spring * displacement_of(end, rods, node)
    first = int(rods.left.is_prescribed)
    free = slice(first, len(force) - int(rods.right.is_prescribed))
    largest = int(np.argmax(np.abs(force[free]).max(axis=0)))
    bands = np.stack([-before, diagonal])[:, free]
    moved: Array = held[:, largest]
    moved[free] = solveh_banded(bands, force[free, largest])
    return moved


def _force_along(rods: Rods, stiffness: Array) -> Array:
    """Forces of loads along a rod on its nodes, shape (n_nodes, n_instants), N.

    `stiffness` is that of the elements, (n_elements,), N/m.
    """
    element = rods.length / rods.elements
    force = np.zeros((rods.elements + 1, len(rods.instants)))
    if rods.body_force is not None:
        shares = np.full(rods.elements + 1, element)
        shares[[0, -1]] *= 0.5
        force += shares[:, None] * rods.body_force
    strained = force_of_strains(rods, stiffness * element)
    if strained is not None:
        force -= np.diff(strained, axis=0, prepend=0.0, append=0.0)
    return force
