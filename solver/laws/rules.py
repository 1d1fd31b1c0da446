"""What jumps of the displacement obey at one instant, as incremental solvers read it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, Indices, in_rows


@dataclass(frozen=True, eq=False)
class Rules:
    """What the jumps obey, stacked; shape (n,) each, but for the bound.

    Attributes
    ----------
    normal
        Whether the jump is a normal one.
    gap
        Opening where it vanishes, scaled; 0 of tangential ones.
    partner
        Place of the normal jump whose force carries the friction; the own place without one.
    friction
        Coefficient mu, 0 of normal jumps.
    bound
        Friction force r that needs no normal force, scaled, shape (n, n_instants), or (n, 1) where
        it stays the same; 0 of normal jumps.
    compliance
        Displacement in series with the jump, per force, scaled; 0 of normal jumps. What is said of
        the jump is then said of the jump and it together.
    ratio, slip_length
        Factor on the bound in the end, and the accumulated slip, scaled, on the way to which it
        goes there from 1 in proportion; 1 and infinity where slip changes nothing.
    """

    normal: NDArray[np.bool_]
    gap: Array
    partner: Indices
    friction: Array
    bound: Array
    compliance: Array
    ratio: Array
    slip_length: Array

    @property
    def smooth(self) -> NDArray[np.bool_]:
        """Tangential jumps without friction."""
        return np.asarray(~self.normal & (self.friction == 0.0) & ~self.bounded)

    @property
    def bounded(self) -> NDArray[np.bool_]:
        """Jumps whose friction ever needs no normal force."""
        return np.asarray(self.bound.any(axis=1))

    def kept(self, moving: Indices) -> Rules:
        """Keep the unknown jumps; friction needs its normal force among them."""
        place = np.full(len(self.gap), -1)
        place[moving] = np.arange(len(moving))
        partner = place[self.partner[moving]]
        alone = partner < 0
        partner[alone] = np.flatnonzero(alone)
        friction = self.friction[moving] * ~alone
        return Rules(
            self.normal[moving],
            self.gap[moving],
            partner,
            friction,
            self.bound[moving],
            self.compliance[moving],
            self.ratio[moving],
            self.slip_length[moving],
        )

    @property
    def change(self) -> bool:
        """Whether friction changes with slip anywhere."""
        return bool(np.any(np.isfinite(self.slip_length) & (self.ratio != 1.0)))

    def factor(self, gone: Array) -> Array:
        """Factor on the friction bound after accumulated slip, shape (n, n_instants) both."""
        share = np.minimum(gone / self.slip_length[:, None], 1.0)
        return np.asarray(1.0 + (self.ratio[:, None] - 1.0) * share)

    def bounds(self, force: Array, slip: Array) -> Array:
        """Largest friction force, (r + mu f_n) times its factor, shape (n, n_instants).

        Parameters
        ----------
        force, slip
            Of all jumps, slip per instant, same shape.
        """
        carried = self.friction[:, None] * force[self.partner]
        most = self.bound + np.maximum(carried, 0.0)
        if self.change:
            most = most * self.factor(np.cumsum(np.abs(slip), axis=1))
        return np.asarray(most)


def stacked(rules: Sequence[Rules]) -> Rules:
    """Put the rules of all components of all interfaces one after the other."""
    return Rules(*(in_rows([getattr(one, name.name) for one in rules]) for name in fields(Rules)))
