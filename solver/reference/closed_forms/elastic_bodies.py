"""Closed forms of elastic bodies: a cylinder on a half-plane, and a cantilever."""

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
        square = np.maximum(self.half_width**2 - place**2, 0.0)
        return np.asarray(0.5 * self.modulus / self.radius * np.sqrt(square))

    def traction(self, place: Array, friction: float, share: float) -> Array:
        """Shear traction under a share of mu P that has grown, Pa; places as above."""
        back = replace(self, force=(1.0 - share) * self.force)
        return friction * (self.pressure(place) - back.pressure(place))

    def traction_over(self, place: Array, friction: float, shear: Array) -> Array:
        """Shear traction at places (n,) under a shear force (n_instants,) that turns, Pa.

        Pressing grows the contact from its middle, step by step, as flat punches that
        widen. The shear force on all within a width is a play operator of the whole
        one, of reach mu (P - P'), with the force P' at which the contact was as wide
        (M. Ciavarella, J. Appl. Mech. 65, 1998; J. Jaeger, Int. J. Solids Struct. 35,
        1998).
        """
        level = np.linspace(0.0, 1.0, LEVELS + 1)
        widths = [replace(self, force=self.force * share) for share in level]
        grown = np.stack([width.pressure(place) for width in widths])
        most = friction * self.force
        within = play(np.tile(shear, (len(level), 1)), most * (1.0 - level))
        share = np.diff(within, axis=0) / (most / LEVELS)
        return np.asarray(friction * np.diff(grown, axis=0).T @ share)

    def energy(self, friction: float, share: float) -> float:
        """Energy that friction takes in a cycle between plus and minus a share of mu P, J/m."""
        bracket = (
            4.0 * (1.0 - share) * np.log(1.0 - share) + 4.0 * share - 2.0 * share**2
        )
        return float((friction * self.force) ** 2 / (np.pi * self.modulus) * bracket)


def cantilever(length: float, height: float, young: float, poisson: float) -> float:
    """End force for a unit of deflection, of Timoshenko's beam in plane stress, N/m for a metre.

    (J. M. Gere, S. P. Timoshenko, Mechanics of Materials, 1997.) Lengths in m, E in Pa.
    """
    bending = length**3 / (3.0 * young * height**3 / 12.0)
    shear = length / (SHEAR_FACTOR * height * young / (2.0 * (1.0 + poisson)))
    return 1.0 / (bending + shear)


@dataclass(frozen=True)
class TwoLeaves:
    """Two equal leaves, clamped at one end and pressed together evenly, under a force at the other.

    Shear between beams that stick is the same all along, so all slips at once. (L. E.
    Goodman, J. H. Klumpp, J. Appl. Mech. 23, 421, 1956.)

    Attributes
    ----------
    length, height
        Of a leaf, m.
    young, poisson
        E, Pa, and nu, in plane stress.
    strength
        Friction mu p between them, Pa.
    """

    length: float
    height: float
    young: float
    poisson: float
    strength: float

    @property
    def first_slip(self) -> float:
        """Force at which they slip as they are first bent, N/m."""
        return 4.0 / 3.0 * self.strength * self.height

    @property
    def stiffnesses(self) -> tuple[float, float]:
        """Force for a unit of deflection, as one beam and as two, N/m for a metre."""
        given = self.young, self.poisson
        one = cantilever(self.length, 2.0 * self.height, *given)
        return one, 2.0 * cantilever(self.length, self.height, *given)

    def deflection(self, force: float) -> float:
        """Deflection under a force that has grown from zero, m."""
        (stuck, apart) = self.stiffnesses
        stick = min(force, self.first_slip)
        return stick / stuck + (force - stick) / apart

    def force(self, deflection: float) -> float:
        """Force under a deflection that has grown from zero, N/m."""
        stuck, apart = self.stiffnesses
        stick = min(deflection, self.first_slip / stuck)
        return stick * stuck + (deflection - stick) * apart


def leaf_spring(lengths: Array) -> float | None:
    """End force of graduated leaves for a unit of deflection, over that of the longest alone.

    Leaves are clamped together, and lie on each other without friction or pressure.
    Each longer one presses on the end of the next alone: beams whose deflections agree
    there (S. Timoshenko, Strength of Materials II, 1956, on leaf springs). The longest
    comes first, each is shorter than the one before, (n_leaves,), m. None where two
    leaves come apart, so that others touch.
    """
    ends = np.append(lengths, 0.0)
    # Deflections, times E I, of a leaf under a force at its end: there, and where the
    # next ends.
    own = ends[:-1] ** 3 / 3.0
    beside = ends[1:] ** 2 * (3.0 * ends[:-1] - ends[1:]) / 6.0
    # At the end of each but the first: of the leaf above, less of its own.
    matrix = (
        np.diag(2.0 * own[1:]) - np.diag(beside[1:-1], 1) - np.diag(beside[1:-1], -1)
    )
    pushed = np.zeros(len(lengths) - 1)
    pushed[:1] = beside[0]
    forces = np.linalg.solve(matrix, pushed)
    if np.any(forces < 0.0):
        return None
    return float(own[0] / (own[0] - np.sum(forces[:1]) * beside[0]))
