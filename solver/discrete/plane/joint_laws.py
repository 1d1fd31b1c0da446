"""Laws of joints in the plane: contact of two sides, and glued cuts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.discrete.scales import Scales
from solver.laws import (
    BodyStiffness,
    Component,
    Contact,
    Friction,
    FrictionLaw,
    NodalStiffness,
    Perfect,
    Unilateral,
)
from solver.laws.friction import compliance_of


class JointPairs(NamedTuple):
    """Pairs of nodes of joints that have one law, joint by joint and piece by piece.

    Attributes
    ----------
    names
        Names of the joints.
    joints
        Place of the joint of each pair in `names`, ascending, (n_pairs,).
    keys
        Number of the node of each pair among those of all these joints, (n_pairs,);
        nodes of a joint follow those of the joint before.
    positions
        Distance of each pair along its joint, (n_pairs,), m.
    weights
        Tributary area of each pair for a metre of thickness, (n_pairs,), m^2.
    tangent, normal
        Boundary rows along and across the joints; no normal ones where the pressure is
        known.
    """

    names: Sequence[str]
    joints: Indices
    keys: Indices
    positions: Array
    weights: Array
    tangent: Component
    normal: Component | None


class Surface(NamedTuple):
    """Friction and opening of the pairs of joints.

    Attributes
    ----------
    law
        Friction law beside the coefficients.
    gap
        Opening of each pair, (n_pairs,), m.
    friction
        Coefficient mu of each pair, (n_pairs,); not read where `known` is given.
    known
        Friction force that known pressure makes, scaled, (n_pairs, n_instants), or
        None.
    """

    law: FrictionLaw
    gap: Array
    friction: Array
    known: Array | None = None


def contact_of(
    pairs: JointPairs,
    surface: Surface,
    scales: Scales,
    stiffness_beside: BodyStiffness | NodalStiffness,
    bases: Sequence[Array],
) -> Contact:
    """Law of joints: all on a support, or all between bodies.

    `bases` are the macro bases of their pieces in one component, (n_pairs_of_piece,
    n_macro) each; without columns where no macro forces balance.
    """
    _, first, points = np.unique(pairs.keys, return_index=True, return_inverse=True)
    names: tuple[str, ...] = ()
    interfaces = None
    if len(pairs.names) > 1:
        names = tuple(pairs.names)
        interfaces = pairs.joints[first]
    return Contact(
        normal=_normal_law(pairs, surface, scales),
        tangential=_friction(pairs, surface, scales),
        points=points.ravel(),
        positions=pairs.positions[first],
        weights=pairs.weights,
        stiffness_beside=stiffness_beside,
        macro=_beside_each_other(bases),
        names=names,
        interfaces=interfaces,
    )


def _normal_law(
    pairs: JointPairs, surface: Surface, scales: Scales
) -> Unilateral | None:
    """Unilateral law across joints; None where the pressure is known."""
    if pairs.normal is None:
        return None
    units = scales.displacement, scales.force
    stiffness = surface.law.normal_stiffness
    return Unilateral(
        component=pairs.normal,
        gap=surface.gap / scales.displacement,
        compliance=compliance_of(stiffness, pairs.weights, units),
    )


def _friction(pairs: JointPairs, surface: Surface, scales: Scales) -> Friction:
    """Friction law along joints."""
    units = scales.displacement, scales.force
    law = surface.law
    if surface.known is not None:
        return law.at(pairs.tangent, pairs.weights, units, known=surface.known)
    mu = surface.friction
    friction = law.at(pairs.tangent, pairs.weights, units, friction=mu)
    # Nothing is bonded across a gap.
    is_closed = (surface.gap <= 0.0)[:, None]
    return replace(friction, bound=friction.bound * is_closed)


def _beside_each_other(blocks: Sequence[Array]) -> sparse.csr_array | None:
    """Diagonal matrix of blocks, (n_rows, n_columns) each; None without any column."""
    heights = np.array([block.shape[0] for block in blocks])
    widths = np.array([block.shape[1] for block in blocks])
    if not widths.any():
        return None
    # Rows of one block are as wide as it.
    of_rows = np.repeat(widths, heights)
    ends = np.append(0, np.cumsum(of_rows))
    first_columns = np.repeat(np.cumsum(widths) - widths, heights)
    columns = np.arange(ends[-1]) - np.repeat(ends[:-1] - first_columns, of_rows)
    values = np.concatenate([block.ravel() for block in blocks])
    shape = len(of_rows), int(widths.sum())
    whole = sparse.csr_array((values, columns, ends), shape)
    whole.eliminate_zeros()
    return whole


def glued(
    rows: Indices, opposite: Indices, basis: Array, frames: Array | None = None
) -> Perfect:
    """Perfect interface of two parts of one body.

    Parameters
    ----------
    rows, opposite
        Boundary rows of both parts, shape (n_nodes, n_components).
    basis
        Macro basis of one component, (n_nodes, n_macro).
    frames
        Directions of the degrees of freedom at the nodes in the axes of the body,
        (n_nodes, 2, 2); None where they are these axes. Macro forces are along them.
    """
    if frames is None:
        frames = np.eye(rows.shape[1])[None]
    macro = frames[:, :, None, :] * basis[:, None, :, None]
    return Perfect(rows.ravel(), opposite.ravel(), macro.reshape(rows.size, -1))
