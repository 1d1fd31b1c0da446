"""The fields of a coarser mesh, carried to a finer one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.discrete.substructure import Substructure
from solver.laws import Contact

BoolArray = NDArray[np.bool_]


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
    row_of_dof = np.zeros(coarse.n_dofs, dtype=np.intp)
    row_of_dof[coarse.row_dofs] = np.arange(coarse.n_rows)
    bodies, fine_bodies = _bodies(coarse), _bodies(fine)
    inside = _interpolated(
        _apart(fine, fine_bodies), _apart(coarse, bodies), displacement[row_of_dof]
    )
    found = inside[fine.row_dofs]
    carried = np.zeros_like(found)
    for name, target in fine.rubbing.items():
        law = coarse.rubbing[name]
        density = law.by_point(force[law.tangent.above]) / law.by_point(law.weights)[:, None]
        spread = _interpolated(
            _points_apart(fine, target, fine_bodies), _points_apart(coarse, law, bodies), density
        )
        shared = spread[target.points] * target.weights[:, None]
        for rows, sign in zip(target.tangent.sides, (1.0, -1.0), strict=False):
            carried[rows] = sign * shared
    rubs = np.zeros(fine.n_rows, dtype=bool)
    rubs[fine.sliding[0]] = True
    alike: dict[int, list[Substructure]] = {}
    for part in fine.substructures:
        alike.setdefault(id(part.elasticity), []).append(part)
    for parts in alike.values():
        _balance(parts, inside, rubs, carried)
    return np.asfortranarray(found + carried / k[:, None])


def _bodies(problem: Problem) -> Indices:
    """Give the number of the body that every degree of freedom belongs to, from 0 on."""
    if len(problem.rubbing) == 1 and problem.friction.is_on_support:
        return np.zeros(problem.n_dofs, dtype=np.intp)
    parts, n_dofs = problem.substructures, problem.n_dofs
    dofs = np.concatenate([part.dofs for part in parts])
    number = n_dofs + np.repeat(np.arange(len(parts)), [len(part.dofs) for part in parts])
    links = sparse.csr_array((np.ones(len(dofs)), (dofs, number)), shape=(n_dofs + len(parts),) * 2)
    return np.asarray(connected_components(links, directed=False)[1][:n_dofs], dtype=np.intp)


def _apart(problem: Problem, bodies: Indices) -> Array:
    """Give the positions, with bodies laid end to end so that none touches the next."""
    return np.asarray(problem.positions + 2.0 * problem.scales.displacement * bodies)


def _points_apart(problem: Problem, law: Contact, bodies: Indices) -> Array:
    """Give the positions of an interface's points, those of other bodies apart."""
    numbers = np.zeros(len(law.positions), dtype=np.intp)
    numbers[law.points] = sum(bodies[problem.row_dofs[rows]] for rows in law.tangent.sides)
    return law.positions + 2.0 * problem.scales.displacement * numbers


def _balance(parts: list[Substructure], inside: Array, rubs: BoolArray, carried: Array) -> None:
    """Write into `carried` the forces of cuts and ends that identical substructures need."""
    elasticity = parts[0].elasticity
    rows = np.stack([part.rows for part in parts], axis=1)
    dofs = np.stack([part.dofs for part in parts], axis=1)
    frictional = rubs[rows[:, 0]]
    trace = elasticity.trace[~frictional]
    shape = (len(trace), *inside[dofs].shape[1:])
    needed = (elasticity.stiffness[trace] @ inside[dofs].reshape(len(dofs), -1)).reshape(shape)
    for number, part in enumerate(parts):
        if part.body_force is not None:
            needed[:, number] -= part.body_force[trace]
    meet = (trace[:, None] == elasticity.trace[frictional]).astype(float)
    friction = carried[rows[frictional]]
    needed -= (meet @ friction.reshape(len(friction), -1)).reshape(shape)
    carried[rows[~frictional]] = needed


def _interpolated(fine: Array, coarse: Array, values: Array) -> Array:
    """Interpolate in space, linear between the coarse positions; values (n_coarse, n_instants)."""
    right = np.clip(np.searchsorted(coarse, fine), 1, len(coarse) - 1)
    share = (fine - coarse[right - 1]) / (coarse[right] - coarse[right - 1])
    share = np.clip(share, 0.0, 1.0)[:, None]
    return np.asarray(values[right - 1] * (1.0 - share) + values[right] * share)
