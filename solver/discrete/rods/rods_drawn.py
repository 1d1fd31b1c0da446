"""Arrows of loads and motions, and holds, of rods for drawings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from solver.arrays import Array
from solver.discrete.rods.end import End, EndName
from solver.discrete.structure import OUTWARD, Act, Hold, on_side

SHOWN = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
"""Positions at which a body force that changes along the rods is drawn, and the
pressure where rods rub; over the length."""
SEVERAL = 8
"""Largest number of wires of which each shows its load."""
TO_THE_RIGHT = OUTWARD["right"]


def acts_at_ends(ends: Mapping[EndName, End], wires: int) -> Iterator[Act]:
    """Yield arrows of forces on the ends, and of displacements of their supports.

    The ends are those of a number of wires.
    """
    shown = wires if wires <= SEVERAL else 1
    heights = (np.arange(shown) + 0.5) / shown
    for side, end in ends.items():
        if end.displacement is not None:
            places = on_side(side, heights[:1] if side == "left" else heights)
            yield Act(f"{side} x", "u", places, TO_THE_RIGHT, end.displacement, "m")
        elif end.force is not None:
            places = on_side(side, heights)
            yield Act(f"{side} x", "F", places, TO_THE_RIGHT, end.force, "N")


def act_of_body_force(force: Array) -> Act:
    """Arrow of a force per length: uniform, (n_instants,), or (n_nodes, n_instants)."""
    if force.ndim == 1:
        shares = np.array([0.5])
        values = force
    else:
        shares = SHOWN
        values = _at(shares, force)
    return Act("body", "b", on_side("body", shares), TO_THE_RIGHT, values, "N/m")


def act_of_strain(strain: Array) -> Act:
    """Largest strain of elements, (n_elements, n_instants), which has no arrow."""
    values = strain[np.abs(strain).max(axis=1).argmax()]
    return Act("body strain", "ε₀", on_side("body", []), TO_THE_RIGHT, values, "")


def act_of_settlement(settlement: Array) -> Act:
    """Arrows of the displacement of a support at nodes, (n_nodes, n_instants), m."""
    # At both ends, too: of a pile the largest settlement is that of its head.
    shares = np.linspace(0.0, 1.0, len(SHOWN))
    places = on_side("bottom", shares)
    settled = _at(shares, settlement)
    return Act("bottom x", "s", places, TO_THE_RIGHT, settled, "m")


def acts_of_pressure(pressure: Array, strengths: Array, nodes: Array) -> Iterator[Act]:
    """Yield the arrows of a pressure, (n_instants,), N/m, where rods rub, if anywhere.

    The strengths of friction have the shape (n_nodes, n_instants); the positions of the
    nodes, (n_nodes,), are shares of the length.
    """
    is_rubbing = np.interp(SHOWN, nodes, strengths.max(axis=1)) > 0.0
    if is_rubbing.any():
        places = on_side("top", SHOWN[is_rubbing])
        yield Act("top y", "p", places, OUTWARD["bottom"], pressure, "N/m")


def _at(shares: Array, values: Array) -> Array:
    """Values, (n, n_instants), at shares of the length, (n,).

    They are those of the nearest nodes, of values of all nodes, (n_nodes, n_instants).
    """
    return values[np.rint(shares * (len(values) - 1)).astype(np.intp)]


def holds_of_ends(ends: Mapping[EndName, End]) -> Iterator[Hold]:
    """Yield springs and clamps of the ends."""
    for side, end in ends.items():
        if end.is_on_spring:
            yield Hold("spring", side, moved=end.displacement)
        elif end.is_prescribed and (side == "left" or not np.any(end.displacement)):
            yield Hold("clamp", side, moved=end.displacement)


def holds_of_support(strengths: Array) -> Iterator[Hold]:
    """Yield the support of a single rod, along each stretch that rubs.

    By the strengths of friction at nodes, (n_nodes, n_instants).
    """
    rubs = np.flatnonzero(strengths.any(axis=1))
    for stretch in np.split(rubs, np.flatnonzero(np.diff(rubs) > 1) + 1):
        if len(stretch) > 1:
            first, last = stretch[[0, -1]] / (len(strengths) - 1)
            yield Hold("support", "bottom", (float(first), float(last)))
