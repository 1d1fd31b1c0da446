"""A strand of helical wires as a discrete problem: rods, each on a support of its own.

Degrees of freedom run along wire after wire; each is what the wire slips on its support. Ends are
held: neither an extreme fibre slips, nor what a clamp grips. So friction there could not be told
from the reactions, and they are no points of the interfaces, one a wire, "wire LAYER.NUMBER".
Lengths are scaled by the longest wire, forces by E A of the stiffest (solver/README.md, 1).
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem, Scales
from solver.discrete.rod import rod_stiffness, substructure_sizes, tributary
from solver.discrete.rope.data import RopeData, RopeWire
from solver.discrete.substructure import Elasticity, Substructure
from solver.laws import Component, Contact, Dirichlet, Interface, Perfect, Rod


class _Cuts:
    """How wires are cut, all alike, and the numbers of their rows.

    Rows are ordered by law: those that rub, wire after wire and piece after piece, then all left
    ends and all right ends, piece after piece.

    Attributes
    ----------
    sizes, starts
        Elements and first nodes of the pieces.
    rubbing
        Nodes of each piece that rub, numbered from its first.
    left, right
        Rows of the ends, shape (n_pieces, n_wires).
    """

    def __init__(self, scene: RopeData) -> None:
        self.sizes = substructure_sizes(scene.elements, scene.substructures)
        self.starts = np.concatenate([[0], np.cumsum(self.sizes)[:-1]])
        self.rubbing = [np.arange(size + 1) for size in self.sizes]
        self.rubbing[0] = self.rubbing[0][1:]
        self.rubbing[-1] = self.rubbing[-1][:-1]
        self._before = np.concatenate([[0], np.cumsum([len(own) for own in self.rubbing])])
        n_wires, count = len(scene.wires), len(self.sizes)
        first = n_wires * self._before[-1]
        ends = first + np.arange(2 * count * n_wires).reshape(2, count, n_wires)
        self.left, self.right = ends

    @property
    def nodes(self) -> Indices:
        """Node of every pair of one wire; a cut's has two."""
        return np.concatenate(
            [start + own for start, own in zip(self.starts, self.rubbing, strict=True)]
        )

    def rubs(self, wire: int) -> Indices:
        """Give the rows of a wire on its support."""
        size = int(self._before[-1])
        return np.arange(wire * size, (wire + 1) * size)

    def rows(self, wire: int, piece: int) -> Indices:
        """Give the rows of one piece: on the support, and its ends."""
        own = slice(self._before[piece], self._before[piece + 1])
        ends = [self.left[piece, wire], self.right[piece, wire]]
        return np.concatenate([self.rubs(wire)[own], ends])


def discretise_rope(scene: RopeData) -> Problem:
    """Cut all wires alike and write the laws of their interfaces.

    The search direction of cuts and ends is E A / l_sub of the wire, that of the points which rub
    its density over the length of an element (`discretise_rods`).
    """
    cuts = _Cuts(scene)
    shared: dict[tuple[object, ...], Elasticity] = {}
    parts = []
    for place, wire in enumerate(scene.wires):
        force = wire.helix.body_force(wire.arc, wire.curvature) / scene.stiffness
        parts += [
            _substructure(scene, cuts, place, piece, force, shared)
            for piece in range(len(cuts.sizes))
        ]
    return Problem(
        substructures=tuple(parts),
        interfaces=_interfaces(scene, cuts),
        positions=np.concatenate([wire.along for wire in scene.wires]),
        instants=scene.instants,
        scales=Scales(scene.length, scene.stiffness, scene.duration),
    )


def _substructure(
    scene: RopeData,
    cuts: _Cuts,
    place: int,
    piece: int,
    force: Array,
    shared: dict[tuple[object, ...], Elasticity],
) -> Substructure:
    wire, size, start = scene.wires[place], cuts.sizes[piece], int(cuts.starts[piece])
    element = wire.length / scene.elements
    rubbing = cuts.rubbing[piece]
    scaled = wire.helix.stiffness / scene.stiffness * scene.length / element
    key = size, len(rubbing), int(rubbing[0]) if len(rubbing) else -1, scaled
    if key not in shared:
        trace = np.concatenate([rubbing, [0, size]])
        direction = np.full(len(trace), scaled / size)
        direction[:-2] /= size
        shared[key] = Elasticity(rod_stiffness(size, scaled), trace, direction)
    first = place * (scene.elements + 1) + start
    body = tributary(size, element)[:, None] * force[start : start + size + 1]
    return Substructure(
        shared[key], np.arange(first, first + size + 1), cuts.rows(place, piece), body
    )


def _interfaces(scene: RopeData, cuts: _Cuts) -> dict[str, Interface]:
    found: dict[str, Interface] = {
        wire.name: _friction(scene, cuts, place) for place, wire in enumerate(scene.wires)
    }
    still = np.zeros((len(scene.wires), len(scene.instants)))
    found["near end"] = Dirichlet(cuts.left[0], still)
    for piece in range(len(cuts.sizes) - 1):
        macro = np.eye(len(scene.wires))
        joint = cuts.right[piece], cuts.left[piece + 1]
        found[f"cut {piece + 1}-{piece + 2}"] = Perfect(*joint, macro)
    found["far end"] = Dirichlet(cuts.right[-1], still)
    return found


def _friction(scene: RopeData, cuts: _Cuts, place: int) -> Contact:
    wire, nodes = scene.wires[place], cuts.nodes
    element = wire.length / scene.elements
    weights = np.concatenate(
        [tributary(size, element)[own] for size, own in zip(cuts.sizes, cuts.rubbing, strict=True)]
    )
    known = np.outer(weights, np.atleast_1d(wire.bound)) / scene.stiffness
    component, scales = Component(cuts.rubs(place)), (scene.length, scene.stiffness)
    return Contact(
        tangential=scene.friction_law.at(component, weights, scales, known=known),
        points=nodes - 1,
        positions=wire.along[1:-1],
        weights=weights,
        around=Rod(np.full(len(nodes), _modulus(scene, wire))),
    )


def _modulus(scene: RopeData, wire: RopeWire) -> float:
    """Give E A over the length of a wire, scaled."""
    return wire.helix.stiffness / scene.stiffness * scene.length / wire.length
