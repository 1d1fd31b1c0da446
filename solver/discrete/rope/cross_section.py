"""Cross-section of a strand: core, layers of helical wires, stiffness, pressures.

Sections of the strand stay plane and wires are long beside their diameter, so that each
of them is a bar along its helix (G. A. Costello, Theory of Wire Rope, 2nd ed., Springer
1997, without Poisson's effect; K.-O. Papailiou, IEEE Trans. Power Delivery 12, 1997).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.refusal import RefusedError, plain

STEEL = 200e9
ALUMINIUM = 69e9
"""Young's moduli of wires, Pa."""
PRESTRESSING = 195e9
"""Young's modulus of prestressing steel, Pa (EN 1992-1-1, 3.3.6)."""
MOST_LAYERS = 5
TIGHT = 1.01
"""Radius that wires beside each other need, over that of their helix, up to which they
fit: those of real strands touch each other, and are pressed a little out of round."""
LEAST_LAY = 0.1
"""Smallest lay angle of a layer, degrees: with less a wire goes round once in hundreds
of diameters."""


@dataclass(frozen=True)
class WireLayer:
    """Equal round wires, evenly laid.

    Attributes
    ----------
    wires, diameter, young
        Number of wires, diameter, m, and Young's modulus, Pa.
    lay
        Lay angle alpha, rad; negative if laid the other way round, 0 for a core only.
    """

    wires: int
    diameter: float
    young: float
    lay: float = 0.0

    @property
    def area(self) -> float:
        """Area of the section of one wire, m^2."""
        return float(np.pi * self.diameter**2 / 4.0)

    @property
    def stiffness(self) -> float:
        """Axial stiffness E A of one wire, N."""
        return self.young * self.area


@dataclass(frozen=True)
class CrossSection:
    """A core wire, and layers around it from the inside out.

    Attributes
    ----------
    core
        A layer of one wire, without lay.
    layers
        At least one, each with a lay.

    Raises
    ------
    RefusedError
        For a core of several wires or with a lay, for no layers, sizes or lay angles
        out of range, and wires that have no room.
    """

    core: WireLayer
    layers: tuple[WireLayer, ...]

    def __post_init__(self) -> None:
        remedy = self._remedy()
        if remedy:
            allowed = (
                "rows (wires, diameter, lay angle, modulus) from the core outwards"
            )
            raise RefusedError("CrossSection", self.rows, allowed, remedy)

    def _remedy(self) -> str:
        """Remedy for rows that are no possible strand, else ""."""
        if self.core.wires != 1 or self.core.lay:
            return "row 1 is the core: give it 1 wire and a lay angle of 0°"
        if not self.layers:
            return "it has a core alone: add a row for a layer of wires around it"
        for row, (count, diameter, lay, young) in enumerate(self.rows, start=1):
            if not all(0.0 < size < np.inf for size in (count, diameter, young)):
                return (
                    f"row {row}: give one wire or more, a diameter and a modulus "
                    "above 0"
                )
            if row > 1 and not LEAST_LAY <= abs(lay) < 90.0:
                smallest = plain(LEAST_LAY)
                return (
                    f"row {row}: give a lay angle of {smallest}° or more in size, less "
                    "than 90°"
                )
        for layer, (count, diameter, lay, _) in enumerate(self.rows[1:]):
            needed = self.smallest_radius(layer)
            radius = self.radii[layer]
            if needed > TIGHT * radius:
                return (
                    f"row {layer + 2}: {count:g} wires of {diameter:g} m at {lay:g}° "
                    "do not fit beside each other on a circle of "
                    f"{2.0 * np.pi * radius:.3g} m, they need "
                    f"{2.0 * np.pi * needed:.3g} m: take fewer or thinner ones, or "
                    "more inside"
                )
        return ""

    @cached_property
    def radii(self) -> tuple[float, ...]:
        """Radius of the helix of every layer, m: each lies on the layer below."""
        radii = []
        outer = 0.5 * self.core.diameter
        for layer in self.layers:
            radii.append(outer + 0.5 * layer.diameter)
            outer += layer.diameter
        return tuple(radii)

    def smallest_radius(self, layer: int) -> float:
        """Smallest radius of a layer's helix, at which its wires touch each other, m.

        Cut across the strand a wire is an ellipse, wider by 1 / cos(alpha) (Costello,
        chapter 2).
        """
        wire = self.layers[layer]
        if wire.wires == 1:
            return 0.0
        beside = np.tan(0.5 * np.pi - np.pi / wire.wires) / np.cos(wire.lay)
        return float(0.5 * wire.diameter * np.sqrt(1.0 + beside**2))

    @property
    def rows(self) -> tuple[tuple[float, float, float, float], ...]:
        """Rows (wires, diameter, m, lay angle, degrees, modulus, Pa), inside out."""
        rows = []
        for layer in (self.core, *self.layers):
            # Rounded, as an angle that was given in degrees has no more digits.
            lay = float(f"{np.degrees(layer.lay):.12g}")
            rows.append((float(layer.wires), layer.diameter, lay, layer.young))
        return tuple(rows)

    @property
    def diameter(self) -> float:
        """Diameter of the whole strand, m."""
        return 2.0 * self.radii[-1] + self.layers[-1].diameter

    @property
    def wires(self) -> int:
        """Number of all wires, the core among them."""
        return 1 + sum(layer.wires for layer in self.layers)

    @cached_property
    def stiffness(self) -> float:
        """Axial stiffness, N, of a strand that does not untwist."""
        laid = 0.0
        for layer in self.layers:
            laid += layer.wires * layer.stiffness * np.cos(layer.lay) ** 3
        return self.core.stiffness + float(laid)

    @cached_property
    def slipping_bending(self) -> float:
        """Bending stiffness of slipping wires, sum of E I cos(alpha), N m^2."""
        total = 0.0
        for layer in (self.core, *self.layers):
            bending = layer.wires * layer.young * np.pi * layer.diameter**4 / 64.0
            total += float(bending * np.cos(layer.lay))
        return total

    @cached_property
    def stuck_bending(self) -> float:
        """Bending stiffness while all wires stick, N m^2."""
        together = 0.0
        for layer, radius in zip(self.layers, self.radii, strict=True):
            stiffness = 0.5 * layer.wires * layer.stiffness
            together += stiffness * radius**2 * np.cos(layer.lay) ** 3
        return self.slipping_bending + float(together)

    def wire_tension(self, layer: int, tension: Array) -> Array:
        """Force in a wire of a layer under a tension of the strand, N, of its shape."""
        wire = self.layers[layer]
        share = wire.stiffness * np.cos(wire.lay) ** 2 / self.stiffness
        return np.asarray(share * tension)

    def line_pressures(self, tension: Array) -> tuple[Array, Array]:
        """Line pressures on the inner and outer face of the wires of every layer.

        A wire presses with N sin^2(alpha) / R per length. What a layer and all outside
        it press is spread over the wires below; each layer passes it on. Inner and
        outer faces, shape (n_layers, n_instants) each, N per metre of wire, under the
        tension, (n_instants,), N.
        """
        below = []
        above = []
        passed = np.zeros_like(tension)
        # From the outside in, as each layer passes on all that presses on it.
        for number in reversed(range(len(self.layers))):
            layer = self.layers[number]
            radius = self.radii[number]
            # Per length of wire, of what acts per length of strand.
            share = np.cos(layer.lay) / layer.wires
            above.append(share * passed)
            pressure = (
                self.wire_tension(number, tension) * np.sin(layer.lay) ** 2 / radius
            )
            passed = passed + pressure / share
            below.append(share * passed)
        return np.array(below[::-1]), np.array(above[::-1])

    def friction_strengths(
        self, tension: Array, friction: float, factors: Array
    ) -> Array:
        """Friction strength of the wires of every layer, from below and above, N/m.

        Shape (n_layers, n_instants), per metre of wire, under the tension of the
        strand, (n_instants,), N; `factors` are mu of every layer on what it lies on
        over `friction`.
        """
        below, above = self.line_pressures(tension)
        outer = np.append(factors[1:], 1.0)
        return friction * (factors[:, None] * below + outer[:, None] * above)


