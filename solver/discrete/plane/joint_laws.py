"""Contact laws of the joints of bodies of any shape."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy import sparse

from solver.arrays import Array, distinct
from solver.discrete.plane.cut_bodies import CutBodies
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.joints_of_bodies import (
    JointPairs,
    macro_bases,
    positions_along,
    stiffness_beside,
)
from solver.discrete.plane.node_pairs import along_joints
from solver.discrete.substructure import Scales
from solver.laws import Contact, Friction, FrictionLaw, Unilateral
from solver.laws.friction import compliance_of


def laws_of(cut: CutBodies) -> Iterator[tuple[str, Contact]]:
    """Yield a law for all joints on supports, and one for all between bodies.

    That of a single joint has its name.
    """
    kinds = dict[str, list[int]]()
    on_support = {piece.joint: len(piece.parts) == 1 for piece in cut.pieces}
    for number, is_on_support in on_support.items():
        kind = "supports" if is_on_support else "contacts"
        kinds.setdefault(kind, []).append(number)
    for kind, numbers in kinds.items():
        name = kind
        if len(numbers) == 1:
            name = cut.structure.joints[numbers[0]].name
        yield name, _law_of(cut, numbers)


def _law_of(cut: CutBodies, numbers: Sequence[int]) -> Contact:
    """Law of joints by index: all on a support, or all between bodies.

    Pairs at one node of a joint are one point.
    """
    joints = [cut.structure.joints[number] for number in numbers]
    pairs = JointPairs.of(cut, numbers)
    size = int(pairs.places.max()) + 1
    keys = pairs.joints * size + pairs.places
    _, first, points = distinct(keys, len(numbers) * size)
    names: tuple[str, ...] = ()
    interfaces = None
    if len(numbers) > 1:
        names = tuple([joint.name for joint in joints])
        interfaces = pairs.joints[first]
    law = cut.structure.friction_law
    slip_ratio = 1.0
    if joints[0].is_image:
        law = law.of_one_side()
        slip_ratio = 2.0
    gap = along_joints([joint.gap for joint in joints], pairs.sizes)[pairs.nodes]
    return Contact(
        normal=_normal_law(pairs, law, gap, cut.scales),
        tangential=_friction(joints, pairs, law, gap, cut.scales),
        points=points,
        positions=positions_along(cut, numbers)[pairs.nodes][first],
        weights=pairs.weights,
        stiffness_beside=stiffness_beside(cut, numbers, pairs),
        macro=_beside_each_other(macro_bases(cut, pairs)),
        slip_ratio=slip_ratio,
        names=names,
        interfaces=interfaces,
    )


def _normal_law(
    pairs: JointPairs, law: FrictionLaw, gap: Array, scales: Scales
) -> Unilateral | None:
    """Unilateral law across joints; None where the pressure is known.

    `gap` is the opening of each pair, (n_pairs,), m.
    """
    if pairs.normal is None:
        return None
    units = scales.displacement, scales.force
    return Unilateral(
        component=pairs.normal,
        gap=gap / scales.displacement,
        compliance=compliance_of(law.normal_stiffness, pairs.weights, units),
    )


def _friction(
    joints: Sequence[Joint],
    pairs: JointPairs,
    law: FrictionLaw,
    gap: Array,
    scales: Scales,
) -> Friction:
    """Friction law along joints, with openings of their pairs, (n_pairs,), m."""
    units = scales.displacement, scales.force
    strengths = [joint.strength for joint in joints if joint.strength is not None]
    if strengths:
        strength = np.concatenate(strengths)[pairs.nodes] / scales.force
        known = strength * pairs.weights[:, None]
        return law.at(pairs.tangent, pairs.weights, units, known=known)
    mu = along_joints([joint.friction for joint in joints], pairs.sizes)[pairs.nodes]
    friction = law.at(pairs.tangent, pairs.weights, units, friction=mu)
    # Nothing is bonded across a gap.
    is_closed = (gap <= 0.0)[:, None]
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
