"""Stiffness beside an interface with friction, and the search direction k for it.

Small k converges fast globally and slowly locally, large k the reverse
(MATHEMATICS.md, 5).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from solver.arrays import Array, Indices
from solver.laws.pairs import Pairs

BETWEEN_RODS = 2.5
"""k between rods over ES/s. From zero, 1 % of the friction force of strands of 3, 5, 10
and 20 wires takes 24, 41, 66 and 129 iterations, 24, 38, 66 and more than 200 with 3,
23, 48, 65 and 123 with 2, which takes more from coarser meshes (measured)."""
SHORT_WAVES = 2.0
"""Smallest k of rods after a start from a coarser mesh, over ES divided by the longest
wavelength that is wrong. Of bars of 50 and 200 elements and a rope 1 % of the friction
force takes 14, 6 and 19 iterations, 18, 8 and 18 with two thirds of it, 13, 6 and 24
with one and a half times (measured)."""
CONTACT_STIFFNESS = 7.0
"""k per area of a contact in the plane, times its length over E. 1 % of the contact
force takes 8 to 14 iterations, with twice as much up to 20 (measured)."""
AT_A_POINT = 0.1
"""k of a point where a spring pulls, over E, for a metre of thickness. On blocks on
slopes 1 % of the contact force takes 8 to 18 iterations, and 29 to more than 120 with
the k of a contact, which keeps the body from sliding (measured)."""
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
BETWEEN_BODIES = 0.5
"""k between bodies of any shape over the geometric mean of what the whole body and one
pair resist. Of arches of 31 to 121 voussoirs, whose abutment moves, 1 % of the contact
force takes 15 to 46 iterations, 18 to 64 with twice as much; of two bodies on a slope
12 to 41, and 11 to 73 (MATHEMATICS.md, 19)."""
LINE_ON_SUPPORT = 2.0
"""k of bodies of any shape on a rigid support over the same mean."""
BETWEEN_LINES = 4.0
"""The same along joints of lines that rest on each other, times the root of the number
of these joints: one of them slides far, as in a strand. Of two to six leaves on the
ground, pulled, 1 % of the contact force takes 96 iterations in the geometric mean of
eleven cases, 130 with half as much and 87 with 1.4 times as much, which is worse where
all slide; with `BETWEEN_BODIES` 156 to more than 250 (measured)."""


@dataclass(frozen=True, eq=False)
class RodStiffness:
    """Stiffness of a rod along the interface.

    Of a rod whose points are h apart, each resists the longest waves with
    ES h (pi / 2s)^2, where s is the length that slides, and the shortest with 4 ES/h.
    With k at the geometric mean of both, neither converges more slowly than the other:
    that is pi ES/s, whatever h. Between rods k is `BETWEEN_RODS` ES/s, and s a mean
    over all contacts: of those of a strand only the contacts of the broken wire slide
    far. After a start from a coarser mesh short waves alone are wrong, so k is at least
    `SHORT_WAVES` ES over their length. A row has its share by tributary length, so that
    cuts change nothing. Where the section varies, ES is that around the point.

    From zero, 1 % of the friction force takes 14, 49 and 149 iterations on 10, 50 and
    200 elements of the bar on a sine. With the geometric mean of ES/s and ES/h it takes
    17, 75 and more than 200. One k is too small for short waves and too large for long
    ones on a fine mesh. From a tenth of k in the first ten iterations 200 elements take
    101, but 10 elements 21, and a strand of 20 wires 183 instead of 129; with 0.3 k and
    3 k in turns 107, and 0.1 k and 10 k in turns diverge. A smaller k of long waves in
    the linear stage of an uncut bar takes 121 at best instead of 154 (measured).

    Attributes
    ----------
    modulus
        ES of a rod of length L over L around each pair, shape (n_pairs,), or one for
        all pairs, scaled.
    sliding
        Length over which the displacement on a support would vary without friction,
        over L.
    elsewhere
        Factor on the paper's k of all rows that are not at contacts.
    on_cuts
        Further factor on the k of rows on cuts.
    """

    modulus: Array | float = 1.0
    sliding: float = 1.0

    elsewhere: ClassVar[float] = 1.0
    on_cuts: ClassVar[float] = 10.0
    """1 % of friction force takes 12 to 16 iterations of a bar in 1 to 50 pieces, and
    13 to 32 with 1 (measured). From zero without macro forces, where this factor is
    left out, 88 in 10 pieces, and more than 200 with it."""

    def choose(self, law: Pairs, k: Array, parts: float, waves: float) -> None:
        """Write k of interfaces into k of all rows, (n_rows,), scaled, in place.

        `parts` is the number of interfaces over the share of one that slides, `waves`
        the length of the longest waves that a start leaves wrong, m.
        """
        pairs = law.interface_of_pairs
        length = law.sums(law.weights)[pairs]
        spacing = length / np.maximum(law.sizes - 1, 1)[pairs]
        factor = BETWEEN_RODS
        if law.is_on_support:
            factor = math.pi
        along = np.maximum(factor * parts / self.sliding, SHORT_WAVES * length / waves)
        for rows in law.components[-1].sides:
            k[rows] = along * law.weights / spacing * self.modulus


@dataclass(frozen=True, eq=False)
class BodyStiffness:
    """Stiffness of bodies in the plane, above and below an interface.

    That is the stiffness of a body as a whole, or of a point of the body. A
    smaller k on cuts along slender substructures is no better, where the macro basis
    grows with their length (measured). The k of other shapes (`NodalStiffness`) takes
    rectangles 1.4 to 1.6 times the iterations to 1 % of the contact force in blocks, on
    slopes and between layers, and as many in random runs (measured): each has its own.

    Attributes
    ----------
    above, below
        Young's moduli of the body above and of that below at each pair, shape
        (n_pairs,), or one for all pairs, scaled; infinite for a rigid support.
    depth
        Depth of the bodies across the interface at each pair, shape (n_pairs,), or one
        for all pairs, m; infinite where nothing limits it.
    """

    above: Array | float = 1.0
    below: Array | float = float("inf")
    depth: Array | float = float("inf")

    elsewhere: ClassVar[float] = 8.0
    on_cuts: ClassVar[float] = 1.0

    def choose(self, law: Pairs, k: Array, parts: float, waves: float) -> None:
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
        for component in law.components:
            stiffness = sliding if component is law.tangent else pressing
            for rows, modulus in zip(
                component.sides, (self.above, self.below), strict=False
            ):
                k[rows] = modulus * stiffness * share

    def choose_sticking(self, law: Pairs, k: Array) -> None:
        """Write k of two bodies that stick everywhere on each other, as `choose`.

        They bend and stretch as one body, except for deformations as short as their
        depth d, which the softer body resists with E / d per area, across and along. Of
        layers 200 to 1000 times as long as thick 1 % of the contact force takes 9 to 13
        iterations, 43 to 55 with the k of `choose` (measured).
        """
        squeezed = np.minimum(self.above, self.below) * law.weights / self.depth
        stiffen(law, k, squeezed)

    def _slender(self, law: Pairs, length: Array) -> Array:
        """Factor on k between two slender bodies, of a length, m.

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


