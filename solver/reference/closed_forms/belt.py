"""A thin band on a rough curve: capstan friction, slip arcs, tendons.

Along the guide dT = mu T da: the tension T can change by no more than mu T per angle. A
point slips where it does, and keeps its tension elsewhere, as nothing stretches there.
Unintended angles of a duct count as angles (L. Euler, 1769; EN 1992-1-1, 5.10.5.2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy

from solver.arrays import Array

POINTS = 2001
"""Points along the guide, over which strains are integrated: to 1e-7 of them."""
PRECISE = 1e-12
"""Relative precision of a tension that is sought."""


@dataclass(frozen=True)
class Capstan:
    """A thin elastic band on a rigid rough guide, between two free spans.

    Attributes
    ----------
    friction
        Coefficient of friction mu.
    angle
        Angle by which the guide turns, unintended angles included, rad.
    length
        Length on the guide, m.
    stiffness
        Axial stiffness E S, N.
    span
        Length of each of the free spans, m.
    """

    friction: float
    angle: float
    length: float
    stiffness: float
    span: float = 0.0

    @property
    def ratio(self) -> float:
        """Largest ratio of the tensions at both ends, exp(mu a)."""
        return math.exp(self.friction * self.angle)

    @property
    def angles(self) -> Array:
        """Angles along the guide from its first end, shape (POINTS,), rad."""
        return np.linspace(0.0, self.angle, POINTS)

    def bounds(self, tension: Array | float, angles: Array) -> tuple[Array, Array]:
        """Smallest and largest tension at angles from an end, (n_points,), N.

        `tension` is that of the end.
        """
        grows = np.exp(self.friction * angles)
        return tension / grows, tension * grows

    def step(
        self, before: Array, pull: float, tail: float | None, angles: Array
    ) -> Array:
        """Tension after the tensions of the ends have changed, (n_points,), N.

        Parameters
        ----------
        before
            Tension before, (n_points,), N.
        pull, tail
            Tensions of the last and the first end, N; None: the first end is held.
        angles
            Angles from the first end, (n_points,), rad.
        """
        low, high = self.bounds(pull, self.angle - angles)
        if tail is not None:
            of_tail = self.bounds(tail, angles)
            low = np.maximum(low, of_tail[0])
            high = np.minimum(high, of_tail[1])
        return np.clip(before, low, high)

    def tensions(self, pull: Array, tail: Array | None, angles: Array) -> Array:
        """Tension over time at angles from the first end, (n_points, n_instants), N.

        From a slack band on, under tensions of the ends over time, (n_instants,), N. A
        ratio beyond the largest one has no solution.
        """
        tension = np.zeros_like(angles)
        found = []
        for number, end in enumerate(pull.tolist()):
            other = None
            if tail is not None:
                other = float(tail[number])
            tension = self.step(tension, end, other, angles)
            found.append(tension)
        return np.stack(found, axis=1)

    def displacement(self, pull: Array, tail: Array | None) -> Array:
        """Displacement of the last end under tensions, (n_instants,), m.

        Tensions of both ends are as in `tensions`. Where the first end is pulled, too,
        the last one moves away from what sticks between them.
        """
        angles = self.angles
        tension = self.tensions(pull, tail, angles)
        changes = np.diff(tension, axis=1, prepend=0.0)
        spans = self.span * pull
        if tail is None:
            spans = spans + self.span * tension[0]
        else:
            by_pull = self._governs(tension, pull, self.angle - angles)
            by_tail = self._governs(tension, tail, angles)
            # Both sides share the point between them.
            changes *= by_pull * (1.0 - 0.5 * by_tail)
        steps = self.length * np.trapezoid(changes, angles / self.angle, axis=0)
        return np.asarray((np.cumsum(steps) + spans) / self.stiffness)

    def _governs(self, tension: Array, end: Array, angles: Array) -> Array:
        """Mask of the tension, 1 where the tension of an end bounds it, else 0.

        `tension` has shape (n_points, n_instants), N, `end` (n_instants,), N, `angles`
        from that end (n_points,).
        """
        low, high = self.bounds(end, angles[:, None])
        return np.asarray((tension <= low) | (tension >= high), dtype=float)

    def pulled_by(self, displacement: Array, *, both_ends: bool = False) -> Array:
        """Tension at an end that is moved, shape (n_instants,), N.

        The other end is held, or moved alike. `displacement` has shape (n_instants,),
        m. A band does not push.
        """
        tension = np.zeros(POINTS)
        found = []
        for moved in displacement.tolist():
            given = tension, moved, both_ends
            largest = self.stiffness * max(moved, 0.0) / self.span
            end = 0.0
            # The other side of the bracket: the free spans alone are stretched.
            if self._beyond(0.0, *given) < 0.0 < self._beyond(largest, *given):
                end = scipy.optimize.brentq(
                    self._beyond, 0.0, largest, given, rtol=PRECISE
                )
            tension = self._after(end, tension, both_ends)
            found.append(end)
        return np.array(found)

    def _after(self, pull: float, before: Array, both_ends: bool) -> Array:
        """Tension along the guide, (POINTS,), N, after a change at one end or both."""
        tail = pull if both_ends else None
        return self.step(before, pull, tail, self.angles)

    def _beyond(
        self, pull: float, before: Array, moved: float, both_ends: bool
    ) -> float:
        """Elongation under a tension, less the given displacement of an end, m."""
        after = self._after(pull, before, both_ends)
        stretch = self.length * float(np.trapezoid(after, dx=1.0 / (POINTS - 1)))
        stretch += self.span * (pull + float(after[0]))
        if both_ends:
            stretch *= 0.5
        return stretch / self.stiffness - moved
