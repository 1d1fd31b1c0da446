"""A bent strand of helical wires: rods, each on a support that bending strains.

Plane sections of the strand stay plane, so a curvature kappa stretches the support of a
wire by kappa R cos^2(alpha) cos(theta) along the wire, with theta the polar angle at
which the wire stands. Of the wire's displacement only what it slips on its support is
unknown, and that is a rod's on a rigid support under the body force that the support's
stretch brings about (K.-O. Papailiou, On the bending stiffness of transmission line
conductors, IEEE Trans. Power Delivery 12, 1997). Its growth of tension by friction (the
capstan term) is left out, as are wires beside each other.

Degrees of freedom run along wire after wire; each is what the wire slips on its
support. Ends are held: neither an extreme fibre slips, nor what a clamp grips. So
friction there could not be told from the reactions, and they are no points of the
interfaces, one a wire, "wire LAYER.NUMBER".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from solver.arrays import Array, Indices
from solver.checks import (
    ANY_NUMBER,
    COUNT,
    FLAG,
    INSTANTS,
    NON_NEGATIVE,
    POSITIVE,
    AnyOf,
    Count,
    InstanceOf,
    Numbers,
    SequenceOf,
    check,
    check_value,
)
from solver.discrete.probes import Probe, constant
from solver.discrete.problem import Problem
from solver.discrete.rope.cross_section import CrossSection, WireLayer
from solver.discrete.structure import (
    OUTWARD,
    Act,
    Axes,
    Description,
    Hold,
    Loop,
    on_side,
)
from solver.laws import FrictionLaw


@dataclass(frozen=True, eq=False)
class RopeWire:
    """A wire of a strand, between two of its sections that do not slip.

    Attributes
    ----------
    layer, number
        Index of the layer, inside out, and of the wire around it, from 0.
    layer_data
        The wire's layer: diameter, modulus and lay.
    radius, start, length
        Radius R of the helix of its centre line, m; polar angle theta at its beginning,
        from the outermost fibre, rad; and length of the wire, m.
    strength
        Friction strength per length of wire, N/m: a number, or over time, shape
        (n_instants,).
    curvature
        Curvature of the strand at the nodes, 1/m, shape (n_nodes, n_instants).
    tension
        Force of the wire before it is bent, shape (n_instants,), N.
    stands_for
        Number of wires that this one represents, each shifted along the strand.
    """

    layer: int
    number: int
    layer_data: WireLayer
    radius: float
    start: float
    length: float
    strength: float | Array
    curvature: Array
    tension: Array
    stands_for: int = 1

    def __post_init__(self) -> None:
        over_time = Numbers(((None,),))
        check(
            self,
            layer=Count(0),
            number=Count(0),
            layer_data=InstanceOf(WireLayer),
            radius=POSITIVE,
            start=ANY_NUMBER,
            length=POSITIVE,
            strength=AnyOf(NON_NEGATIVE, Numbers(over_time.shapes, low=0.0)),
            curvature=Numbers(((None, None),)),
            tension=over_time,
            stands_for=COUNT,
        )

    @property
    def name(self) -> str:
        """Name of the wire's interface: numbers of layer and wire, from 1."""
        return f"wire {self.layer + 1}.{self.number + 1}"

    @cached_property
    def arc(self) -> Array:
        """Arc lengths of the nodes, shape (n_nodes,), m."""
        return np.linspace(0.0, self.length, len(self.curvature))

    @cached_property
    def along(self) -> Array:
        """Positions z of the nodes along the strand, shape (n_nodes,), m."""
        return np.asarray(np.cos(self.layer_data.lay) * self.arc)

    @cached_property
    def angle(self) -> Array:
        """Polar angle theta of the nodes, shape (n_nodes,), rad."""
        return np.asarray(
            self.start + self.arc * np.sin(self.layer_data.lay) / self.radius
        )

    def stuck_force(self, columns: slice | Indices = slice(None)) -> Array:
        """Change of force in the elements without slip, (n_elements, n_columns), N."""
        stuck = self._stuck_force(columns)
        return np.asarray(0.5 * (stuck[1:] + stuck[:-1]))

    def _stuck_force(self, columns: slice | Indices) -> Array:
        """Change of force at the nodes without slip, (n_nodes, n_columns), N."""
        stretch = (
            self.layer_data.stiffness * self.radius * np.cos(self.layer_data.lay) ** 2
        )
        per_curvature = stretch * np.cos(self.angle)
        return np.asarray(per_curvature[:, None] * self.curvature[:, columns])

    def body_force(self) -> Array:
        """Force per length equivalent to the strain of the support.

        That is d/ds(E A kappa R cos^2(alpha) cos(theta)), a change of curvature along
        the wire included, in differences of the elements' forces: equilibrium holds
        exactly
        on the mesh. Shape (n_nodes, n_instants), N/m.
        """
        stuck = self._stuck_force(slice(None))
        arc = self.arc
        # Half an element at both ends, where a node has one neighbour.
        force = np.concatenate([stuck[:1], 0.5 * (stuck[1:] + stuck[:-1]), stuck[-1:]])
        length = np.concatenate([arc[:1], 0.5 * (arc[1:] + arc[:-1]), arc[-1:]])
        return np.asarray(np.diff(force, axis=0) / np.diff(length)[:, None])

    def levers(self, *, at_beginning: bool) -> Array:
        """Moment of the strand per force in each element, (n_elements,), m.

        Either the moment at the wire's beginning, where the force is extrapolated from
        the middles of the first two elements; or the mean moment along the wire, which
        is that of as many evenly laid wires together at every section.
        """
        arc = self.arc
        arm = self.radius * np.cos(self.layer_data.lay)
        if not at_beginning:
            around = (
                np.diff(np.sin(self.angle)) * self.radius / np.sin(self.layer_data.lay)
            )
            return np.asarray(arm * around / (arc[-1] - arc[0]))
        levers = np.zeros(len(arc) - 1)
        shares = np.array([1.5, -0.5])[: len(levers)]
        levers[:2] = arm * np.cos(self.start) * shares / shares.sum()
        return levers


