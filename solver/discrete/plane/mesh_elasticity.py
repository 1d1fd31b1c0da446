"""Elasticity of meshes with quadratic displacement, by scikit-fem."""

from __future__ import annotations

import numpy as np
import skfem
from scipy import sparse
from skfem.models.elasticity import linear_elasticity

from solver.arrays import Array, Indices
from solver.discrete.plane.meshes import Mesh

EXACT = {
    3: 2,
    4: 4,
}
"""Order of integration that is exact for the stiffness of elements with parallel edges,
by their number of corners."""


def mesh_stiffness(mesh: Mesh, elements: Indices, elastic: Array) -> sparse.csr_array:
    """Stiffness of some elements of a mesh, (2 n_nodes, 2 n_nodes), in N/m per m.

    `elastic` is an `elastic_matrix`, (3, 3), Pa.
    """
    form = linear_elasticity(Lambda=elastic[0, 1], Mu=elastic[2, 2])
    element = skfem.ElementVector(_element(mesh))
    order = EXACT[mesh.elements.shape[1]]
    basis = skfem.Basis(mesh.grid, element, elements=elements, intorder=order)
    return sparse.csr_array(skfem.asm(form, basis))


def mesh_volumes(mesh: Mesh, elements: Indices) -> Array:
    """Area that belongs to each node, of some elements of a mesh, (n_nodes,), m^2."""
    order = EXACT[mesh.elements.shape[1]]
    basis = skfem.Basis(mesh.grid, _element(mesh), elements=elements, intorder=order)
    return np.asarray(skfem.asm(skfem.LinearForm(lambda v, _: 1.0 * v), basis))


def mesh_strains(mesh: Mesh, elements: Indices) -> sparse.csr_array:
    """Matrix from nodal displacements to strains at the centres of some elements.

    Strains xx, yy, 2 xy of each element in turn, shape (3 n_elements, 2 n_nodes), 1/m.
    """
    # The middle of the triangle, or the square, from which elements are mapped.
    middle = np.full((2, 1), 1.0 / 3.0)
    if mesh.elements.shape[1] == 4:
        middle[:] = 0.5
    basis = skfem.Basis(
        mesh.grid,
        skfem.ElementVector(_element(mesh)),
        elements=elements,
        quadrature=(middle, np.ones(1)),
    )
    gradients = [each[0].grad[..., 0] for each in basis.basis]
    (xx, xy), (yx, yy) = np.stack(gradients, axis=-1)
    strains = np.stack([xx, yy, xy + yx])
    size = len(elements)
    rows = np.arange(3 * size).reshape(size, 3).T[:, :, None]
    both = np.broadcast_arrays(rows, basis.element_dofs.T)
    places = both[0].ravel(), both[1].ravel()
    shape = 3 * size, 2 * len(mesh.nodes)
    return sparse.csr_array(sparse.coo_array((strains.ravel(), places), shape))


def _element(mesh: Mesh) -> skfem.Element:
    """Quadratic element of a mesh."""
    if mesh.elements.shape[1] == 4:
        return skfem.ElementQuad2()
    return skfem.ElementTriP2()
