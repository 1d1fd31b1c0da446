"""Strands of helical wires that are built: a core, and layers laid round it by turns."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from solver.discrete.cross_section import CrossSection, WireLayer

STEEL, ALUMINIUM = 200e9, 69e9
"""Young's moduli of wires, Pa."""
PRESTRESSING = 195e9
"""The same of prestressing steel, Pa (EN 1992-1-1, 3.3.6)."""
MOST_LAYERS = 5


def seven_wire() -> CrossSection:
    """Give a seven-wire strand of 15.7 mm and 150 mm2, as prEN 10138-3 has it for prestressing.

    Six wires of 5.2 mm on one of 5.4 mm, with a lay length of 16 diameters (14 to 18 are allowed).
    """
    diameter, radius = 15.7e-3, 5.3e-3
    lay = float(np.arctan(2.0 * np.pi * radius / (16.0 * diameter)))
    return CrossSection(
        WireLayer(1, 5.4e-3, PRESTRESSING), (WireLayer(6, 5.2e-3, PRESTRESSING, lay),)
    )


def mooring(layers: int) -> CrossSection:
    """Give a spiral strand as it moors platforms and stays bridges: 6, 12, 18, ... wires.

    Wires of 5 mm and lay angles of 17 degrees are usual sizes, of no one product; the core wire is
    so much thicker that the wires of a layer have room beside each other. Three layers are 35 mm
    thick, and break at some 1100 kN.
    """
    lay = np.radians(17.0)
    return CrossSection(
        WireLayer(1, 5.3e-3, STEEL),
        tuple(
            WireLayer(6 * (number + 1), 5e-3, STEEL, float(lay * (-1) ** number))
            for number in range(layers)
        ),
    )


def conductor() -> CrossSection:
    """Give an overhead conductor of aluminium on steel: Drake, 26 and 7 wires, 28.1 mm (ASTM B232).

    Seven steel wires of 3.454 mm, then 10 and 16 of aluminium of 4.442 mm. Lay lengths are 25, 13
    and 11 times the diameter over the layer, within what the standard allows. It breaks at 140 kN.
    """
    steel, aluminium = 3.454e-3, 4.442e-3
    over = np.array([3.0 * steel, 3.0 * steel + 2.0 * aluminium, 3.0 * steel + 4.0 * aluminium])
    radii = 0.5 * (over - np.array([steel, aluminium, aluminium]))
    lays = np.arctan(2.0 * np.pi * radii / (np.array([25.0, 13.0, 11.0]) * over))
    first, second, third = (float(lay) for lay in lays)
    return CrossSection(
        WireLayer(1, steel, STEEL),
        (
            WireLayer(6, steel, STEEL, first),
            WireLayer(10, aluminium, ALUMINIUM, -second),
            WireLayer(16, aluminium, ALUMINIUM, third),
        ),
    )


CONSTRUCTIONS: Mapping[str, Callable[[int], CrossSection]] = {
    "mooring": mooring,
    "seven-wire": lambda layers: seven_wire(),
    "conductor": lambda layers: conductor(),
}
"""By name, each of a number of layers where it has a choice."""
