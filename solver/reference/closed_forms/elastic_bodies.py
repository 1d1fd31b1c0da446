"""Closed forms of elastic bodies: a cylinder on a half-plane, and a cantilever."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.laws.play import play

LEVELS = 400
"""Number of steps in which the contact grows from its middle."""
SHEAR_FACTOR = 5.0 / 6.0
"""Shear factor of a rectangular section."""


@dataclass(frozen=True)
class HalfPlane:
    """Hertz's contact, and Cattaneo's and Mindlin's partial slip on it.

    (K. L. Johnson, Contact Mechanics, 1985, sections 4.2 and 7.2.)

    Attributes
    ----------
    force
        Force P that presses the two together, N/m.
    radius
        Radius R of the cylinder, m.
    modulus
        Contact modulus E*: E / (1 - nu^2) where the other body is rigid, Pa.
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
        """Half-width of the stick zone under a shear force, as a share of mu P, m."""
        return float(self.half_width * np.sqrt(1.0 - share))

    def pressure(self, positions: Array) -> Array:
        """Pressure, Pa, at distances from the middle, m; both of any shape."""
        square = np.maximum(self.half_width**2 - positions**2, 0.0)
        return np.asarray(0.5 * self.modulus / self.radius * np.sqrt(square))

    def traction(self, positions: Array, friction: float, share: float) -> Array:
        """Shear traction under a growing share of mu P, Pa, shape of the positions."""
        sticking = replace(self, force=(1.0 - share) * self.force)
        return friction * (self.pressure(positions) - sticking.pressure(positions))

    def traction_over(self, positions: Array, friction: float, shear: Array) -> Array:
        """Shear traction under a varying shear force, (n_positions, n_instants), Pa.

        Pressing grows the contact from its middle, step by step, as flat punches that
        widen. The shear force on all within a width is a play operator of the whole
        one, of slack mu (P - P'), with the force P' at which the contact was as wide
        (M. Ciavarella, J. Appl. Mech. 65, 1998; J. Jaeger, Int. J. Solids Struct. 35,
        1998).

        Parameters
        ----------
        positions
            Distances from the middle of the contact, shape (n_positions,), m.
        friction
            Coefficient of friction mu.
        shear
            Shear force, shape (n_instants,), N/m.
        """
        level = np.linspace(0.0, 1.0, LEVELS + 1)
        pressures = []
        for share in level:
            narrower = replace(self, force=self.force * share)
            pressures.append(narrower.pressure(positions))
        bound = friction * self.force
        within = play(np.tile(shear, (len(level), 1)), bound * (1.0 - level))
        # Each step of pressure is a punch, which carries a share of its own friction.
        shares = np.diff(within, axis=0) / (bound / LEVELS)
        return np.asarray(friction * np.diff(np.stack(pressures), axis=0).T @ shares)

    def energy(self, friction: float, share: float) -> float:
        """Energy dissipated in a cycle between plus and minus a share of mu P, J/m."""
        bracket = (
            4.0 * (1.0 - share) * np.log(1.0 - share) + 4.0 * share - 2.0 * share**2
        )
        return float((friction * self.force) ** 2 / (np.pi * self.modulus) * bracket)


def cantilever(length: float, height: float, young: float, poisson: float) -> float:
    """Stiffness of a Timoshenko beam at its end, N/m per metre of thickness.

    In plane stress (J. M. Gere, S. P. Timoshenko, Mechanics of Materials, 1997).
    Lengths in m, E in Pa.
    """
    bending = length**3 / (3.0 * young * height**3 / 12.0)
    shear = length / (SHEAR_FACTOR * height * young / (2.0 * (1.0 + poisson)))
    return 1.0 / (bending + shear)


@dataclass(frozen=True)
class TwoLeaves:
    """Two equal leaves, clamped at one end, evenly pressed, and bent by a force.

    Shear between beams that stick is the same all along, so all slips at once. (L. E.
    Goodman, J. H. Klumpp, J. Appl. Mech. 23, 421, 1956.)

    Attributes
    ----------
    length, height
        Sizes of a leaf, m.
    young, poisson
        Young's modulus E, Pa, and Poisson's ratio nu, in plane stress.
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
        """Force at the first slip in first bending, N/m."""
        return 4.0 / 3.0 * self.strength * self.height

    @property
    def stiffnesses(self) -> tuple[float, float]:
        """Stiffness as one beam and as two, N/m per metre of thickness."""
        elastic = self.young, self.poisson
        stuck = cantilever(self.length, 2.0 * self.height, *elastic)
        return stuck, 2.0 * cantilever(self.length, self.height, *elastic)

    def deflection(self, force: float) -> float:
        """Deflection under a force growing from zero, m."""
        stuck, apart = self.stiffnesses
        stick = min(force, self.first_slip)
        return stick / stuck + (force - stick) / apart

    def force(self, deflection: float) -> float:
        """Force under a deflection growing from zero, N/m."""
        stuck, apart = self.stiffnesses
        stick = min(deflection, self.first_slip / stuck)
        return stick * stuck + (deflection - stick) * apart


def leaf_spring(lengths: Array) -> float | None:
    """Stiffness of graduated leaves at their end over that of the longest leaf.

    Leaves are clamped together, and lie on each other without friction or pressure.
    Each longer one presses on the end of the next alone: beams whose deflections agree
    there (S. Timoshenko, Strength of Materials II, 1956, on leaf springs).

    Parameters
    ----------
    lengths
        Lengths of the leaves, each shorter than the one before, shape (n_leaves,), m.

    Returns
    -------
    The ratio; None where two leaves come apart, so that others touch.
    """
    ends = np.append(lengths, 0.0)
    # Deflections, times E I, of a leaf under a force at its end: there, and where the
    # next ends.
    at_end = ends[:-1] ** 3 / 3.0
    beside = ends[1:] ** 2 * (3.0 * ends[:-1] - ends[1:]) / 6.0
    # Deflections of both leaves that touch at an end agree, for all ends but the first.
    matrix = np.diag(2.0 * at_end[1:])
    matrix -= np.diag(beside[1:-1], 1) + np.diag(beside[1:-1], -1)
    pushed = np.zeros(len(lengths) - 1)
    pushed[:1] = beside[0]
    forces = np.linalg.solve(matrix, pushed)
    # A negative force would pull: these two leaves come apart.
    if np.any(forces < 0.0):
        return None
    return float(at_end[0] / (at_end[0] - np.sum(forces[:1]) * beside[0]))
