"""Rigid motions of bodies in the plane, as far as nothing that is prescribed holds them."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, Indices

HELD = 1e-9
"""Singular value, beside that of a translation, from which on what is prescribed hinders."""


def rigid_motions(
    positions: Array, components: Indices, bodies: Indices, fixed: Indices
) -> Array | None:
    """Independent rigid motions that move nothing prescribed, or None if there are none.

    Parameters
    ----------
    positions, components, bodies
        Of every degree of freedom: its place, shape (n_dofs, 2), in units of a body's length; 0
        where it moves along x, 1 along y; and its body, shape (n_dofs,).
    fixed
        Degrees of freedom with prescribed displacement.

    Returns
    -------
    Shape (n_dofs, n_motions).
    """
    found = []
    for body in np.unique(bodies):
        own = np.flatnonzero(bodies == body)
        along = components[own] == 0
        x, y = (positions[own] - positions[own].mean(axis=0)).T
        modes = np.stack([along, ~along, np.where(along, -y, x)], axis=1).astype(float)
        _, sizes, ways = np.linalg.svd(modes[np.isin(own, fixed)], full_matrices=True)
        hindered = np.count_nonzero(sizes > HELD)
        whole = np.zeros((len(components), 3 - hindered))
        whole[own] = modes @ ways[hindered:].T
        found.append(whole)
    motions = np.concatenate(found, axis=1)
    return motions if motions.size else None
