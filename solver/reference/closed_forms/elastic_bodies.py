"""Closed forms of elastic bodies: a cylinder on a half-plane, and a cantilever, per length."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.laws.play import play

LEVELS = 400
"""Steps in which the contact is taken to have grown."""
SHEAR_FACTOR = 5.0 / 6.0
"""Of a rectangular section."""


@dataclass(frozen=True)
class HalfPlane:
    """Hertz's contact, and Cattaneo's and Mindlin's partial slip on it.

    (K. L. Johnson, Contact Mechanics, 1985, sections 4.2 and 7.2.)

    Attributes
    ----------
    force
        Pressing the two together, P, N/m.
    radius
        Of the cylinder, R, m.
    modulus
        E*: E / (1 - nu^2) where the other body is rigid, Pa.
    """

    force: float
    radius: float
    modulus: float

    @property
    def half_width(self) -> float:
        """Half of the width in contact, a, m."""
        return float(2.0 * np.sqrt(self.force * self.radius / (np.pi * self.modulus)))

    @property
    def peak(self) -> float:
        """Largest pressure, Pa."""
        return float(2.0 * self.force / (np.pi * self.half_width))

    def stuck(self, share: float) -> float:
        """Half-width that sticks under a shear force of a share of mu P, m."""
        return float(self.half_width * np.sqrt(1.0 - share))

    def pressure(self, place: Array) -> Array:
        """Pressure at places from the middle of the contact, m; Pa."""
        return self.peak * _root(place / self.half_width)

    def traction(self, place: Array, friction: float, share: float) -> Array:
        """Shear traction under a share of mu P that has grown, Pa; places as above.

        It is that of sliding, less the same for what sticks: two square roots.
        """
        stuck = self.stuck(share)
        back = stuck / self.half_width * _root(place / stuck) if stuck > 0.0 else 0.0
        return np.asarray(friction * self.peak * (_root(place / self.half_width) - back))

    def traction_over(self, place: Array, friction: float, shear: Array) -> Array:
        """Shear traction under a shear force that turns, Pa, shape (n, n_instants).

        Pressing grows the contact from its middle, step by step, as flat punches that widen. What
        the outer ones carry is at its bound, as on a bar that is pulled at its end: the force on
        all within a width is a play operator of the whole one, of reach mu (P - P'), with the force
        P' at which the contact was as wide (M. Ciavarella, J. Appl. Mech. 65, 1998; J. Jaeger,
        Int. J. Solids Struct. 35, 1998).

        Parameters
        ----------
        place
            From the middle of the contact, shape (n,), m.
        friction
            Coefficient mu.
        shear
            Over time from none on, with the force that presses at hand, shape (n_instants,), N/m.
        """
        level = np.linspace(0.0, 1.0, LEVELS + 1)
        widths = [replace(self, force=self.force * one) for one in level[1:]]
        grown = np.stack([np.zeros_like(place), *(one.pressure(place) for one in widths)])
        most = friction * self.force
        within = play(np.tile(shear, (len(level), 1)), most * (1.0 - level))
        share = np.diff(within, axis=0) / (most / LEVELS)
        return np.asarray(friction * np.diff(grown, axis=0).T @ share)

    def energy(self, friction: float, share: float) -> float:
        """What friction takes in a cycle between plus and minus a share of mu P, J/m."""
        bracket = 4.0 * (1.0 - share) * np.log(1.0 - share) + 4.0 * share - 2.0 * share**2
        return float((friction * self.force) ** 2 / (np.pi * self.modulus) * bracket)


def _root(share: Array) -> Array:
    return np.asarray(np.sqrt(np.maximum(1.0 - share**2, 0.0)))


def cantilever(length: float, height: float, young: float, poisson: float) -> float:
    """End force for a unit of deflection, of Timoshenko's beam in plane stress, N/m for a metre.

    (J. M. Gere, S. P. Timoshenko, Mechanics of Materials, 1997.) Lengths in m, E in Pa.
    """
    bending = length**3 / (3.0 * young * height**3 / 12.0)
    shear = length / (SHEAR_FACTOR * height * young / (2.0 * (1.0 + poisson)))
    return 1.0 / (bending + shear)
