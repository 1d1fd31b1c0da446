"""How far fields are from friction and contact, whatever k (solver/README.md, 4)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array


@dataclass(frozen=True, eq=False)
class Behaviour:
    """What one interface's fields say of its law, shape (n_pairs, n_instants) each, scaled.

    Attributes
    ----------
    slip
        Increment of the tangential jump.
    friction
        Friction force on the body above.
    bound
        Largest friction force.
    pressing, opening
        Pressing force, and distance of the two sides; None where the pressure is known.
    """

    slip: Array
    friction: Array
    bound: Array
    pressing: Array | None
    opening: Array | None

    @cached_property
    def dissipated(self) -> Array:
        """What full sliding along the way would dissipate."""
        return self.bound * np.abs(self.slip)

    def violation(self, mean_slip: float) -> Array:
        """Give the violation of every pair and instant, an energy, scaled.

        With q|v| + F v, where F is cut to |F| <= q: it is nowhere negative and zero exactly where
        Coulomb's law holds; the excess of |F| over q times the mean slip; and of contact N g where
        both are positive, tension times the mean slip, and overlap times the mean force.
        """
        held = np.clip(self.friction, -self.bound, self.bound)
        found = self.dissipated + held * self.slip
        found += np.abs(self.friction - held) * mean_slip
        if self.pressing is not None and self.opening is not None:
            pressed, opened = np.maximum(self.pressing, 0.0), np.maximum(self.opening, 0.0)
            found += pressed * opened + (pressed - self.pressing) * mean_slip
            found += pressed.mean() * (opened - self.opening)
        return np.maximum(found, 0.0)