def laid(rows: Iterable[Sequence[float]]) -> CrossSection:
    """Cross-section from its rows, in the format of `CrossSection.rows`."""
    layers = []
    for wires, diameter, lay, young in rows:
        layers.append(WireLayer(int(wires), diameter, young, float(np.radians(lay))))
    return CrossSection(layers[0], tuple(layers[1:]))


def seven_wire() -> CrossSection:
    """Seven-wire prestressing strand of 15.7 mm and 150 mm2 (prEN 10138-3).

    Six wires of 5.2 mm on one of 5.4 mm, with a lay length of 16 diameters (14 to 18
    are allowed).
    """
    lay = np.degrees(np.arctan(2.0 * np.pi * 5.3e-3 / (16.0 * 15.7e-3)))
    return laid([(1, 5.4e-3, 0.0, PRESTRESSING), (6, 5.2e-3, lay, PRESTRESSING)])


def mooring(layers: int) -> CrossSection:
    """Spiral strand for moorings of platforms and stays of bridges: 6, 12, ... wires.

    Wires of 5 mm and lay angles of 17 degrees are usual sizes, of no one product; the
    core wire is so much thicker that the wires of a layer have room beside each other.
    Three layers are 35 mm thick, and break at some 1100 kN.
    """
    rows = [(1, 5.3e-3, 0.0, STEEL)]
    for number in range(1, layers + 1):
        rows.append((6 * number, 5e-3, -17.0 * (-1) ** number, STEEL))
    return laid(rows)


def conductor() -> CrossSection:
    """Overhead conductor of aluminium on steel: Drake, 28.1 mm (ASTM B232).

    Seven steel wires of 3.454 mm, then 10 and 16 of aluminium of 4.442 mm. Lay lengths
    are 25, 13 and 11 times the diameter over the layer, within what the standard
    allows. It breaks at 140 kN.
    """
    steel = 3.454e-3
    aluminium = 4.442e-3
    wires = np.array([steel, aluminium, aluminium])
    over = steel + 2.0 * np.cumsum(wires)
    lay_lengths = np.array([25.0, 13.0, 11.0]) * over
    lays = np.degrees(np.arctan(np.pi * (over - wires) / lay_lengths))
    return laid(
        [
            (1, steel, 0.0, STEEL),
            (6, steel, lays[0], STEEL),
            (10, aluminium, -lays[1], ALUMINIUM),
            (16, aluminium, lays[2], ALUMINIUM),
        ]
    )


CONSTRUCTIONS: Mapping[str, Callable[[int], CrossSection]] = {
    "mooring": mooring,
    "seven-wire": lambda layers: seven_wire(),
    "conductor": lambda layers: conductor(),
}
"""Constructions by name, as functions of the number of layers (where it is free)."""
