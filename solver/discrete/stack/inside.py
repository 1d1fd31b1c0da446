"""What lies inside the condensed substructures of stacked bodies."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.stack.data import StackData
from solver.discrete.stack.parts import Grid, Part


class StackInside:
    """What lies inside the substructures of a stack, as `problem.Inside` says."""

    def __init__(self, scene: StackData, parts: list[Part], grid: Grid, skeleton: Indices) -> None:
        self._parts = parts
        self._young = scene.young
        self._length = scene.length
        self.nodes: Array = grid.positions * scene.length
        self.elements: Indices = np.concatenate(
            [part.nodes.ravel()[part.rectangle.cells] for part in parts]
        )
        sizes = [len(part.rectangle.cells) for part in parts]
        self.parts: Indices = np.repeat(np.arange(len(parts)), sizes)
        self.bodies: Indices = np.repeat([part.place[2] for part in parts], sizes)
        self.components: Indices = skeleton % 2
        self._places = [np.searchsorted(skeleton, part.dofs) for part in parts]
        self._size = len(skeleton), len(scene.instants)

    def displacement(self, skeleton: Array, instants: slice | list[int]) -> Array:
        """Give the displacement of all nodes, shape (n_nodes, 2, n), m."""
        chosen = skeleton[:, instants] / self._length
        found = np.zeros((len(self.nodes), 2, chosen.shape[1]))
        for part, places in zip(self._parts, self._places, strict=True):
            force = None if part.force is None else part.force[:, instants]
            found[part.nodes.ravel()] = part.kept.recover(chosen[places], force)
        return found * self._length

    def adjoint(self, weights: Array) -> tuple[Array, Array]:
        """Bring a weighted sum of all nodes' displacements onto the degrees of freedom."""
        found, constant = np.zeros(self._size[0]), np.zeros(self._size[1])
        # Substructures share the nodes on their cuts.
        counts = np.bincount(np.concatenate([part.nodes.ravel() for part in self._parts]))
        shares = weights / counts[:, None]
        for part, places in zip(self._parts, self._places, strict=True):
            own = shares[part.nodes.ravel()].reshape(-1, 1)
            if own.any():
                np.add.at(found, places, part.kept.condense(own)[:, 0])
                if part.force is not None:
                    still = np.zeros((len(places), self._size[1]))
                    inner = part.kept.recover(still, part.force).reshape(len(own), -1)
                    constant += own[:, 0] @ inner
        return found, constant * self._length

    def stress(self, displacement: Array) -> Array:
        """Give stresses (xx, yy, xy) at element centres, shape (n_elements, 3), Pa."""
        scaled = displacement / self._length
        return self._young * np.concatenate(
            [part.rectangle.stress(scaled[part.nodes.ravel()]) for part in self._parts]
        )
