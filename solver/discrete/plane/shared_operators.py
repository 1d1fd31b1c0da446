"""Operators of parts of shapes, which parts alike share."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.condensed_part import Operator, Trace, kept_by
from solver.discrete.elements import SchurComplement
from solver.discrete.plane.body_parts import ShapePart
from solver.kept import KEPT, content_of

DIGITS = 9
"""Decimal digits to which parts agree that share an operator."""


class SharedOperators:
    """Operators of parts of shapes, which parts alike share.

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
        self, part: ShapePart, nodes: Indices, traces: Sequence[Trace], has_force: bool
    ) -> Operator:
        """Operator of a part with boundary rows, the same for parts alike.

        `nodes` are numbers of its nodes among those of all bodies, (n_nodes,). Members
        of a group of parts have forces inside all or none of them.
        """
        turned = self._rounded[nodes].tobytes()
        # Most parts that are alike have the very same traces.
        of_traces = tuple(id(trace) for trace in traces)
        same = id(part), of_traces, turned, has_force
        if same in self._operators:
            return self._operators[same]
        dofs = np.concatenate([trace.dofs.ravel() for trace in traces])
        direction = np.concatenate([trace.direction.ravel() for trace in traces])
        alike = (
            id(part),
            dofs.tobytes(),
            _rounded(direction / direction.max()).tobytes(),
            turned,
            tuple(trace.has_macro for trace in traces),
            has_force,
        )
        if alike not in self._operators:
            frames = self._frames[nodes]
            condensed = self._condensed(part, frames, kept_by(traces))
            self._operators[alike] = Operator(condensed, traces)
        self._operators[same] = self._operators[alike]
        return self._operators[alike]

    def _condensed(
        self, part: ShapePart, frames: Array, kept: Indices
    ) -> SchurComplement:
        """Stiffness of a part condensed onto degrees of freedom that are kept, (n,).

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
            self._stiffnesses[alike] = KEPT.of(
                key, lambda: SchurComplement(part.stiffness_in(towards), kept)
            )
        return self._stiffnesses[alike].turned_round(signs)


def _rounded(values: Array) -> Array:
    """Values of any shape up to rounding, for a key."""
    # Zero is added so that -0 is 0.
    return np.asarray(np.round(values, DIGITS) + 0.0)
