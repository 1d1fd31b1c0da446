"""Elasticity of meshes with quadratic displacement, by scikit-fem."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.discrete.elements import assembled, dofs_of
from solver.discrete.plane.meshes import Mesh

if TYPE_CHECKING:
    import skfem


@cache
def _exact(corners: int) -> tuple[Array, Array]:
    """Points, (2, n), and weights, (n,), of the integration of elements.

    Exact for the stiffness of elements with parallel edges, of a number of corners.
    """
    import skfem
    from skfem.quadrature import get_quadrature

    if corners == 3:
        quadrature = get_quadrature(skfem.ElementTriP2.refdom, 2)
    else:
        quadrature = get_quadrature(skfem.ElementQuad2.refdom, 4)
    points, weights = quadrature
    return points, weights


def quadratic_basis(mesh: Mesh, elements: Indices) -> skfem.Basis:
    """Quadratic functions of some elements of a mesh, at points of integration."""
    return _basis(mesh, elements, _exact(mesh.elements.shape[1]))


def mesh_stiffness(
    basis: skfem.Basis, nodes: Indices, elastic: Array
) -> sparse.csr_array:
    """Stiffness of the elements of a basis, (2 n_nodes, 2 n_nodes), in N/m per m.

    `nodes` are numbers of their nodes in the mesh, ascending, (n_nodes,), `elastic` is
    an `elastic_matrix`, (3, 3), Pa.
    """
    strains = _strains(basis)
    stresses = np.einsum("ab,bieq,eq->aieq", elastic, strains, basis.dx)
    blocks = np.einsum("aieq,ajeq->ije", strains, stresses, optimize=True)
    dofs = dofs_of(np.searchsorted(nodes, basis.element_dofs.T)).T
    size = 2 * len(nodes)
    return assembled(blocks, dofs[:, None], dofs, (size, size))


def mesh_volumes(basis: skfem.Basis) -> Array:
    """Area that belongs to each node of a mesh, of a basis of it, (n_nodes,), m^2."""
    shares = [(each[0] * basis.dx).sum(axis=1) for each in basis.basis]
    nodes = basis.element_dofs.ravel()
    areas = np.bincount(nodes, np.concatenate(shares), minlength=basis.N)
    return np.asarray(areas, dtype=float)


def mesh_strains(mesh: Mesh, elements: Indices, nodes: Indices) -> sparse.csr_array:
    """Matrix from nodal displacements to strains at the centres of some elements.

    Strains xx, yy, 2 xy of each element in turn, shape (3 n_elements, 2 n_nodes), 1/m.
    `nodes` are numbers of their nodes in the mesh, ascending, (n_nodes,).
    """
    # The middle of the triangle, or the square, from which elements are mapped.
    middle = np.full((2, 1), 1.0 / 3.0)
    if mesh.elements.shape[1] == 4:
        middle[:] = 0.5
    basis = _basis(mesh, elements, (middle, np.ones(1)))
    strains = _strains(basis)[..., 0].swapaxes(1, 2)
    size = len(elements)
    rows = np.arange(3 * size).reshape(size, 3).T[:, :, None]
    dofs = dofs_of(np.searchsorted(nodes, basis.element_dofs.T)).T
    return assembled(strains, rows, dofs.T, (3 * size, 2 * len(nodes)))


def _strains(basis: skfem.Basis) -> Array:
    """Strains xx, yy, 2 xy by motions of the functions of a basis along x and y.

    Shape (3, 2 n_functions, n_elements, n_points): along x and y of each function.
    """
    along_x, along_y = np.stack([each[0].grad for each in basis.basis], axis=1)
    strains = np.zeros((3, len(along_x), 2, *along_x.shape[1:]))
    strains[0, :, 0] = along_x
    strains[1, :, 1] = along_y
    strains[2, :, 0] = along_y
    strains[2, :, 1] = along_x
    return strains.reshape(3, -1, *along_x.shape[1:])


def _basis(
    mesh: Mesh, elements: Indices, quadrature: tuple[Array, Array]
) -> skfem.Basis:
    """Quadratic functions of some elements at points with weights in the element."""
    # Structures without meshes do not pay for the import.
    import skfem

    kind = skfem.ElementTriP2
    if mesh.elements.shape[1] == 4:
        kind = skfem.ElementQuad2
    # Positions of degrees of freedom are those of the nodes of the mesh.
    return skfem.Basis(
        mesh.grid,
        kind(),
        elements=elements,
        quadrature=quadrature,
        disable_doflocs=True,
    )
