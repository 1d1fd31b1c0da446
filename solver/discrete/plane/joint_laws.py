"""Laws of joints in the plane: contact of two sides, and glued cuts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices, distinct
from solver.discrete.condensed_part import CondensedPart
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

JOINT_SIDES = "above", "below"
"""Sides of joints; the rows of a part at a piece are by these and its number."""


class JointPiece(NamedTuple):
    """Part of a joint: between one part of the body above and one part below.

    Attributes
    ----------
    joint
        Index of the joint.
    parts
        Index of the part above, and of that below, among all parts; on a rigid support
        of the part above alone.
    places
        Indices of the nodes of its pairs along the joint, ascending, (n,).
    weights
        Length that belongs to each pair, (n,), m.
    along
        Component along the joint among those of a node: 0 the first, 1 the second.
    """

    joint: int
    parts: tuple[int, ...]
    places: Indices
    weights: Array
    along: int = 0


class Cut(Protocol):
    """Bodies cut into parts, with joints cut into pieces."""

    @property
    def parts(self) -> Sequence[CondensedPart]:
        """Parts of all bodies."""

    @property
    def pieces(self) -> Sequence[JointPiece]:
        """Pieces of all joints, joint by joint."""

    @property
    def joint_names(self) -> Sequence[str]:
        """Names of all joints."""


class JointPairs(NamedTuple):
    """Pairs of nodes of joints of one law, joint by joint and piece by piece.

    Attributes
    ----------
    names
        Names of the joints.
    pieces
        Indices of the pieces of these joints.
    counts
        Number of pairs of each piece, (n_pieces,).
    joints
        Place of the joint of each pair in `names`, ascending, (n_pairs,).
    places
        Index of the node of each pair along its joint, (n_pairs,).
    weights
        Tributary area of each pair for a metre of thickness, (n_pairs,), m^2.
    tangent, normal
        Boundary rows along and across the joints; no normal ones where the pressure is
        known.
    """

    names: Sequence[str]
    pieces: Sequence[int]
    counts: Indices
    joints: Indices
    places: Indices
    weights: Array
    tangent: Component
    normal: Component | None

    @classmethod
    def of(cls, cut: Cut, numbers: Sequence[int]) -> JointPairs:
        """Pairs of joints by index, ascending."""
        owners = np.array([piece.joint for piece in cut.pieces])
        chosen = np.flatnonzero(np.isin(owners, numbers)).tolist()
        pieces = [cut.pieces[number] for number in chosen]
        counts = np.array([len(piece.places) for piece in pieces])
        tangent, normal = _components(cut, chosen, counts)
        return cls(
            names=[cut.joint_names[number] for number in numbers],
            pieces=chosen,
            counts=counts,
            joints=np.repeat(np.searchsorted(numbers, owners[chosen]), counts),
            places=np.concatenate([piece.places for piece in pieces]),
            weights=np.concatenate([piece.weights for piece in pieces]),
            tangent=tangent,
            normal=normal,
        )


def _components(
    cut: Cut, numbers: Sequence[int], counts: Indices
) -> tuple[Component, Component | None]:
    """Components along and across pieces, from indices and counts of pairs, (n,).

    There are none across where parts have rows of one component.
    """
    pieces = [cut.pieces[number] for number in numbers]
    along = np.repeat([piece.along for piece in pieces], counts)
    # Indices of the pairs of each piece within it.
    within = np.arange(len(along)) - np.repeat(np.cumsum(counts) - counts, counts)
    tangential = list[Indices]()
    across = list[Indices]()
    for side, name in enumerate(JOINT_SIDES[: len(pieces[0].parts)]):
        parts = [cut.parts[piece.parts[side]] for piece in pieces]
        of_pieces = [
            part.first_rows[name, number]
            for number, part in zip(numbers, parts, strict=True)
        ]
        _, n_components = parts[0].traces[name, numbers[0]].dofs.shape
        rows = np.repeat(of_pieces, counts) + n_components * within
        tangential.append(rows + along)
        if n_components > 1:
            across.append(rows + 1 - along)
    if not across:
        return Component(*tangential), None
    return Component(*tangential), Component(*across)


class Surface(NamedTuple):
    """Friction and opening at the pairs of joints.

    Attributes
    ----------
    positions
        Distance of each pair along its joint, (n_pairs,), m.
    law
        Friction law beside the coefficients.
    gap
        Opening of each pair, (n_pairs,), m.
    friction
        Coefficient mu of each pair, (n_pairs,); not read where `known` is given.
    known
        Friction force that known pressure makes, scaled, (n_pairs, n_instants), or
        None.
    slip_ratio
        Slip over the tangential displacement of the rows.
    """

    positions: Array
    law: FrictionLaw
    gap: Array
    friction: Array
    known: Array | None = None
    slip_ratio: float = 1.0


def laws_of(
    cut: Cut, law_of: Callable[[Sequence[int]], Contact]
) -> Iterator[tuple[str, Contact]]:
    """Yield a law for all joints on supports, and one for all between bodies.

    `law_of` makes a law by the numbers of its joints. That of a single joint has its
    name.
    """
    kinds = dict[str, list[int]]()
    on_support = {piece.joint: len(piece.parts) == 1 for piece in cut.pieces}
    for number, is_on_support in on_support.items():
        kind = "supports" if is_on_support else "contacts"
        kinds.setdefault(kind, []).append(number)
    for kind, numbers in kinds.items():
        name = kind
        if len(numbers) == 1:
            name = cut.joint_names[numbers[0]]
        yield name, law_of(numbers)


def contact_of(
    pairs: JointPairs,
    surface: Surface,
    scales: Scales,
    stiffness_beside: BodyStiffness | NodalStiffness,
    bases: Sequence[Array],
) -> Contact:
    """Law of joints: all on a support, or all between bodies.

    Pairs at one node of a joint are one point. `bases` are the macro bases of their
    pieces in one component, (n_pairs_of_piece, n_macro) each; without columns where no
    macro forces balance.
    """
    size = int(pairs.places.max()) + 1
    keys = pairs.joints * size + pairs.places
    _, first, points = distinct(keys, len(pairs.names) * size)
    names: tuple[str, ...] = ()
    interfaces = None
    if len(pairs.names) > 1:
        names = tuple(pairs.names)
        interfaces = pairs.joints[first]
    return Contact(
        normal=_normal_law(pairs, surface, scales),
        tangential=_friction(pairs, surface, scales),
        points=points,
        positions=surface.positions[first],
        weights=pairs.weights,
        stiffness_beside=stiffness_beside,
        macro=_beside_each_other(bases),
        slip_ratio=surface.slip_ratio,
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
    """Block-diagonal matrix of blocks, (n_rows, n_columns) each; None if empty."""
    heights = np.array([block.shape[0] for block in blocks])
    widths = np.array([block.shape[1] for block in blocks])
    if not widths.any():
        return None
    # Each row has as many entries as its block has columns.
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
