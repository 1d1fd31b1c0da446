"""Closed form: the moment of a strand of helical wires under a uniform curvature.

Layers do not tie each other, so that it is the sum of `BentWire` over all wires, and of the bending
of each about its own axis. To and fro it follows Masing's rule with memory: every branch is the
first curve, doubled, from where the curvature turned back, until it meets a branch before it (the
play operators of M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis, Springer 1989).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.discrete.cross_section import CrossSection
from solver.reference.closed_forms.bent_wire import BentWire


@dataclass(frozen=True)
class BentStrand:
    """A strand under a tension that stays.

    Attributes
    ----------
    section
        Its core and layers.
    friction
        Coefficient of friction mu, above 0.
    tension
        N, above 0.
    """

    section: CrossSection
    friction: float
    tension: float

    @cached_property
    def layers(self) -> tuple[BentWire, ...]:
        """One wire of each layer, inside out."""
        below, above = self.section.line_pressures(np.array([self.tension]))
        bounds = self.friction * (below + above)[:, 0]
        return tuple(
            BentWire(self.section.helix(number), float(bound))
            for number, bound in enumerate(bounds)
        )

    def moment(self, curvature: Array) -> Array:
        """Give the moment as the strand is first bent, N m.

        Parameters
        ----------
        curvature
            Grown from zero, of any shape, 1/m.
        """
        own = self.section.slipping_bending * np.asarray(curvature)
        wires = zip(self.section.layers, self.layers, strict=True)
        return np.asarray(own + sum(layer.wires * one.moment(curvature) for layer, one in wires))

    def along(self, path: Array) -> Array:
        """Give the moment along any path of the curvature from zero, of its shape, N m."""
        turns, before = [(0.0, 0.0)], 0.0
        found = np.zeros(len(path))
        for instant, curvature in enumerate(path.tolist()):
            if (curvature - before) * (before - turns[-1][0]) < 0.0:
                turns.append((before, self._on_branch(turns, before)))
            while len(turns) > 1 and _meets(turns, curvature):
                del turns[-2 if len(turns) > 2 else -1 :]
            found[instant] = self._on_branch(turns, curvature)
            before = curvature
        return found

    def energy(self, peak: float) -> float:
        """Give what friction takes in a closed cycle between -peak and peak, J per metre."""
        wires = zip(self.section.layers, self.layers, strict=True)
        return float(sum(layer.wires * one.energy(peak) for layer, one in wires))

    def _on_branch(self, turns: list[tuple[float, float]], curvature: float) -> float:
        """Give the moment on the branch that begins at the last turn, or on the first curve."""
        turned, moment = turns[-1]
        share = 1.0 if len(turns) == 1 else 0.5
        away = share * (curvature - turned)
        return moment + float(np.sign(away) * self.moment(np.array(abs(away)))) / share


def _meets(turns: list[tuple[float, float]], curvature: float) -> bool:
    """Tell whether the branch from the last turn has met the one before, or the first curve."""
    last = turns[-1][0]
    if len(turns) == 2:
        return abs(curvature) >= abs(last) and curvature * last < 0.0
    return (curvature - turns[-2][0]) * (turns[-2][0] - last) >= 0.0
