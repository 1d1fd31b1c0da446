"""What is asked of the inside of condensed substructures."""

from __future__ import annotations

from typing import Protocol

from solver.arrays import Array, Indices


class Inside(Protocol):
    """What lies inside condensed substructures, found when somebody looks.

    Attributes
    ----------
    nodes
        Coordinates of all nodes, shape (n_nodes, 2), m.
    elements
        Corners of every element, counter-clockwise, shape (n_elements, 4); a biquadratic one counts
        as its four quarters.
    bodies, parts
        Body and substructure of every element, shape (n_elements,).
    components
        Of every degree of freedom of the problem, 0 along x and 1 along y, shape (n_dofs,).
    """

    nodes: Array
    elements: Indices
    bodies: Indices
    parts: Indices
    components: Indices

    def displacement(self, skeleton: Array, instants: slice | list[int]) -> Array:
        """Displacement of all nodes, shape (n_nodes, 2, n), m.

        Parameters
        ----------
        skeleton
            Displacement of the problem's degrees of freedom, (n_dofs, n_instants), m.
        instants
            Which of them.
        """

    def adjoint(self, weights: Array) -> tuple[Array, Array]:
        """Bring a weighted sum of all nodes' displacements onto the degrees of freedom.

        Parameters
        ----------
        weights
            Shape (n_nodes, 2).

        Returns
        -------
        Weights of the problem's degrees of freedom, shape (n_dofs,), and what loads inside add,
        shape (n_instants,), m.
        """

    def stress(self, displacement: Array) -> Array:
        """Stresses (xx, yy, xy) at element centres, shape (n_elements, 3), Pa.

        `displacement` is that of all nodes at one instant, shape (n_nodes, 2), m.
        """
