"""A start from coarser meshes: what is global is found where an iteration is cheap."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from solver.discrete.problem import Array, Indices, Problem
from solver.laws import Friction
from solver.reference.assembly import assembled_stiffness


def prolong(coarse: Problem, displacement: Array, force: Array, fine: Problem, k: Array) -> Array:
    """Carry the solution of a coarser mesh to a finer one.

    Displacement and friction force per length are linear between the coarse nodes of a body; the
    forces on cuts and ends are those that the displacement needs inside each substructure.

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
    bodies, fine_bodies = _bodies(coarse), _bodies(fine)
    inside = _interpolated(
        _apart(fine, fine_bodies),
        _apart(coarse, bodies),
        np.asarray(coarse.mean_of_rows @ displacement),
    )
    found = inside[fine.row_dofs]
    carried = np.zeros_like(found)
    for name, target in fine.rubbing.items():
        law = coarse.rubbing[name]
        assert isinstance(law, Friction)
        assert isinstance(target, Friction)
        density = law.by_point(force[law.rows]) / law.by_point(law.weights)[:, None]
        spread = _interpolated(
            _points_apart(fine, target, fine_bodies), _points_apart(coarse, law, bodies), density
        )
        carried[target.rows] = spread[target.points] * target.weights[:, None]
        if target.below is not None:
            carried[target.below] = -carried[target.rows]
    rubs = np.zeros(fine.n_rows, dtype=bool)
    rubs[fine.sliding[0]] = True
    for part in fine.substructures:
        needed = part.elasticity.stiffness @ inside[part.dofs]
        if part.body_force is not None:
            needed -= part.body_force
        trace = part.elasticity.trace
        np.subtract.at(needed, trace[rubs[part.rows]], carried[part.rows[rubs[part.rows]]])
        others = ~rubs[part.rows]
        carried[part.rows[others]] = needed[trace[others]]
    return np.asfortranarray(found + carried / k[:, None])


def _bodies(problem: Problem) -> Indices:
    """Give the number of the body that every degree of freedom belongs to, from 0 on."""
    links = sparse.csr_array(abs(assembled_stiffness(problem)) > 0.0)
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.intp)


def _apart(problem: Problem, bodies: Indices) -> Array:
    """Give the positions, with bodies laid end to end so that none touches the next."""
    return np.asarray(problem.positions + 2.0 * problem.scales.displacement * bodies)


def _points_apart(problem: Problem, law: Friction, bodies: Indices) -> Array:
    """Give the positions of an interface's points, those of other bodies apart."""
    above = bodies[problem.row_dofs[law.rows]]
    below = 0 if law.below is None else bodies[problem.row_dofs[law.below]]
    numbers = np.zeros(len(law.positions), dtype=np.intp)
    numbers[law.points] = above + below
    return law.positions + 2.0 * problem.scales.displacement * numbers


def _interpolated(fine: Array, coarse: Array, values: Array) -> Array:
    """Interpolate in space, linear between the coarse positions; values (n_coarse, n_instants)."""
    right = np.clip(np.searchsorted(coarse, fine), 1, len(coarse) - 1)
    share = (fine - coarse[right - 1]) / (coarse[right] - coarse[right - 1])
    share = np.clip(share, 0.0, 1.0)[:, None]
    return np.asarray(values[right - 1] * (1.0 - share) + values[right] * share)
