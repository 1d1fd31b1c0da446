"""Stacked rectangular bodies as a discrete problem, condensed onto outlines of substructures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.motions import rigid_motions
from solver.discrete.problem import Problem, Scales
from solver.discrete.stack.data import StackData
from solver.discrete.stack.inside import StackInside
from solver.discrete.stack.laws import interfaces_of
from solver.discrete.stack.parts import Grid, Part, parts_of
from solver.discrete.stack.rest import rigid_rest, rigid_slide
from solver.discrete.stack.sides import neighbour
from solver.discrete.substructure import Elasticity, Substructure


def discretise_stack(scene: StackData) -> Problem:
    """Cut the bodies into rectangles and write the laws of their interfaces.

    Lengths are scaled by the length of a body, stresses by E. Search direction: E / l_sub per
    area, with l_sub the geometric mean of a substructure's sides, for cuts, contacts and
    supports alike (the paper's ES / l_sub). Tractions act on the substructures themselves, and
    need no interface. Contact forces are lumped at the nodes.
    """
    grid = Grid(scene)
    parts = parts_of(scene, grid)
    first = 0
    for part in parts:
        for side, held in part.held.items():
            width = len(held.components)
            size = width * len(part.rectangle.edge(side)[held.span])
            part.rows[side] = np.arange(first, first + size).reshape(-1, width)
            first += size
    shared: dict[tuple[object, ...], Elasticity] = {}
    skeleton = np.unique(np.concatenate([part.dofs for part in parts]))
    components = skeleton % 2
    positions = grid.positions[skeleton // 2]
    found = Problem(
        substructures=tuple(_substructure(scene, part, skeleton, shared) for part in parts),
        interfaces=dict(interfaces_of(scene, {part.place: part for part in parts})),
        positions=positions * scene.length,
        instants=scene.instants,
        scales=Scales(scene.length, scene.young * scene.length, scene.duration),
        inside=StackInside(scene, parts, grid, skeleton),
        rest=_rest(scene, positions, components),
    )
    bodies = skeleton // 2 // grid.nodes[0].size
    motions = rigid_motions(positions, components, bodies, found.prescribed[0])
    return replace(found, motions=motions)


def _rest(scene: StackData, positions: Array, components: Indices) -> Array | None:
    """Give the displacement of degrees of freedom where the body rests, (n_dofs, n_instants)."""
    rigid = rigid_rest(scene)
    if rigid is None:
        return None
    x, y = positions.T
    modes = np.stack([components, np.where(components == 1, x, -y)], axis=1)
    found = np.asarray(modes @ (rigid / np.array([[scene.length], [1.0]])))
    if scene.spring is not None:
        found += np.outer(components == 0, rigid_slide(scene, scene.spring) / scene.length)
    return found


def _substructure(
    scene: StackData, part: Part, skeleton: Indices, shared: dict[tuple[object, ...], Elasticity]
) -> Substructure:
    rectangle = part.rectangle
    modulus = scene.modulus(part.place[2])
    density = modulus / np.sqrt(
        rectangle.columns * rectangle.width * rectangle.rows * rectangle.height
    )
    trace, direction = [], []
    for side, held in part.held.items():
        dofs = 2 * rectangle.edge(side)[held.span, None] + np.array(held.components)
        trace.append(np.searchsorted(part.kept.dofs, dofs.ravel()))
        weights = rectangle.edge_weights(side)[held.span]
        direction.append(density * np.repeat(weights, len(held.components)))
    found = Elasticity(part.kept.stiffness, np.concatenate(trace), np.concatenate(direction))
    # Members of a group have body forces on all or on none, and see the same macro forces.
    macro = [not isinstance(neighbour(scene, part.place, side), str) for side in part.held]
    key = id(part.kept), part.force is not None, *macro
    return Substructure(
        elasticity=shared.setdefault(key, found),
        dofs=np.searchsorted(skeleton, part.dofs),
        rows=np.concatenate([rows.ravel() for rows in part.rows.values()]),
        body_force=None if part.force is None else part.kept.condense(part.force),
    )