@dataclass(frozen=True, eq=False)
class NodalStiffness:
    """Stiffness of bodies of any shape at every pair of an interface.

    The bodies as a whole resist a displacement of all pairs with one stiffness, and
    that of one pair alone, with its neighbours held, with another. k is their geometric
    mean, as of rods (`RodStiffness`), times `LINE_ON_SUPPORT` on a rigid support, and
    times `BETWEEN_BODIES` elsewhere; along lines that rest on each other times
    `BETWEEN_LINES`.

    Attributes
    ----------
    whole, local
        Stiffness of the bodies above and below as a whole, by the share of each pair,
        and of each pair alone, along and across the interface: shape (n_pairs, 2,
        n_sides), scaled.
    squeezed
        Stiffness of the softer body across its depth, by the share of each pair, shape
        (n_pairs,), scaled.
    lines
        Number of joints of lines that rest on each other, at pairs of these joints, and
        0 elsewhere, shape (n_pairs,).
    """

    whole: Array
    local: Array
    squeezed: Array
    lines: Indices

    elsewhere: ClassVar[float] = BodyStiffness.elsewhere
    on_cuts: ClassVar[float] = BodyStiffness.on_cuts

    def choose(self, law: Pairs, k: Array, parts: float, waves: float) -> None:
        """Write k of interfaces into k of all rows, as `RodStiffness.choose`."""
        factor = BETWEEN_BODIES
        if law.is_on_support:
            factor = LINE_ON_SUPPORT
        stiffness = factor * np.sqrt(self.whole * self.local)
        along = BETWEEN_LINES / factor * np.sqrt(self.lines)
        stiffness[:, 0] *= np.where(self.lines > 0, along, 1.0)[:, None]
        for component in law.components:
            number = 0 if component is law.tangent else 1
            for side, rows in enumerate(component.sides):
                k[rows] = stiffness[:, number, side]
        if waves < np.inf:
            self._choose_for_short_waves(law, k, waves)

    def _choose_for_short_waves(self, law: Pairs, k: Array, waves: float) -> None:
        """Raise k of lines of beams on a support, for errors of short wavelength.

        A line of the length l resists as a whole with E A / l, and waves of the length
        `waves`, m, with E A / `waves`; k, (n_rows,), is changed in place. Between
        lines long waves are wrong, too: with four times the k strands take 127
        iterations from a coarser mesh instead of 75 (measured).
        """
        if not law.is_on_support:
            return
        length = law.sums(law.weights)[law.interface_of_pairs]
        factor = np.maximum(length / waves, 1.0)
        for component in law.components:
            for rows in component.sides:
                k[rows] *= factor

    def choose_sticking(self, law: Pairs, k: Array) -> None:
        """Write k of two bodies that stick everywhere, as `BodyStiffness`."""
        stiffen(law, k, self.squeezed)


def of_whole_mesh(depth: Array, length: Array, *, on_support: bool) -> Array:
    """Stiffness over E against a displacement of a whole joint, (n_joints,).

    About 1 of a body as large as the joint is long. A body of the depth d behind a
    joint of length l slides like a rod on another if it is thin, with d / l
    (`SLENDER`), and is squeezed on a rigid support, with l / d. A large body deforms
    like a round one of radius r beside a contact of half width b, with 1 / C, where C =
    (2 ln(4 r/b) - 1) / pi (Johnson, Contact Mechanics, 1985, section 5.6).

    Parameters
    ----------
    depth, length
        Area of each body over the length of the joint, and this length, (n_joints,), m.
    on_support
        Whether the joints are on rigid supports.
    """
    if on_support:
        thin = np.maximum(length / depth, 1.0)
    else:
        thin = np.minimum(SLENDER * depth / length, 1.0)
    radius = np.sqrt(depth * length / np.pi)
    compliance = (2.0 * np.log(8.0 * radius / length) - 1.0) / np.pi
    return np.asarray(thin / np.maximum(compliance, 1.0))


def stiffen(law: Pairs, k: Array, least: Array) -> None:
    """Raise k of interfaces between bodies to a minimum for each pair, (n_pairs,).

    `k` is that of all rows, (n_rows,), scaled, and is changed in place. Where it is
    larger it stays.
    """
    if law.is_on_support:
        return
    for component in law.components:
        for rows in component.sides:
            k[rows] = np.maximum(k[rows], least)
