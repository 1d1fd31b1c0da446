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


@dataclass(frozen=True, eq=False)
class CutWires:
    """All wires of the layers at one section, inside out and around.

    Attributes
    ----------
    wire
        Number in `Rope.wires` of the wire that represents each, shape (n_cut,).
    centres
        Centre of each, sideways and towards the outermost fibre, shape (n_cut, 2), m.
    arc
        Arc length of the section along the wire that represents it, (n_cut,), m.
    side
        -1 where a wire slips the other way, on the other side of the plane of bending,
        else 1; (n_cut,).
    """

    wire: Indices
    centres: Array
    arc: Array
    side: Array


def cut_at(rope: Rope, position: float) -> CutWires:
    """Cut all wires at a position along the strand, m.

    Under a uniform curvature the one wire of a layer passes half a turn, from the
    outermost fibre to the innermost; the other half is its mirror image in the plane of
    bending.
    """
    cuts = []
    for number, wire in enumerate(rope.wires):
        angles, arcs, sides = _cut_wire(wire, position, is_clamped=rope.is_clamped)
        around = np.stack([np.sin(angles), np.cos(angles)], axis=1)
        numbers = np.full(len(angles), number)
        cuts.append(CutWires(numbers, wire.radius * around, arcs, sides))
    return CutWires(
        wire=np.concatenate([cut.wire for cut in cuts]),
        centres=np.concatenate([cut.centres for cut in cuts]),
        arc=np.concatenate([cut.arc for cut in cuts]),
        side=np.concatenate([cut.side for cut in cuts]),
    )


def _cut_wire(
    wire: RopeWire, position: float, *, is_clamped: bool
) -> tuple[Array, Array, Array]:
    """Section of the wires that a wire represents, at a position along the strand, m.

    Returns
    -------
    Their polar angles, rad, arc lengths, m, and the side of each half turn, -1 or 1;
    shape (stands_for,) each.
    """
    lay = wire.layer_data.lay
    starts = wire.start + 2.0 * np.pi * np.arange(wire.stands_for) / wire.stands_for
    arc = position / np.cos(lay)
    if is_clamped:
        arc = min(arc, wire.length)
    angles = starts + arc * np.sin(lay) / wire.radius
    if is_clamped:
        return angles, np.full(len(angles), arc), np.ones(len(angles))
    # Half a turn of the wire represents both halves: angles are folded onto it.
    turned = np.sign(lay) * angles
    sides = np.where(np.sin(turned) < 0.0, -1.0, 1.0)
    arcs = np.arccos(np.cos(turned)) / np.pi * wire.length
    return angles, arcs, sides


def wire_forces(rope: Rope, displacement: Array, columns: slice | Indices) -> Array:
    """Forces in the elements of all wires: of the tension and of bending.

    Shape (n_wires, n_elements, n_columns), N, from the displacement of the problem's
    degrees of freedom, (n_dofs, n_instants), m, at some of the instants.
    """
    slips = np.split(displacement[:, columns], len(rope.wires))
    forces = []
    for wire, slip in zip(rope.wires, slips, strict=True):
        spring = wire.layer_data.stiffness / np.diff(wire.arc)
        change = spring[:, None] * np.diff(slip, axis=0) + wire.stuck_force(columns)
        forces.append(wire.tension[columns] + change)
    return np.stack(forces)


def wire_stresses(rope: Rope, displacement: Array, columns: slice | Indices) -> Array:
    """Mean stresses over the sections of wires, Pa, of the shape of `wire_forces`."""
    areas = np.array([wire.layer_data.area for wire in rope.wires])
    return np.asarray(wire_forces(rope, displacement, columns) / areas[:, None, None])


def stress_at(rope: Rope, cut: CutWires, stress: Array) -> Array:
    """Mean stress of every cut wire, (n_cut, n_columns), from `wire_stresses`, Pa.

    The stress is linear between the middles of elements, and beyond the
    first and the last of them.
    """
    sizes = np.array([wire.length / rope.elements for wire in rope.wires])
    at = cut.arc / sizes[cut.wire] - 0.5
    first = np.clip(np.floor(at).astype(np.intp), 0, max(rope.elements - 2, 0))
    share = (at - first)[:, None]
    low = stress[cut.wire, first]
    high = stress[cut.wire, np.minimum(first + 1, rope.elements - 1)]
    return np.asarray((1.0 - share) * low + share * high)


def stress_ranges(rope: Rope, displacement: Array, instants: slice) -> Array:
    """Largest range of the stress of every wire over instants, (n_wires,), Pa.

    At the fibre of the wire where its bending about its own axis adds to the mean
    stress. `displacement` is that of the problem's dofs, (n_dofs, n_instants), m.
    """
    axial = wire_stresses(rope, displacement, instants)
    curvature = np.stack([wire.curvature[:, instants] for wire in rope.wires])
    outer = np.array(
        [0.5 * wire.layer_data.young * wire.layer_data.diameter for wire in rope.wires]
    )
    bent = outer[:, None, None] * 0.5 * (curvature[:, 1:] + curvature[:, :-1])
    swings = [np.ptp(axial + sign * bent, axis=2).max(axis=1) for sign in (-1.0, 1.0)]
    return np.asarray(np.maximum(*swings))
