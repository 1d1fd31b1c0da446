"""Stiffness beside an interface with friction, and the search direction k for it.

Small k converges fast globally and slowly locally, large k the reverse
(MATHEMATICS.md, 5).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from solver.arrays import Array
from solver.laws.pairs import Pairs

FRICTION_FACTOR = 2.0
"""k of a friction point over the geometric mean of the two stiffnesses ES/s and ES/h.
Of sines and decaying cycles 1 % of friction force takes at most 23 iterations with 2,
28 with 1, 43 with 4 (measured)."""
CONTACT_STIFFNESS = 7.0
"""k per area of a contact in the plane, times its length over E. 1 % of the contact
force takes 8 to 14 iterations, with twice as much up to 20 (measured)."""
AT_A_POINT = 0.1
"""k of a point where a spring pulls, over E, for a metre of thickness. On blocks on
slopes 1 % of the contact force takes 8 to 18 iterations, and 29 to more than 120 with
the k of a contact, which keeps the body from sliding (measured)."""
ON_BEAMS = 4.0
"""k of a point of a line of beams on a support over E A / l of the line. 1 % of the
contact force of belts and tendons of 20 to 40 elements takes 29 to 58 iterations, of
120 elements 62 to 95; with half as much up to 95 on 40, with twice 93 on 120
(measured)."""
RESOLVED = 96.0
FINER = 1.0 / 3.0
"""Number of elements along a support above which its k grows with their number, and
exponent of that growth: a body is locally stiffer than as a whole. Of 768 x 384
elements on a parabola 1e-4 takes 52 iterations, 104 with a constant k (measured)."""
SLIDING_BETWEEN_BODIES = 1.0 / 7.0
"""The tangential k between two bodies over the normal one: layers slide along their
length. At most 45 iterations on those of `SLENDER`, 76 with half as much, 67 with
twice."""
SLENDER = 40.0
"""Ratio of length to thickness of two bodies in contact above which k must be
smaller. Of layers 10 to 1000 times as long as thick 1 % of the contact force takes at
most 45 iterations, more than 150 without (measured)."""


@dataclass(frozen=True, eq=False)
class RodStiffness:
    """Stiffness of a rod along the interface.

    The global length of the problem is the length s that is expected to slide, the
    local one the distance h of its points. So k of a point is `FRICTION_FACTOR` times
    the geometric mean of ES/s and ES/h, for which neither of both converges more slowly
    than the other; a row has its share by tributary length, so that cuts change
    nothing. Of the n contacts of a strand only those of the broken wire slide far: s is
    a mean over all of them, and k grows by sqrt(n). For 1 % of the friction force of 20
    wires that takes 65 iterations instead of 109 (measured). Where the section varies,
    ES is that around the point.

    Attributes
    ----------
    modulus
        Stiffness of the rod around each pair, shape (n_pairs,), scaled; None is 1.
    elsewhere
        Factor on the paper's k of all rows that are not at contacts.
    on_cuts
        Further factor on the k of rows on cuts.
    """

    modulus: Array | None = None

    elsewhere: ClassVar[float] = 1.0
    on_cuts: ClassVar[float] = 10.0
    """1 % of friction force takes 16 to 17 iterations, and 16 to 31 with 1
    (measured)."""

    def choose(self, law: Pairs, k: Array, parts: float) -> None:
        """Write the k of interfaces into that of all rows, (n_rows,), scaled.

        `parts` is the number of interfaces over the share of one that slides, `k` that
        of all rows, which is changed in place.
        """
        pairs = law.interface_of_pairs
        length = law.sums(law.weights)[pairs]
        spacing = length / np.maximum(law.sizes - 1, 1)[pairs]
        stiffness = FRICTION_FACTOR * np.sqrt(length / spacing * parts)
        for rows in law.components[-1].sides:
            k[rows] = stiffness * law.weights / spacing
            if self.modulus is not None:
                k[rows] *= self.modulus


@dataclass(frozen=True, eq=False)
class BeamStiffness:
    """Stiffness of a line of beams on a support.

    k of a point is `ON_BEAMS` times the stiffness E A / l of the line, by which tension
    resists slip; a row has its share by tributary length. Across, nothing but the
    tension of the line resists, and any k of that size does (measured from a tenth to
    25 times).

    Attributes
    ----------
    modulus
        Stiffness E A / l of the line of each pair, shape (n_pairs,), scaled.
    """

    modulus: Array

    elsewhere: ClassVar[float] = 8.0
    on_cuts: ClassVar[float] = 1.0

    def choose(self, law: Pairs, k: Array, parts: float) -> None:
        """Write the k of interfaces into that of all rows, as `RodStiffness.choose`."""
        pairs = law.interface_of_pairs
        mean = (law.sums(law.weights) / law.sizes)[pairs]
        for component in law.components:
            for rows in component.sides:
                k[rows] = ON_BEAMS * self.modulus * law.weights / mean


@dataclass(frozen=True, eq=False)
class BodyStiffness:
    """Stiffness of bodies in the plane, above and below an interface.

    That is the stiffness of a body as a whole, or of a point of the body. A
    smaller k on cuts along slender substructures is no better, where the macro basis
    grows with their length (measured).

    Attributes
    ----------
    above, below
        Young's moduli of the body above and of that below at each pair, shape
        (n_pairs,), or one for all pairs, scaled; infinite for a rigid support.
    depth
        Depth of the bodies across the interface at each pair, shape (n_pairs,), or one
        for all pairs, m; infinite where nothing limits it.
    shares
        Share of each pair in the k of its interface, shape (n_pairs,), where it is not
        that in its area; None where it is.
    """

    above: Array | float = 1.0
    below: Array | float = float("inf")
    depth: Array | float = float("inf")
    shares: Array | None = None

    elsewhere: ClassVar[float] = 8.0
    on_cuts: ClassVar[float] = 1.0

    def choose(self, law: Pairs, k: Array, parts: float) -> None:
        """Write the k of interfaces into that of all rows, as `RodStiffness.choose`.

        A thin body on a rigid support is squeezed, with the stiffness E / d of its
        depth d.
        """
        if law.is_spring:
            k[law.rows] = AT_A_POINT * np.max(self.above)
            return
        pairs = law.interface_of_pairs
        length = law.sums(law.weights)[pairs]
        if law.is_on_support:
            # A support sees the depth of a thin body, or the local stiffness of a deep
            # one.
            finer = [
                max((size - 1) / RESOLVED, 1.0) ** FINER for size in law.sizes.tolist()
            ]
            stiffness = CONTACT_STIFFNESS * np.array(finer)[pairs]
            pressing = np.maximum(stiffness, length / self.depth)
            sliding = pressing
        else:
            pressing = CONTACT_STIFFNESS * self._slender(law, length)
            sliding = SLIDING_BETWEEN_BODIES * pressing
        share = law.weights / length
        if self.shares is not None:
            share = self.shares
        for component in law.components:
            stiffness = sliding if component is law.tangent else pressing
            for rows, modulus in zip(
                component.sides, (self.above, self.below), strict=False
            ):
                k[rows] = modulus * stiffness * share

    def stick(self, law: Pairs, k: Array) -> None:
        """Write the k of two bodies that nowhere slip on each other, as `choose`.

        They bend and stretch as one body, except for deformations as short as their
        depth d, which the softer body resists with E / d per area, across and along. Of
        layers 200 to 1000 times as long as thick 1 % of the contact force takes 9 to 13
        iterations, 43 to 55 with the k of `choose` (measured).
        """
        if law.is_on_support:
            return
        squeezed = np.minimum(self.above, self.below) * law.weights / self.depth
        for component in law.components:
            for rows in component.sides:
                # Only ever stiffer: where the k of `choose` is larger it stays.
                k[rows] = np.maximum(k[rows], squeezed)

    def _slender(self, law: Pairs, length: Array) -> Array:
        """Factor on k between two bodies that are thin beside their length.

        Layers slide like rods, of stiffness E d / l^2 per area as a whole, with the
        depth d along the contact's length l; and E d / (l h) from point to point, h
        apart, or d where that is larger. This is their geometric mean over E / l. Macro
        forces see to long waves of bending.

        `length` is that of the interface of each pair, m; shape (n_pairs,) both.
        """
        steps = np.maximum(law.sizes - 1, 1)[law.interface_of_pairs]
        resolved = np.minimum(self.depth / (length / steps), 1.0)
        slender = SLENDER * self.depth / length * resolved
        return np.asarray(np.sqrt(np.minimum(slender, 1.0)))
