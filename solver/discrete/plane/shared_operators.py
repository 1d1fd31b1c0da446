"""Operators of parts of shapes; equal parts share one operator."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.cache import CACHE, content_of
from solver.discrete.condensed_part import (
    Operator,
    PartForce,
    Trace,
    kept_by,
)
from solver.discrete.plane.body_parts import ShapePart
from solver.discrete.schur_complement import SchurComplement

DIGITS = 9
"""Decimal digits to which parts agree that share an operator."""


class PartNodes(NamedTuple):
    """Nodes of a part, and the forces there.

    Attributes
    ----------
    nodes
        Indices of its nodes among those of all bodies, (n_nodes,).
    turned
        Key of the directions of its degrees of freedom in the axes of its body.
    frames
        Motions of its degrees of freedom along x and y, and turn, (n_nodes, n_axes, 3);
        None where they are along x and y.
    force
        Forces on these, (n_nodes n_axes,) in space, or None.
    """

    nodes: Indices
    turned: bytes
    frames: Array | None
    force: PartForce | None


class SharedOperators:
    """Operators of parts of shapes; equal parts share one operator.

    Parameters
    ----------
    frames
        Directions of the degrees of freedom at all nodes in the axes of their bodies,
        (n_nodes, 2, 2).
    """

    def __init__(self, frames: Array) -> None:
        self._frames = frames
        self._rounded = _rounded(frames)
        self._operators = dict[Hashable, Operator]()
        self._stiffnesses = dict[Hashable, SchurComplement]()

    def of(
        self, part: ShapePart, on_nodes: PartNodes, traces: Sequence[Trace]
    ) -> Operator:
        """Operator of a part with boundary rows; equal parts get the same object.

        Members of a group of parts have forces inside all or none of them.
        """
        has_force = on_nodes.force is not None
        # Most parts that are alike have the very same traces.
        of_traces = [id(trace) for trace in traces]
        same = part.content, on_nodes.turned, has_force, *of_traces
        known = self._operators.get(same)
        if known is not None:
            return known
        dofs = np.concatenate([trace.dofs.ravel() for trace in traces])
        direction = np.concatenate([trace.direction.ravel() for trace in traces])
        alike = (
            part.content,
            dofs.tobytes(),
            _rounded(direction / direction.max()).tobytes(),
            on_nodes.turned,
            tuple(trace.has_macro for trace in traces),
            has_force,
        )
        if alike not in self._operators:
            self._operators[alike] = self._made(part, on_nodes, traces, alike)
        self._operators[same] = self._operators[alike]
        return self._operators[alike]

    def turned(self, nodes: Indices) -> list[bytes]:
        """Keys of the directions at the nodes of parts, (n_parts, n_nodes)."""
        return [of_part.tobytes() for of_part in self._rounded[nodes]]

    def _condensed(
        self, part: ShapePart, frames: Array, kept: Indices
    ) -> SchurComplement:
        """Stiffness of a part condensed onto some degrees of freedom, (n,).

        `frames` are the directions at its nodes in its axes, (n_nodes, 2, 2). What lies
        below a joint has directions that are turned round from those above: both are
        condensed in those that have a positive first component.
        """
        nodes, axes = np.divmod(kept, part.n_axes)
        signs = np.ones(len(kept))
        moves = np.flatnonzero(axes < 2)
        rows = nodes[moves], axes[moves]
        along_x, along_y = frames[rows].T
        signs[moves] = np.sign(np.where(along_x == 0.0, along_y, along_x))
        towards = frames.copy()
        towards[rows] *= signs[moves, None]
        alike = id(part), kept.tobytes(), _rounded(towards).tobytes()
        if alike not in self._stiffnesses:
            # No load and no friction changes the stiffness of the first of them.
            key = "part", part.content, content_of(towards, kept)
            self._stiffnesses[alike] = CACHE.get(
                key, lambda: SchurComplement(part.stiffness_in(towards), kept)
            )
        return self._stiffnesses[alike].with_signs(signs)

    def _made(
        self,
        part: ShapePart,
        on_nodes: PartNodes,
        traces: Sequence[Trace],
        alike: Hashable,
    ) -> Operator:
        """Operator of a part, that of an earlier structure if it had an equal part.

        A lattice has the outline in common with other parts, if its directions are the
        axes; `alike` is the key of its rows.
        """
        frames = self._frames[on_nodes.nodes]
        kept = kept_by(traces)
        outline = part.outline
        if outline is None or np.any(frames != np.eye(2)):
            return Operator(self._condensed(part, frames, kept), traces)
        direction = [trace.direction for trace in traces]
        return CACHE.get(
            ("operator", alike, content_of(*direction)),
            lambda: Operator(SchurComplement(outline, kept), traces),
        )


def _rounded(values: Array) -> Array:
    """Values of any shape, rounded, for a key."""
    # Zero is added so that -0 is 0.
    return np.asarray(np.round(values, DIGITS) + 0.0)
