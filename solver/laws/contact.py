"""Unilateral contact with Coulomb friction, of a body on a rigid support or of two bodies.

The normal points from the body (or support) below to the body above, and the jump is that of the
body above over the one below. With z of the jump and the compliances of both sides added, contact
comes first and friction after it, because only the pressure decides what friction can carry
(theory.md, 2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.laws.friction import Play
from solver.laws.points import AtPoints

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Contact(AtPoints):
    """An interface that opens, sticks and slips.

    A pair is a point of the body above and the point below it; the pairs of one point (two, where
    a cut ends at the interface) share its force.

    Attributes
    ----------
    normal, tangent
        Boundary rows of the body above, its displacement along the normal and along the tangent,
        shape (n_pairs,).
    below
        The same two of the body below, or None on a rigid support.
    points
        Point of the interface that each pair belongs to, shape (n_pairs,).
    positions
        Place of the points along the interface, shape (n_points,), m.
    weights
        Tributary area of each pair, shape (n_pairs,), m^2.
    gap
        Opening between the undeformed bodies, shape (n_pairs,), scaled; negative where they
        overlap.
    friction
        Coefficient mu of each pair, shape (n_pairs,), non-negative.
    moduli
        Young's moduli of the body above and of that below, scaled; infinite for a rigid support.
    depth
        Of the bodies, across the interface, m; infinite where nothing limits it.
    macro
        Macro basis of each component, shape (n_pairs, n_macro): what one body takes from the
        other is in equilibrium in the coarse problem, as on a cut. None on a rigid support.
    """

    normal: Indices
    tangent: Indices
    below: tuple[Indices, Indices] | None
    points: Indices
    positions: Array
    weights: Array
    gap: Array
    friction: Array
    moduli: tuple[float, float] = (1.0, float("inf"))
    depth: float = float("inf")
    macro: sparse.csr_array | None = None


class ContactLaw:
    """The law of one interface for given search directions; its memory is allocated once.

    Parameters
    ----------
    law
        The interface.
    k
        Search direction of all rows, shape (n_rows,).
    n_times
        Number of instants.
    """

    def __init__(self, law: Contact, k: Array, n_times: int) -> None:
        self._law = law
        self._normal = _Pair(law.normal, law.below[0] if law.below else None, k)
        self._tangent = _Pair(law.tangent, law.below[1] if law.below else None, k)
        self._closed = -law.gap[:, None]
        self._reach_of_force = (law.friction / self._tangent.stiffness[:, 0])[:, None]
        self._play = Play(len(law.normal), n_times)

    def __call__(self, incoming: Array, displacement: Array) -> None:
        """Write W^ of the interface's rows, for z = W - F/k of all rows, (n_rows, n_times)."""
        jump = self._normal.jump(incoming)
        pressing = np.maximum(self._closed - jump, 0.0)
        pressing *= self._normal.stiffness
        self._normal.push(incoming, pressing, displacement)
        jump = self._tangent.jump(incoming)
        held = self._play(jump, self._reach_of_force * pressing)
        self._tangent.push(incoming, self._tangent.stiffness * (held - jump), displacement)


class _Pair:
    """One component of a jump: rows above and below, and their search directions in series."""

    def __init__(self, above: Indices, below: Indices | None, k: Array) -> None:
        self._above, self._below = above, below
        self._soft = 1.0 / k[above, None]
        self._soft_below = np.zeros_like(self._soft) if below is None else 1.0 / k[below, None]
        self.stiffness = 1.0 / (self._soft + self._soft_below)

    def jump(self, incoming: Array) -> Array:
        above = incoming[self._above]
        return above if self._below is None else above - incoming[self._below]

    def push(self, incoming: Array, force: Array, displacement: Array) -> None:
        """Write W^ = z + F^/k above, and with the opposite force below."""
        displacement[self._above] = incoming[self._above] + force * self._soft
        if self._below is not None:
            displacement[self._below] = incoming[self._below] - force * self._soft_below
