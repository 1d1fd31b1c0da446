"""Parallel elastic wires that rub on their neighbours, one of them broken (solver/README.md, 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.definitions import SettingError, choice, count, curve, quantity
from solver.loads import PULLS, instants_of, load_path
from solver.settings import Settings

LARGEST_FIELD = 25_000_000
COARSEST = 6
"""Elements below which a mesh is not coarsened."""


class StrandSettings(Settings):
    """Settings of the strand; by default the wire in the middle is broken, and pulled to and fro.

    The broken wire then regains its force over 0.2 m on either side of the break.
    """

    scene = "strand"

    load = curve(
        "cycle",
        PULLS,
        "time",
        "force",
        ("s", "N"),
        "Tension of a wire over time: a preset between 0 and the peak, or points (s, N).",
        group="Load",
        title="Tension path",
        essential=True,
    )
    peak = quantity(
        600.0,
        (0.0, 1e15),
        (0.0, 1500.0),
        "Largest tension of a wire that the preset reaches.",
        group="Load",
        title="Peak tension",
        unit="N",
        applies=lambda settings: isinstance(settings.load, str),
        essential=True,
    )
    grip = choice(
        "force",
        ["force", "displacement"],
        "What is given at the right end: the same force for every wire, or one displacement for "
        "all, that which an unbroken wire needs for this force.",
        group="Load",
        title="Grip",
        essential=True,
    )
    seed = shared.seed(lambda settings: settings.load == "random", essential=True)
    duration = shared.duration()
    instants = shared.instants(101)
    friction = quantity(
        0.3,
        (0.0, 1e6),
        (0.0, 1.0),
        "Coefficient of friction mu between neighbouring wires.",
        group="Contact",
        title="Friction coefficient μ",
        essential=True,
    )
    pressure = quantity(
        5000.0,
        (0.0, 1e15),
        (0.0, 20_000.0),
        "Pressure p of neighbouring wires on each other, per length.",
        group="Contact",
        title="Pressure p",
        unit="N/m",
        essential=True,
    )
    wires = count(
        3,
        (2, 200),
        (2, 20),
        "Number of wires side by side; each rubs on the one before it and the one after it.",
        group="Strand",
        title="Wires",
        essential=True,
    )
    broken = count(
        2,
        (0, 200),
        (0, 20),
        "Number of the broken wire; 0 breaks none.",
        group="Strand",
        title="Broken wire",
        essential=True,
    )
    break_position = quantity(
        0.5,
        (0.0, 1.0),
        (0.0, 1.0),
        "Where the wire is broken, as a share of the length; at the nearest node between the ends.",
        group="Strand",
        title="Position of the break",
        applies=lambda settings: settings.broken > 0,
        essential=True,
    )
    elements = count(
        60,
        (2, 20_000),
        (10, 400),
        "Number of linear elements of a wire, equal in length.",
        group="Strand",
        title="Elements per wire",
        essential=True,
    )
    substructures = count(
        6,
        (1, 20_000),
        (1, 50),
        "Number of substructures of a wire, at least two where a wire is broken: all wires are cut "
        "at the break, and alike.",
        group="Decomposition",
        title="Substructures per wire",
        essential=True,
    )
    length = shared.size(1.0, (0.1, 10.0), "Length L", "Length of the wires.", "Strand")
    young = shared.young("Strand")
    section = shared.section("Area of the cross section of a wire.", "Strand")

    @property
    def n_substructures(self) -> int:
        """Number of substructures in all."""
        return self.wires * max(self.substructures, 2 if self.broken else 1)

    @property
    def n_jumps(self) -> int:
        """Points of all contacts, which a reference condenses."""
        return int((self.wires - 1) * (self.elements + 1))

    def with_change(self, name: str, value: object) -> StrandSettings:
        """Change one setting; fewer elements or wires take down what could not stand beside."""
        if name == "elements" and isinstance(value, int) and value < self.substructures:
            return self.replace(elements=value, substructures=max(value, 1))
        if name == "wires" and isinstance(value, int) and value < self.broken:
            return self.replace(wires=value, broken=max(value, 0))
        return self.replace(**{name: value})

    def coarser(self) -> StrandSettings | None:
        """Give the same strand uncut with half the elements.

        None if its break, at the nearest node, left less than the tension to friction.
        """
        elements = self.elements // 2
        if elements < COARSEST:
            return None
        try:
            return self.replace(elements=elements, substructures=1)
        except SettingError:
            return None

    def check_together(self) -> None:
        """Refuse what is missing, pushed, too large, or without equilibrium."""
        self._check_sizes()
        tension = _tension(self, instants_of(self.duration, self.instants))
        if tension.min() < 0.0:
            raise SettingError(
                "load",
                self.load,
                "tensions of at least 0 N",
                "wires cannot be pushed: raise the negative values",
            )
        _check_equilibrium(self, float(tension.max()))

    def _check_sizes(self) -> None:
        if self.substructures > self.elements:
            raise SettingError(
                "substructures",
                self.substructures,
                f"1 to elements ({self.elements})",
                "give fewer substructures or more elements",
            )
        if self.broken > self.wires:
            raise SettingError(
                "broken",
                self.broken,
                f"0 to wires ({self.wires})",
                "choose one of the wires, or 0 for none",
            )
        points = self.wires * (self.elements + 1)
        if points * self.instants > LARGEST_FIELD:
            raise SettingError(
                "instants",
                self.instants,
                f"at most {LARGEST_FIELD // points} with {self.wires} wires of {self.elements} "
                "elements",
                "give fewer instants, wires or elements",
            )


@dataclass(frozen=True, eq=False)
class Strand:
    """Equal parallel wires as plain data.

    Attributes
    ----------
    length, stiffness
        Length L, m, and axial stiffness ES of one wire, N.
    wires
        Their number; they are numbered from 1, and each rubs on its neighbours.
    elements, substructures
        Of one wire: numbers of equal linear elements, and of parts that they are dealt to.
    broken
        Number of the broken wire and of the node where it is broken, or None.
    bound
        Friction bound mu p between neighbours, N/m.
    tension
        Force at the right end of every wire, or with a rigid grip that of a wire which carries
        nothing but its share, shape (n_instants,), N.
    rigid_grip
        Whether the right ends are displaced by tension times L / ES instead.
    instants, duration
        Instants, shape (n_instants,), and length of the interval, s.
    """

    length: float
    stiffness: float
    wires: int
    elements: int
    substructures: int
    broken: tuple[int, int] | None
    bound: float
    tension: Array
    rigid_grip: bool
    instants: Array
    duration: float

    @property
    def nodes(self) -> Array:
        """Positions of the nodes of a wire, shape (n_nodes,), m."""
        return np.linspace(0.0, self.length, self.elements + 1)

    @property
    def rubbing_sides(self) -> int:
        """Neighbours of the broken wire."""
        return 0 if self.broken is None else _neighbours(self.broken[0], self.wires)


def strand(settings: StrandSettings) -> Strand:
    """Make the strand that the settings describe.

    One instant stands at the end of the interval; more are spread evenly from 0 on, and the wires
    are at rest and free of stress before the first.
    """
    instants = instants_of(settings.duration, settings.instants)
    return Strand(
        length=settings.length,
        stiffness=settings.young * settings.section,
        wires=settings.wires,
        elements=settings.elements,
        substructures=settings.substructures,
        broken=(settings.broken, _break_node(settings)) if settings.broken else None,
        bound=settings.friction * settings.pressure,
        tension=_tension(settings, instants),
        rigid_grip=settings.grip == "displacement",
        instants=instants,
        duration=settings.duration,
    )


def _tension(settings: StrandSettings, instants: Array) -> Array:
    return load_path(
        settings.load, instants, settings.duration, settings.peak, settings.seed, PULLS
    )


def _break_node(settings: StrandSettings) -> int:
    node = round(settings.break_position * settings.elements)
    return min(max(node, 1), settings.elements - 1)


def _neighbours(wire: int, wires: int) -> int:
    return (wire > 1) + (wire < wires)


def _check_equilibrium(settings: StrandSettings, largest: float) -> None:
    """Refuse forces that pull the end of the broken wire out: friction alone holds it."""
    if settings.grip != "force" or not settings.broken:
        return
    share = 1.0 - _break_node(settings) / settings.elements
    sides = _neighbours(settings.broken, settings.wires)
    capacity = sides * settings.friction * settings.pressure * share * settings.length
    if largest > capacity or largest == capacity > 0.0:
        name = "peak" if isinstance(settings.load, str) else "load"
        raise SettingError(
            name,
            getattr(settings, name),
            f"tensions below {capacity:g} N, all that friction can hold of the broken wire beyond "
            "its break"
            if capacity > 0.0
            else "no tension where no friction can hold the broken wire beyond its break",
            "pull less, raise friction or pressure, move the break to the left, or take the grip "
            "of given displacement",
        )
