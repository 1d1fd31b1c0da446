"""Closed form: the moment of a helical wire of a strand under uniform curvature.

Slip starts at the neutral axis and spreads to an angle phi on both sides of it, with
kappa / kappa_0 = phi / sin(phi), until all slips at (pi / 2) kappa_0. It follows from equilibrium
of the part that slips, with sections of the strand that stay plane (the model of Papailiou, IEEE
Trans. Power Delivery 12, 1997, without growth of tension along the wire). Back and forth it follows
Masing's rule: the first curve, doubled, from the point of return.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from solver.arrays import Array
from solver.discrete.helical_wire import HelicalWire


@dataclass(frozen=True)
class BentWire:
    """A helical wire whose friction bound is the same along it.

    Attributes
    ----------
    wire
        Its geometry and stiffness.
    bound
        Friction bound mu q per length of wire, N/m, above 0.
    """

    wire: HelicalWire
    bound: float

    @property
    def first_slip(self) -> float:
        """Curvature kappa_0 at which the first point slips, 1/m."""
        own = self.wire
        return float(self.bound / (own.stiffness * np.cos(own.lay) ** 2 * abs(np.sin(own.lay))))

    def slipping(self, curvature: float) -> float:
        """Give the angle phi of slip on each side of the neutral axis, rad, of a first bending."""
        share = curvature / self.first_slip
        if share <= 1.0:
            return 0.0
        if share >= 0.5 * np.pi:
            return 0.5 * np.pi
        return float(brentq(lambda phi: phi - share * np.sin(phi), 1e-9, 0.5 * np.pi, xtol=1e-14))

    def moment(self, curvature: Array) -> Array:
        """Give the wire's mean share in the strand's moment as it is first bent, N m.

        Parameters
        ----------
        curvature
            Grown from zero, of any shape, 1/m.
        """
        own = self.wire
        force = self.bound * own.radius / abs(np.sin(own.lay))
        share = np.array([self._share(float(one)) for one in np.ravel(curvature)])
        moment = own.radius * np.cos(own.lay) * force * share
        return np.asarray(moment.reshape(np.shape(curvature)))

    def after_return(self, peak: float, curvature: Array) -> Array:
        """Give it as the strand is bent back from a peak, by Masing's rule, N m."""
        return np.asarray(
            self.moment(np.array(peak)) - 2.0 * self.moment(0.5 * (peak - np.asarray(curvature)))
        )

    def energy(self, peak: float) -> float:
        """Give what friction takes in a closed cycle between -peak and peak, J per wire and metre.

        Of length along the strand.
        """
        below = quad(lambda kappa: float(self.moment(np.array(kappa))), 0.0, peak, limit=200)[0]
        return float(8.0 * below - 4.0 * peak * self.moment(np.array(peak)))

    def _share(self, curvature: float) -> float:
        """Give the moment over R cos(alpha) times the force that friction builds up in a radian."""
        phi = self.slipping(curvature)
        if phi == 0.0:
            return 0.5 * curvature / self.first_slip
        spread = 0.5 * phi * (0.5 * np.pi - phi) / np.sin(phi)
        return float(2.0 / np.pi * (spread + np.sin(phi) - 0.5 * phi * np.cos(phi)))
