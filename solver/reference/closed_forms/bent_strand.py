"""Closed form: moments of a strand and of a helical wire under uniform curvature.

Slip of a wire starts at the neutral axis and spreads to an angle phi on both sides of
it, with kappa / kappa_0 = phi / sin(phi), until all slips at (pi / 2) kappa_0. It
follows from equilibrium of the part that slips, with sections of the strand that stay
plane (the model of Papailiou, IEEE Trans. Power Delivery 12, 1997, without growth of
tension along the wire). Layers do not tie each other, so that the moment of a strand is
the sum over all wires, and of the bending of each about its own axis. Back and forth
both follow Masing's rule.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from solver.arrays import Array
from solver.discrete.rope.cross_section import CrossSection, WireLayer
from solver.reference.closed_forms.masing import masing


@dataclass(frozen=True)
class BentWire:
    """A helical wire whose friction bound is the same along it.

    Attributes
    ----------
    wire
        Its layer.
    radius
        Of its helix, m.
    bound
        Friction bound mu q per length of wire, N/m, above 0.
    """

    wire: WireLayer
    radius: float
    bound: float

    @property
    def first_slip(self) -> float:
        """Curvature kappa_0 at which the first point slips, 1/m."""
        wire = self.wire
        return float(
            self.bound
            / (wire.stiffness * np.cos(wire.lay) ** 2 * abs(np.sin(wire.lay)))
        )

    def moment(self, curvature: Array) -> Array:
        """Mean share of the wire in the strand's moment as it is first bent, N m.

        Parameters
        ----------
        curvature
            Grown from zero, of any shape, 1/m.
        """
        wire = self.wire
        force = self.bound * self.radius / abs(np.sin(wire.lay))
        share = np.array([self._share(float(kappa)) for kappa in np.ravel(curvature)])
        moment = self.radius * np.cos(wire.lay) * force * share
        return np.asarray(moment.reshape(np.shape(curvature)))

    def _share(self, curvature: float) -> float:
        """Moment over R cos(alpha) times the force that friction builds up in a radian."""
        ratio = curvature / self.first_slip
        if ratio <= 1.0:
            return 0.5 * ratio
        phi = 0.5 * np.pi
        if ratio < phi:
            phi = float(
                brentq(
                    lambda angle: angle - ratio * np.sin(angle), 1e-9, phi, xtol=1e-14
                )
            )
        spread = 0.5 * phi * (0.5 * np.pi - phi) / np.sin(phi)
        return float(2.0 / np.pi * (spread + np.sin(phi) - 0.5 * phi * np.cos(phi)))


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
    factors
        On mu of every layer and what it lies on, shape (n_layers,), above 0.
    """

    section: CrossSection
    friction: float
    tension: float
    factors: Array

    @cached_property
    def layers(self) -> tuple[BentWire, ...]:
        """One wire of each layer, inside out."""
        tension = np.array([self.tension])
        bounds = self.section.friction_bounds(tension, self.friction, self.factors)[
            :, 0
        ]
        return tuple(
            BentWire(
                self.section.layers[number], self.section.radii[number], float(bound)
            )
            for number, bound in enumerate(bounds)
        )

    def moment(self, curvature: Array) -> Array:
        """Moment as the strand is first bent, N m; the curvature has grown from zero, 1/m."""
        own = self.section.slipping_bending * np.asarray(curvature)
        wires = zip(self.section.layers, self.layers, strict=True)
        return np.asarray(
            own + sum(layer.wires * wire.moment(curvature) for layer, wire in wires)
        )

    def along(self, path: Array) -> Array:
        """Moment along any path of the curvature from zero, of its shape, N m."""
        return masing(path, lambda curvature: float(self.moment(np.array(curvature))))
