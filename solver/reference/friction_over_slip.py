"""Friction bounds of all jumps over their slips in one instant.

The bound of a jump after the slip s in the instant is (r + mu f_n) g(s_0 + s), up to a
cap before slip changes it; s_0 is the slip accumulated at the instant before.
"""

from __future__ import annotations

from copy import copy
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.reference.rules import Rules


class FrictionTangent(NamedTuple):
    """Tangent of the friction bounds: constant + coefficient f_n + growth s.

    Attributes
    ----------
    constant
        Part that depends neither on the normal force nor on the slip, (n,), scaled.
    coefficient
        Growth of the bound per normal force, shape (n,).
    growth
        Growth of the bound per slip, shape (n,), scaled.
    is_capped
        Jumps whose bound is capped, shape (n,).
    """

    constant: Array
    coefficient: Array
    growth: Array
    is_capped: Flags


class FrictionOverSlip:
    """Friction bounds of all jumps over their slips in one instant.

    Attributes
    ----------
    accumulated_slip
        Accumulated slip of all jumps at the instant before, shape (n,), scaled.
    """

    def __init__(self, rules: Rules) -> None:
        self._rules = rules
        self.accumulated_slip = np.zeros_like(rules.gap)
        # Slips that say how far friction has fallen, where it falls no further.
        self._fallen: Array | None = None

    def left_after(self, slip: Array) -> FrictionOverSlip:
        """The same friction, which falls up to given slips only.

        Where friction rises with slip it continues to rise.

        Parameters
        ----------
        slip
            Slips of the instant up to which friction falls, shape (n,), scaled;
            non-negative.
        """
        changed = copy(self)
        changed._fallen = slip
        return changed

    def accumulate(self, slip: Array) -> None:
        """Accumulate the slips of an instant, with their signs, shape (n,), scaled."""
        self.accumulated_slip += np.abs(slip)

    @property
    def softens(self) -> bool:
        """Check whether friction falls with slip anywhere."""
        return self._fallen is None and self._rules.softens

    def bound(self, bound: Array, force: Array, slip: Array) -> Array:
        """Friction bounds at forces of all jumps and slips >= 0, scaled.

        The bound r that needs no normal force, the forces, the slips and the result
        have the shape (n,).
        """
        return self._factor(slip) * self._rules.before_slip(bound, force)

    def tangent(self, bound: Array, force: Array, slip: Array) -> FrictionTangent:
        """Tangent of the friction bounds at forces of all jumps and slips >= 0, scaled.

        The bound r that needs no normal force, the forces and the slips have the shape
        (n,).
        """
        rules = self._rules
        before_slip = rules.before_slip(bound, force)
        is_capped = before_slip >= rules.cap
        factor = self._factor(slip)
        growth = self._slope(slip) * before_slip
        constant = np.where(is_capped, rules.cap, bound) * factor - growth * slip
        coefficient = np.where(is_capped, 0.0, rules.friction * factor)
        return FrictionTangent(constant, coefficient, growth, is_capped)

    def segment(self, slip: Array) -> Indices:
        """Index of the segment of the slip factor at each slip, both (n,)."""
        return self._rules.slip_factor.segment(self.accumulated_slip + np.abs(slip))

    def lowest_slope(self, first: Array, last: Array) -> Array:
        """Lowest slope of the slip factor between two slips >= 0, (n,) all, scaled.

        Either slip may be the larger one. Falls count, also those that are left out.
        """
        return self._rules.slip_factor.lowest_slope(
            self.accumulated_slip + np.minimum(first, last),
            self.accumulated_slip + np.maximum(first, last),
        )

    def _factor(self, slip: Array) -> Array:
        """Factor on the friction bound at slips >= 0 of the instant, both (n,)."""
        slip_factor = self._rules.slip_factor
        if self._fallen is None:
            return slip_factor(self.accumulated_slip + slip)
        # The fall is that up to the given slip, the rise that up to the slip itself.
        fallen = self.accumulated_slip + self._fallen
        return (
            slip_factor(fallen)
            - slip_factor.rise(fallen)
            + slip_factor.rise(self.accumulated_slip + slip)
        )

    def _slope(self, slip: Array) -> Array:
        """Slope of the factor at slips >= 0, both (n,)."""
        slope = self._rules.slip_factor.slope(self.accumulated_slip + slip)
        if self._fallen is None:
            return slope
        return np.maximum(slope, 0.0)
