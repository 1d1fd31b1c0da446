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
import scipy

from solver.arrays import Array
from solver.discrete.rope.cross_section import CrossSection, WireLayer
from solver.reference.closed_forms.masing import masing


@dataclass(frozen=True)
class BentWire:
    """A helical wire whose friction strength is the same along it.

    Attributes
    ----------
    wire
        Layer of the wire.
    radius
        Radius of its helix, m.
    strength
        Friction strength mu q per length of wire, N/m, above 0.
    """

    wire: WireLayer
    radius: float
    strength: float

    @property
    def first_slip(self) -> float:
        """Curvature kappa_0 at the first slip, 1/m."""
        wire = self.wire
        return float(
            self.strength
            / (wire.stiffness * np.cos(wire.lay) ** 2 * abs(np.sin(wire.lay)))
        )

    def moment(self, curvature: Array) -> Array:
        """Mean contribution of the wire to the strand's moment in first bending, N m.

        Parameters
        ----------
        curvature
            Curvature, grown from zero, of any shape, 1/m.

        Returns
        -------
        The moment, of the same shape.
        """
        wire = self.wire
        force = self.strength * self.radius / abs(np.sin(wire.lay))
        shares = np.vectorize(self._share, otypes=[float])(curvature)
        return np.asarray(self.radius * np.cos(wire.lay) * force * shares)

    def _share(self, curvature: float) -> float:
        """Moment over R cos(alpha) times the friction force per radian."""
        ratio = curvature / self.first_slip
        if ratio <= 1.0:
            return 0.5 * ratio
        phi = 0.5 * np.pi
        # Zero solves the equation of phi, too, so the bracket leaves it out.
        if ratio < phi:
            phi = float(
                scipy.optimize.brentq(
                    _beyond_slip, 1e-9, phi, args=(ratio,), xtol=1e-14
                )
            )
        spread = 0.5 * phi * (0.5 * np.pi - phi) / np.sin(phi)
        return float(2.0 / np.pi * (spread + np.sin(phi) - 0.5 * phi * np.cos(phi)))


def _beyond_slip(angle: float, ratio: float) -> float:
    """Residual phi - (kappa / kappa_0) sin(phi), zero at the angle of the slip zone."""
    return angle - ratio * float(np.sin(angle))


@dataclass(frozen=True)
class BentStrand:
    """A strand under constant tension.

    Attributes
    ----------
    section
        Cross-section: its core and layers.
    friction
        Coefficient of friction mu, above 0.
    tension
        Tension of the strand, N, above 0.
    factors
        Factors on mu between every layer and the one below, shape (n_layers,), above 0.
    """

    section: CrossSection
    friction: float
    tension: float
    factors: Array

    @cached_property
    def layers(self) -> tuple[BentWire, ...]:
        """A wire of each layer, inside out."""
        section = self.section
        tension = np.array([self.tension])
        strengths = section.friction_strengths(tension, self.friction, self.factors)
        steady = strengths[:, 0].tolist()
        wires = zip(section.layers, section.radii, steady, strict=True)
        return tuple(BentWire(*wire) for wire in wires)

    def moment(self, curvature: Array) -> Array:
        """Moment in first bending, N m, of the shape of the curvature.

        The curvature has grown from zero, of any shape, 1/m.
        """
        moment = np.zeros(np.shape(curvature))
        for layer, wire in zip(self.section.layers, self.layers, strict=True):
            moment = moment + layer.wires * wire.moment(curvature)
        return np.asarray(self.section.slipping_bending * curvature + moment)

    def along(self, path: Array) -> Array:
        """Moment along a path of the curvature from zero, 1/m; (n_instants,), N m."""
        return masing(path, lambda curvature: float(self.moment(np.array(curvature))))
