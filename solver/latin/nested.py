"""A start from coarser meshes: what is global is found where an iteration is cheap."""

from __future__ import annotations

import numpy as np

from solver.discrete.problem import Array, Problem


def prolong(coarse: Problem, displacement: Array, force: Array, fine: Problem, k: Array) -> Array:
    """Carry the solution of a coarser mesh to a finer one.

    Displacement and friction force per length are linear between the coarse nodes; the forces on
    cuts and ends are those that the displacement needs inside each substructure.

    Parameters
    ----------
    coarse, fine
        The same structure on two meshes, at the same instants; however it is cut.
    displacement, force
        W and F of the coarse rows, shape (n_rows of coarse, n_instants), scaled.
    k
        Search direction of the fine rows, shape (n_rows of fine,).

    Returns
    -------
    W + F/k, shape (n_rows of fine, n_instants).
    """
    inside = _interpolated(
        fine.positions, coarse.positions, np.asarray(coarse.mean_of_rows @ displacement)
    )
    law, target = coarse.friction, fine.friction
    density = np.asarray(coarse.sum_of_contact @ force) / law.by_point(law.weights)[:, None]
    spread = _interpolated(target.positions, law.positions, density)
    found = inside[fine.row_dofs]
    carried = np.zeros_like(found)
    carried[target.rows] = spread[target.points] * target.weights[:, None]
    rubs = np.zeros(fine.n_rows, dtype=bool)
    rubs[target.rows] = True
    for part in fine.substructures:
        needed = part.elasticity.stiffness @ inside[part.dofs]
        if part.body_force is not None:
            needed -= part.body_force
        trace = part.elasticity.trace
        np.subtract.at(needed, trace[rubs[part.rows]], carried[part.rows[rubs[part.rows]]])
        others = ~rubs[part.rows]
        carried[part.rows[others]] = needed[trace[others]]
    return np.asfortranarray(found + carried / k[:, None])


def _interpolated(fine: Array, coarse: Array, values: Array) -> Array:
    """Interpolate in space, linear between the coarse positions; values (n_coarse, n_instants)."""
    right = np.clip(np.searchsorted(coarse, fine), 1, len(coarse) - 1)
    share = (fine - coarse[right - 1]) / (coarse[right] - coarse[right - 1])
    share = np.clip(share, 0.0, 1.0)[:, None]
    return np.asarray(values[right - 1] * (1.0 - share) + values[right] * share)