@dataclass(frozen=True, eq=False)
class Rope:
    """Helical wires of a strand whose sections stay plane: wires are independent.

    Attributes
    ----------
    wires
        Wires in any order, all with the same number of elements.
    substructures
        Number of substructures of a wire.
    tension, curvature
        Tension of the strand, N, for drawings, and its curvature, uniform or at its
        clamp, 1/m; shape (n_instants,) both.
    is_clamped
        Whether the curvature falls away from a clamp, and all wires are given; or it is
        uniform, and the wires of a layer differ by their phase alone.
    instants, duration
        Instants, shape (n_instants,), and length of the interval, s.

    Raises
    ------
    RefusedError
        For no wires, fields of another shape, or instants that do not increase.
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
        check(
            self,
            wires=SequenceOf(InstanceOf(RopeWire)),
            is_clamped=FLAG,
            section=InstanceOf(CrossSection),
            instants=INSTANTS,
            duration=POSITIVE,
            friction_law=InstanceOf(FrictionLaw),
        )
        instants = len(self.instants)
        over_time = Numbers(((instants,),))
        elements = Count(1, self.elements)
        check(self, substructures=elements, tension=over_time, curvature=over_time)
        along = Numbers(((self.elements + 1, instants),))
        strength = AnyOf(NON_NEGATIVE, over_time)
        for number, wire in enumerate(self.wires):
            name = f"Rope.wires[{number}]"
            check_value(f"{name}.curvature", wire.curvature, along)
            check_value(f"{name}.tension", wire.tension, over_time)
            check_value(f"{name}.strength", wire.strength, strength)

    @property
    def elements(self) -> int:
        """Number of elements of one wire."""
        return len(self.wires[0].curvature) - 1

    @property
    def drawn_length(self) -> float:
        """Length of the drawn part of the strand, m: of its wires, or of one turn."""
        longest = max(float(wire.along[-1]) for wire in self.wires)
        if self.is_clamped:
            return longest
        return 2.0 * longest

    def moment(self) -> Probe:
        """Bending moment of the strand, N m, from the slip of its wires.

        At the clamp, or the mean along the strand, which is that of every section; the
        moment of each wire about its own axis is included.
        """
        weights = []
        stuck = self.section.slipping_bending * self.curvature
        for wire in self.wires:
            levers = wire.stands_for * wire.levers(at_beginning=self.is_clamped)
            # The force of an element is its elongation by slip, so the moment is a sum
            # of slips.
            spring = wire.layer_data.stiffness * levers / np.diff(wire.arc)
            weights.append(-np.diff(spring, prepend=0.0, append=0.0))
            stuck = stuck + levers @ wire.stuck_force()
        together = np.concatenate(weights)
        dofs = np.flatnonzero(together)
        return Probe(dofs, together[dofs], stuck)

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop."""
        if self.is_clamped:
            title = "Curvature at the clamp"
        else:
            title = "Curvature"
        return (title, "1/m"), ("Moment", "N·m")

    def loop(self, problem: Problem) -> Loop:
        """Moment over the curvature, which drives the strand."""
        across = constant(self.curvature)
        moment = self.moment().of
        return Loop(*self.axes, across, moment)

    def description(self) -> Description:
        """Description of the strand for drawings."""
        end = on_side("right", [0.5])
        acts = (
            Act("right y", "κ", end, OUTWARD["top"], self.curvature, "1/m"),
            Act("right x", "T", end, OUTWARD["right"], self.tension, "N"),
        )
        # Beside a clamp wires move, unlike a bar, as far as anywhere.
        clamp = Hold("clamp", "left", moved=np.zeros(len(self.instants)))
        return Description(
            bodies=1,
            length=self.drawn_length,
            height=self.section.diameter,
            instants=self.instants,
            acts=acts,
            holds=(clamp,) if self.is_clamped else (),
        )
