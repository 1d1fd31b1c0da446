"""Friction of many points, a spring that may be slack, and a load, in balance at every instant.

All points move by one shift. Their forces fall with it, in straight lines between the shifts at
which a point begins to slip and the spring to pull, so that there is one zero. A point that sticks
remembers where it came to rest, which ties each instant to the one before.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array

BALANCED = 1e-14
"""Share of all that friction and load may be, which is left over where they balance."""
TRIALS = 8
"""Straight lines that are followed to their zero, before it is looked for between two shifts."""


class Balance:
    """The shifts at which forces balance.

    Parameters
    ----------
    stiffness
        With which a point that sticks pulls the body back, shape (n_points,).
    spring
        Stiffness of the spring.
    load
        Shape (n_instants,).
    """

    def __init__(self, stiffness: Array, spring: float, load: Array) -> None:
        self._stiffness, self._spring, self._load = stiffness, spring, load

    def __call__(self, targets: Array, reach: Array, ends: Array) -> Array:
        """Give the shift of every instant, shape (n_instants,).

        Parameters
        ----------
        targets
            Where the points would be without friction or shift, shape (n_instants, n_points).
        reach
            How far a point can be behind before it slips, same shape.
        ends
            Shift up to which the spring pulls, shape (n_instants,).
        """
        enough = BALANCED * (reach @ self._stiffness + np.abs(self._load))
        # Points are seen from the body, where the digits of how far they are behind stay.
        back = -np.diff(targets, axis=0, prepend=0.0)
        numbers = (one.tolist() for one in (ends, self._load, enough))
        held, shift = np.zeros(targets.shape[1]), 0.0
        steps = []
        for came, least, most, end, load, left in zip(back, -reach, reach, *numbers, strict=True):
            given = held + came, least, most, end - shift, load
            step, held = self._followed(*given, left) or self._between(*given)
            shift += step
            steps.append(step)
        return np.cumsum(steps)

    def _followed(
        self,
        behind: Array,
        least: Array,
        most: Array,
        end: float,
        load: float,
        enough: float,
    ) -> tuple[float, Array] | None:
        """Follow straight lines to the step at which all balances, None where that fails.

        With it, how far the points are behind then.
        """
        # The nearer the iteration is to its end, the less is left to shift.
        pulled, wanted, step = self._stiffness.dot, behind, 0.0
        for trial in range(TRIALS):
            held = np.minimum(np.maximum(wanted, least), most)
            left = float(pulled(held)) + load
            if end > step:
                left += self._spring * (end - step)
            # A step that a line has led to is where that line ends; no step at all may be a flat.
            if trial and abs(left) <= enough:
                return step, held
            slope = float(pulled(held == wanted)) + (self._spring if end > step else 0.0)
            if not slope > 0.0:
                return None
            if abs(left) <= enough:
                return step, held
            step += left / slope
            wanted = behind - step
        return None

    def _between(
        self, behind: Array, least: Array, most: Array, end: float, load: float
    ) -> tuple[float, Array]:
        """Look for the same between the shifts at which anything begins to slip or pull."""

        def held(step: float) -> Array:
            return np.minimum(np.maximum(behind - step, least), most)

        def left(step: float) -> float:
            pull = self._spring * max(end - step, 0.0)
            return float(self._stiffness.dot(held(step))) + pull + load

        stays = float(behind.mean())
        if left(stays) == 0.0:
            return stays, held(stays)
        turns = np.sort(np.concatenate([behind + least, behind + most, [end]])).tolist()
        first, last = 0, len(turns) - 1
        above, below = left(turns[first]), left(turns[last])
        if above <= 0.0:
            step = turns[first] + above / self._spring
        elif below >= 0.0:
            step = turns[last]
        else:
            while last - first > 1:
                middle = (first + last) // 2
                value = left(turns[middle])
                if value > 0.0:
                    first, above = middle, value
                else:
                    last, below = middle, value
            step = turns[first] + above / (above - below) * (turns[last] - turns[first])
        return step, held(step)
