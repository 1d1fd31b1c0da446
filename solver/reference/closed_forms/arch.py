"""Statics of a symmetric arch of rigid voussoirs: a linear program in two unknowns.

The voussoirs are equal parts of a ring between radial joints. Lengths are shares of the
mean radius, weights are per area. By symmetry the crown passes a horizontal thrust H,
and no shear. H and its moment about the centre of the ring are all that statics leaves
open: forces at every joint are linear in both (J. Heyman, The Stone Skeleton, 1966).
Each half of a pointed arch has a centre of its own, on the other side of the crown.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy

from solver.arrays import Array

THICKEST = 1.9
"""Largest thickness, over the mean radius, that is looked at."""
ROUGHEST = 100.0
"""Largest coefficient of friction that is looked at."""
LEAST = 1e-4
"""Smallest thickness or coefficient of friction that is looked at: of less the linear
program leaves no digits."""
UNBOUNDED = 3
"""Status of `linprog` where the thrust has no bound."""


@dataclass(frozen=True)
class VoussoirArch:
    """An arch of voussoirs under its own weight, and a fill above it.

    Voussoirs are equal, but those at the crown of a pointed arch have only the length
    of the inner side in common with the others.

    Attributes
    ----------
    voussoirs
        Number of voussoirs.
    thickness
        Thickness of the ring over its mean radius.
    span
        Angle of the whole ring, rad: pi is a semicircle.
    friction
        Coefficient of friction mu in the joints.
    fill
        Weight of the fill per area over that of the voussoirs. It stands in columns on
        the outer side.
    cover
        Height of the fill above the outer side at the crown, over the mean radius.
    centres
        Distance between the centres of both halves over the clear width between the
        springings: 0 is a round arch, 1 an equilateral one.
    """

    voussoirs: int
    thickness: float
    span: float = np.pi
    friction: float = np.inf
    fill: float = 0.0
    cover: float = 0.0
    centres: float = 0.0

    @property
    def radii(self) -> tuple[float, float]:
        """Inner and outer radius of the ring over its mean radius."""
        return 1.0 - 0.5 * self.thickness, 1.0 + 0.5 * self.thickness

    @property
    def offset(self) -> float:
        """Distance of the centre of a half beyond the crown, over the mean radius."""
        share = self.centres / (1.0 + self.centres)
        return float(share * self.radii[0] * np.sin(0.5 * self.span))

    @property
    def crown(self) -> tuple[float, float]:
        """Heights of both sides at the crown above the centres."""
        inner, outer = self.radii
        offset = self.offset
        lowest = np.sqrt(inner**2 - offset**2)
        highest = np.sqrt(outer**2 - offset**2)
        return float(lowest), float(highest)

    @property
    def joints(self) -> Array:
        """Upright angles of the joints of one half from the crown, (n_joints,), rad.

        A joint at the crown is upright.
        """
        numbers = np.arange(self.voussoirs % 2, self.voussoirs + 1, 2)
        first = np.arcsin(self.offset / self.radii[0])
        angles = first + (0.5 * self.span - first) * numbers / self.voussoirs
        return np.where(numbers, angles, 0.0)

    @property
    def weight(self) -> float:
        """Weight of the whole arch and its fill."""
        return float(2.0 * self._loads(np.array([0.5 * self.span]))[0, 0])

    def _loads(self, angles: Array) -> Array:
        """Weight from the crown to angles, and its moment, (2, n_angles).

        The moment is about the centre of the half.
        """
        inner, outer = self.radii
        below, above = self.crown
        cosine = np.cos(angles)
        ring = 0.5 * angles * (outer**2 - inner**2)
        ring_moment = (outer**3 - inner**3) / 3.0 * (1.0 - cosine)
        # Of a pointed arch, what is beyond the crown does not belong to the half.
        beyond = _beyond(self.offset, outer, above) - _beyond(self.offset, inner, below)
        beyond_moment = ((outer**3 - above**3) - (inner**3 - below**3)) / 3.0
        columns = self._columns(angles)
        columns -= self._columns(np.arcsin([self.offset / outer]))
        own = np.stack([ring - beyond, ring_moment - beyond_moment])
        return np.asarray(own + self.fill * columns)

    def _columns(self, angles: Array) -> Array:
        """Area of columns from the angle 0 to `angles`, and its moment, (2, n_angles).

        They stand on the outer side; the moment is about the centre of the half.
        """
        _, outer = self.radii
        sine = np.sin(angles)
        cosine = np.cos(angles)
        # A column at an angle is top - outer cos(angle) high.
        top = self.crown[1] + self.cover
        column = outer * (top * sine - 0.5 * outer * (angles + sine * cosine))
        moment = outer**2 * (0.5 * top * sine**2 - outer * (1.0 - cosine**3) / 3.0)
        return np.stack([column, moment])

    @property
    def _conditions(self) -> tuple[Array, Array]:
        """A and b of the conditions A (H, moment of H) <= b, (n_rows, 2) and (n_rows,).

        H and its moment are over the weight of the whole.
        """
        angles = self.joints
        loads = self._loads(angles) / self.weight
        edges = np.repeat(np.array(self.radii)[:, None], len(angles), axis=1)
        if not angles[0]:
            loads[:, 0] = 0.0
            edges[:, 0] = self.crown
        weight, moment = loads
        inner, outer = edges[:, :, None]
        zero = np.zeros_like(angles)
        # Columns: what H, its moment about the centre, and the weight add.
        pressing = np.stack([np.cos(angles), zero, weight * np.sin(angles)], axis=1)
        shear = np.stack([-np.sin(angles), zero, weight * np.cos(angles)], axis=1)
        about_centre = np.stack([zero, zero + 1.0, moment], axis=1)
        # The resultant acts between both sides of the ring.
        rows = [inner * pressing - about_centre, about_centre - outer * pressing]
        if np.isfinite(self.friction):
            bound = self.friction * pressing
            rows += [shear - bound, -shear - bound]
        columns = np.concatenate(rows)
        return columns[:, :2], -columns[:, 2]

    @property
    def reserve(self) -> float:
        """Largest distance from all bounds, over the weight; negative: it falls."""
        matrix, bounds = self._conditions
        # The distance is a third unknown.
        with_distance = np.column_stack([matrix, np.ones(len(bounds))])
        limits = [(0.0, None), (0.0, None), (None, 1.0)]
        best = scipy.optimize.linprog(
            [0.0, 0.0, -1.0], with_distance, bounds, bounds=limits
        )
        return float(-best.fun)

    def thrusts(self) -> tuple[float, float] | None:
        """Smallest and largest thrust over the weight; None where the arch falls.

        The thrust is the least where the abutments have moved apart, and the largest
        where they have come together: infinite where a straight strut fits in.
        """
        matrix, bounds = self._conditions
        limits = [(0.0, None), (0.0, None)]
        found = []
        for sign in (1.0, -1.0):
            best = scipy.optimize.linprog([sign, 0.0], matrix, bounds, bounds=limits)
            if best.status == UNBOUNDED:
                found.append(np.inf)
            elif best.status:
                return None
            else:
                found.append(float(best.x[0]))
        return found[0], found[1]

    def thinnest(self) -> float | None:
        """Smallest thickness over the mean radius of a standing arch; None without any.

        Milankovitch, Z. Math. Phys. 55, 1907, has 0.10748 for a semicircle of thin
        voussoirs.
        """
        return _onset(
            lambda thickness: replace(self, thickness=thickness).reserve, THICKEST
        )

    def least_friction(self) -> float | None:
        """Smallest coefficient of friction of a standing arch; None without any."""
        return _onset(
            lambda friction: replace(self, friction=friction).reserve, ROUGHEST
        )


def _beyond(offset: float, radius: float, height: float) -> float:
    """Area of a disc between its upright radius and the upright line at the offset.

    On this line the circle is at the height above the centre.
    """
    return 0.5 * float(radius**2 * np.arcsin(offset / radius) + offset * height)


def _onset(reserve: Callable[[float], float], largest: float) -> float | None:
    """Smallest value up to `largest` with a reserve of at least 0, or None."""
    if reserve(largest) < 0.0:
        return None
    if reserve(LEAST) >= 0.0:
        return LEAST
    return float(scipy.optimize.brentq(reserve, LEAST, largest))
