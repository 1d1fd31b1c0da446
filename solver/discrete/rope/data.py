"""A strand of helical wires that is bent, as plain data: a list of wires, each on its support."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from solver.arrays import Array
from solver.discrete.rope.cross_section import CrossSection
from solver.discrete.rope.helical_wire import HelicalWire
from solver.laws import FrictionLaw
from solver.refusal import RefusedError

COARSEST = 6
"""Elements of a wire below which a mesh is not coarsened."""


@dataclass(frozen=True, eq=False)
class RopeWire:
    """A wire of a strand, between two of its places that do not slip.

    Attributes
    ----------
    layer, number
        From 0 on, inside out and around.
    helix
        Its geometry and stiffness E A.
    diameter
        m.
    length
        Of the wire, m.
    bound
        Friction bound per length of wire, N/m: one number, or over time (n_instants,).
    curvature
        Of the strand at the nodes, 1/m, shape (n_nodes, n_instants).
    tension
        Its force before it is bent, shape (n_instants,), N.
    stands_for
        Number of wires that are this one, each at another place along the strand.
    """

    layer: int
    number: int
    helix: HelicalWire
    diameter: float
    length: float
    bound: Array
    curvature: Array
    tension: Array
    stands_for: int = 1

    @property
    def name(self) -> str:
        """What its interface is called: numbers of layer and wire, from 1 on."""
        return f"wire {self.layer + 1}.{self.number + 1}"

    @property
    def area(self) -> float:
        """Of its cross-section, m^2."""
        return float(np.pi * self.diameter**2 / 4.0)

    @property
    def young(self) -> float:
        """Young's modulus, Pa."""
        return self.helix.stiffness / self.area

    @property
    def arc(self) -> Array:
        """Arc lengths of the nodes, shape (n_nodes,), m."""
        return np.linspace(0.0, self.length, len(self.curvature))

    @property
    def along(self) -> Array:
        """Places of the nodes along the strand, z, shape (n_nodes,), m."""
        return np.asarray(np.cos(self.helix.lay) * self.arc)


@dataclass(frozen=True, eq=False)
class RopeData:
    """Helical wires of a strand whose sections stay plane, so that none is tied to another.

    Their order means nothing.

    Attributes
    ----------
    wires
        All on equally many elements.
    substructures
        Parts that the elements of a wire are dealt to.
    tension
        Of the strand, shape (n_instants,), N, for whoever draws it.
    curvature
        Of the strand, uniform or at its clamp, same shape, 1/m.
    is_clamped
        Whether the curvature falls away from a clamp, so that every wire is there; or it is the
        same all along, and the wires of a layer differ by their phase alone.
    section
        The strand's cross-section.
    instants, duration
        Instants, shape (n_instants,), and length of the interval, s.
    friction_law
        Of every wire on what it lies on.

    Raises
    ------
    RefusedError
        For wires on different meshes or instants, or none.
    """

    wires: Sequence[RopeWire]
    substructures: int
    tension: Array
    curvature: Array
    is_clamped: bool
    section: CrossSection
    instants: Array
    duration: float
    friction_law: FrictionLaw = field(default_factory=FrictionLaw)

    def __post_init__(self) -> None:
        shapes = {wire.curvature.shape for wire in self.wires}
        if len(shapes) != 1 or next(iter(shapes))[1] != len(self.instants):
            raise RefusedError(
                "Rope.wires",
                sorted(shapes),
                f"wires with a curvature of one shape, [n_nodes, {len(self.instants)}]",
                "give all wires the same number of nodes",
            )
        if min(float(np.min(wire.bound)) for wire in self.wires) < 0.0:
            raise RefusedError("RopeWire.bound", "below 0", "0 or more", "give no bound below zero")

    @property
    def elements(self) -> int:
        """Of one wire."""
        return len(self.wires[0].curvature) - 1

    @property
    def length(self) -> float:
        """Of the longest wire, m."""
        return max(wire.length for wire in self.wires)

    @property
    def seen_length(self) -> float:
        """Of the strand that is drawn, m: what is bent, or a turn of its outermost wires."""
        longest = max(float(wire.along[-1]) for wire in self.wires)
        return longest if self.is_clamped else 2.0 * longest

    @property
    def stiffness(self) -> float:
        """Axial stiffness of the stiffest wire, N."""
        return max(wire.helix.stiffness for wire in self.wires)

    def coarser(self) -> Self | None:
        """Give the same uncut wires on half the elements, or None where no front would be seen."""
        elements = self.elements // 2
        if elements < COARSEST:
            return None
        fine, coarse = np.linspace(0.0, 1.0, self.elements + 1), np.linspace(0.0, 1.0, elements + 1)
        place = np.interp(coarse, fine, np.arange(self.elements + 1.0))
        left = np.minimum(place.astype(np.intp), self.elements - 1)
        share = (place - left)[:, None]
        wires = [
            replace(
                wire,
                curvature=(1.0 - share) * wire.curvature[left] + share * wire.curvature[left + 1],
            )
            for wire in self.wires
        ]
        return replace(self, wires=wires, substructures=1)
