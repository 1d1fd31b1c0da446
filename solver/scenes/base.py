"""What the settings of all scenes have alike: a mesh that is cut, and paths over time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
import param

from solver.arrays import Array
from solver.definitions import Pairs, Rows, SettingError, about, choice, count, curve, quantity
from solver.discrete.problem import Problem
from solver.discrete.structure import LoopFields, Structure
from solver.laws import FrictionLaw, Strength
from solver.loads import (
    NO_KNOTS,
    PRESETS,
    PRESSURES,
    SAME,
    Preset,
    apart,
    instants_of,
    interpolate,
    thinned,
    turning_knots,
)
from solver.reference.closed_forms import ExactCurve
from solver.refusal import plain
from solver.scenes.entry import Features
from solver.settings import Settings

LARGEST_FIELD = 25_000_000
"""Nodes times instants; a run keeps about ten fields over them."""
EVERY_POINT = 2_000_000
"""Nodes times instants up to which every point of a table of a path is an instant: 10 s along the
bar. Beyond, those stay without which it would be wrong by `THINNED` somewhere."""
THINNED = 1e-3
"""Share of its range by which a path that is thinned may differ from its table."""
POINTS = 9
"""Of a table that stands for a preset which is not linear between its corners."""
SHORTEST_SLIP = 1e-12
"""Between points of a strength, m."""
LARGEST_FACTOR = 1e3
"""Of a strength."""
STIFFNESSES = 1e-9, 1e9
"""Of contact, over the unit of `contact_stiffness`: softer or stiffer, no digits are left."""
STRAIGHT = 1e-9
"""Share of its range by which rounding bends a straight part of a path."""


class SceneSettings(Settings):
    """Settings of a scene: those of the method, and its own."""

    friction_law = choice(
        "coulomb",
        ["coulomb", "compliant", "slip-dependent", "general"],
        "coulomb: a point sticks until the friction force reaches its bound. compliant: it gives "
        "way like a spring before it slips (Jenkins' element), as in joints and fretting. "
        "slip-dependent: its bound grows or falls with the slip that has gone by, as when surfaces "
        "run in. general: all of that together, with its stiffness in absolute units, and cohesion "
        "and a cap.",
        group="Contact",
        title="Friction law",
    )
    contact_stiffness = quantity(
        100.0,
        (1e-3, 1e9),
        (1.0, 1e4),
        "Stiffness of that spring, as a multiple of E S / L² along a rod, with the harmonic "
        "mean S of its elements, or of E / L in the plane; of all wires of a rope alike, as a "
        "multiple of the stiffest E S over the square of the longest L.",
        group="Contact",
        title="Contact stiffness",
        applies=lambda settings: settings.friction_law == "compliant",
        logarithmic=True,
    )
    tangential_stiffness = quantity(
        0.0,
        (0.0, 1e18),
        (1e4, 1e9),
        "Stiffness of a spring along the interface, in series with friction, per length of rod: a "
        "bond, a soft layer. 0: rigid.",
        group="Contact",
        title="Tangential stiffness",
        unit="N/m^2",
        applies=lambda settings: settings.is_general,
        logarithmic=True,
    )
    cohesion = quantity(
        0.0,
        (0.0, 1e15),
        (0.0, 5000.0),
        "Friction force per length of rod without any pressure, beside μ p.",
        group="Contact",
        title="Cohesion c",
        unit="N/m",
        applies=lambda settings: settings.is_general,
    )
    friction_cap = quantity(
        0.0,
        (0.0, 1e15),
        (0.0, 5000.0),
        "Largest friction force per length of rod that pressure and cohesion make, before slip. 0: "
        "none.",
        group="Contact",
        title="Friction cap",
        unit="N/m",
        applies=lambda settings: settings.is_general,
    )
    strength = curve(
        "constant",
        ("constant", "linear"),
        "slip",
        "factor",
        ("m", ""),
        "Factor on the largest friction force over the accumulated slip of a point. constant: 1. "
        "linear: from 1 to the ratio below. Or points (m, factor), the first (0, 1), such as a "
        "peak, softening and a residual; the last one stays.",
        group="Contact",
        title="Strength over slip",
        applies=lambda settings: settings.is_general,
    )

    friction_ratio = quantity(
        1.5,
        (0.0, 1e3),
        (0.5, 2.0),
        "Last friction over the first: above 1 it hardens with slip, below it softens.",
        group="Contact",
        title="Last friction over first",
        applies=lambda settings: settings.is_linear_in_slip,
    )
    slip_length = quantity(
        1e-4,
        (1e-12, 1e6),
        (1e-6, 1e-2),
        "Accumulated slip of a point at which its friction is the last.",
        group="Contact",
        title="Slip length",
        unit="m",
        applies=lambda settings: settings.is_linear_in_slip,
        logarithmic=True,
    )

    cycles = count(
        1,
        (1, 5000),
        (1, 20),
        "How often what the presets of load paths do, after their beginning, is done in the "
        "interval; a preset that does not come back (ramp, hold, random) stays as it is.",
        group="Load",
        title="Cycles",
        applies=lambda settings: settings.is_repeatable,
    )

    seed: param.Integer[int]
    """Every scene defines it, where it shows it."""

    PARTS: ClassVar[Mapping[str, str]] = {"substructures": "elements"}
    """Numbers of parts, and the numbers that they are parts of and cannot exceed."""
    MESH: ClassVar[Sequence[str]] = ("elements",)
    """Numbers of elements: twice each is a mesh of half the size."""
    LOADS: ClassVar[Sequence[str]] = ()
    """Settings that say how much it is loaded; the first that applies counts."""
    PATH: ClassVar[str] = "load"
    """Setting that says how that goes on over time."""
    SHAPES: ClassVar[Mapping[str, Preset]] = PRESETS
    """What the presets of paths over time stand for."""
    PEAKS: ClassVar[Mapping[str, str]] = {}
    """Setting of the largest value that the preset of each path reaches."""
    BEHIND: ClassVar[Mapping[str, str]] = {}
    """Settings that place or scale what acts, whether it does or not."""
    STIFFNESSES: ClassVar[Sequence[str]] = ("tangential_stiffness",)
    """Stiffnesses of contact; 0 is rigid."""
    PROFILES: ClassVar[Mapping[str, Pairs]] = {}
    """Presets of factors along the body, over shares of its length."""

    @classmethod
    def chief(cls) -> tuple[str, ...]:
        """Settings that a scene is about: the path and size of its load, friction, cuts, and k."""
        return (cls.PATH, "seed", *cls.LOADS, "friction", "substructures", "k_scale")

    @property
    def is_general(self) -> bool:
        """Whether all parts of the friction law are given."""
        return bool(self.friction_law == "general")

    @property
    def is_linear_in_slip(self) -> bool:
        """Whether friction changes with slip by a ratio over a length."""
        by_ratio = self.is_general and self.strength == "linear"
        return by_ratio or bool(self.friction_law == "slip-dependent")

    @property
    def contact_unit(self) -> float:
        """Unit of `contact_stiffness`: N/m^2 along rods, N/m^3 in the plane."""
        raise NotImplementedError

    @property
    def law(self) -> FrictionLaw:
        """Law of friction, beside mu."""
        if self.friction_law == "compliant":
            return FrictionLaw(stiffness=self.contact_stiffness * self.contact_unit)
        table = self.points("strength") if self._changes_with_slip else None
        strength = None if table is None else Strength(*zip(*table, strict=True))
        if not self.is_general:
            return FrictionLaw(strength=strength)
        return FrictionLaw(
            stiffness=self.tangential_stiffness or np.inf,
            cohesion=self.cohesion,
            cap=self.friction_cap or np.inf,
            strength=strength,
        )

    @property
    def _changes_with_slip(self) -> bool:
        return self.is_linear_in_slip or (self.is_general and self.strength != "constant")

    def structure(self) -> Structure:
        """Bodies, with all that acts on them."""
        raise NotImplementedError

    def sentence(self) -> str:
        """What there is, what acts on it, and what rubs, for whoever sees it for the first time."""
        raise NotImplementedError

    def coarser(self) -> Iterator[Structure]:
        """Yield the same scene, uncut, on ever coarser meshes; nothing where no run starts so."""
        yield from ()

    def exact(self, problem: Problem, solution: LoopFields | None) -> Iterable[ExactCurve]:
        """What is known of the scene without a mesh.

        Parameters
        ----------
        problem
            Its discrete problem.
        solution
            What an incremental solver found, if it did: closed forms of contact are for its forces.
        """
        return ()

    @property
    def features(self) -> Features:
        """What the scene has under its present settings."""
        return Features()

    @property
    def n_interfaces(self) -> int:
        """Number of interfaces of which each may have its own mu."""
        return 1

    @property
    def n_nodes(self) -> int:
        """Number of nodes of all bodies."""
        raise NotImplementedError

    def size_of(self, path: str) -> float:
        """Largest value that a preset of a path over time reaches."""
        return float(getattr(self, self.PEAKS[path]))

    def peak_or_table(self, path: str) -> str:
        """Name of the setting by which a path becomes smaller: of its peak, or its table."""
        return self.PEAKS[path] if isinstance(getattr(self, path), str) else path

    def behind(self) -> Mapping[str, str]:
        """Settings that place or scale what acts on the scene, where any does.

        By what they are behind: "right x" along a side, "body" throughout, "gap", "break".
        """
        return {what: name for what, name in self._behind().items() if self.applies(name)}

    def _behind(self) -> Mapping[str, str]:
        return self.BEHIND

    @property
    def is_repeatable(self) -> bool:
        """Whether any load path is a preset that comes back to where it began."""
        shapes = (self._shapes.get(getattr(self, name)) for name in self.paths)
        return any(shape is not None and shape.repeats is not None for shape in shapes)

    def times(self) -> Array:
        """Instants, shape (n_instants,), s: points of all paths, and others spread between them."""
        return self._times

    @property
    def n_instants(self) -> int:
        """Number of instants: at least as many as are set."""
        return len(self._times)

    @cached_property
    def _times(self) -> Array:
        instants = self._instants({name: getattr(self, name) for name in self._tables})
        if self.n_nodes * len(instants) > EVERY_POINT and self._tables:
            instants = self._instants({name: self._thinned(name) for name in self._tables})
        instants.flags.writeable = False
        return instants

    @property
    def _tables(self) -> tuple[str, ...]:
        return tuple(name for name in self.paths if not isinstance(getattr(self, name), str))

    def _thinned(self, name: str) -> Pairs:
        """Points of a table without which its path would be wrong by a share of its range."""
        table: Pairs = getattr(self, name)
        kept = thinned(table, THINNED * float(np.ptp(np.array(table)[:, 1])))
        return tuple(table[place] for place in kept)

    def _instants(self, tables: Mapping[str, Pairs]) -> Array:
        """Instants for these tables and all presets; a single one has those where paths turn."""
        acting = [name for name in self.paths if name in tables or self.size_of(name)]
        knots = {name: self._knots(tables.get(name, getattr(self, name))) for name in acting}
        if self.instants == 1:
            knots = {name: self._turning(name, times) for name, times in knots.items()}
        given = [knots[name] for name in tables]
        corners = [times for name, times in knots.items() if name not in tables]
        joined = (np.concatenate([NO_KNOTS, *times]) for times in (given, corners))
        return instants_of(self.duration, self.instants, *joined)

    def _knots(self, path: str | Pairs) -> Array:
        """Times at which a path turns or bends; a table's points."""
        if not isinstance(path, str):
            return np.array(path)[:, 0]
        return self.duration * self._shapes[path].corners(self.seed, self.cycles)

    def _turning(self, name: str, knots: Array) -> Array:
        inside = knots[(knots > 0.0) & (knots < self.duration)]
        every = np.concatenate([[0.0], inside, [self.duration]])
        return turning_knots(every, self._along(name, every))

    def left_out(self) -> Iterator[str]:
        """Yield what a run does not see of its tables: paths of too many points are thinned."""
        times = self.times()
        for name in self._tables:
            when, values = np.array(getattr(self, name)).T
            inside = (when >= times[0]) & (when <= times[-1])
            seen = interpolate(np.column_stack([times, self.path(name)]), when[inside])
            lost = float(np.abs(values[inside] - seen).max(initial=0.0))
            span = float(np.ptp(values))
            count = len(apart(when[inside], times, SAME * self.duration))
            if self.instants > 1 and count and lost > STRAIGHT * span:
                yield (
                    f"{name}: {count} of {len(values)} points are left out; they differ from the "
                    f"path that is solved by at most {100.0 * lost / span:.2g} % of their range"
                )

    def path(self, name: str) -> Array:
        """A quantity over time from the setting of its path; a table has its own size."""
        return self._along(name, self.times())

    def points(self, name: str) -> Pairs:
        """Points of a curve setting, or those that stand for its preset."""
        own: str | Pairs = getattr(self, name)
        if name == "strength" and (self.is_linear_in_slip or isinstance(own, str)):
            last = self.friction_ratio if self.is_linear_in_slip else 1.0
            return (0.0, 1.0), (self.slip_length, last)
        if not isinstance(own, str):
            return own
        if name == "friction_factors":
            return tuple((float(number), 1.0) for number in range(1, self.n_interfaces + 1))
        if name.endswith("_profile"):
            return tuple((x * self.length, factor) for x, factor in self.PROFILES[own])
        even = np.linspace(0.0, self.duration, (POINTS - 1) * self.cycles + 1)
        times = instants_of(self.duration, 2, NO_KNOTS, self._knots(own))
        times = instants_of(self.duration, 2, times, even)
        values = self._along(name, times)
        kept = thinned(np.column_stack([times, values]), STRAIGHT * float(np.ptp(values)))
        return as_points(times[kept], values[kept])

    def rows(self, name: str) -> Rows:
        """Rows of a table, or points of a curve, or those that stand for its preset."""
        return self.points(name)

    def _along(self, name: str, instants: Array) -> Array:
        curve: str | Pairs = getattr(self, name)
        if not isinstance(curve, str):
            return interpolate(curve, instants)
        values = self._shapes[curve].value(instants / self.duration, self.seed, self.cycles)
        return self.size_of(name) * values

    @property
    def _shapes(self) -> Mapping[str, Preset]:
        return {**self.SHAPES, **PRESSURES}

    def with_change(self, name: str, value: object) -> Self:
        """Change one setting; numbers of parts that exceed it come down with it."""
        changes = {name: value}
        for part, whole in self.PARTS.items():
            if name == whole and isinstance(value, int) and value < getattr(self, part):
                changes[part] = max(value, self.definitions()[part].bounds[0])
        return self.replace(**changes)

    @property
    def ends(self) -> dict[str, int]:
        """Largest numbers of parts that there are to deal out, by the name of their setting."""
        return {part: getattr(self, whole) for part, whole in self.PARTS.items()}

    def check_together(self) -> None:
        """Refuse more parts than there is to deal out, fields beyond memory, and no law at all."""
        self._check_law()
        for part, whole in self.PARTS.items():
            value, most = getattr(self, part), getattr(self, whole)
            if value > most:
                raise SettingError(
                    part,
                    value,
                    f"{self.definitions()[part].bounds[0]} to {whole} ({most})",
                    f"lower {part} or raise {whole}",
                )
        most = LARGEST_FIELD // self.n_nodes
        if self.n_instants > most:
            raise SettingError(
                "instants",
                self.n_instants,
                f"at most {most} with {self.n_nodes} nodes",
                "give fewer instants, or a coarser mesh"
                if self.n_instants == self.instants
                else "give paths with fewer points or cycles, or a coarser mesh",
            )

    def _check_law(self) -> None:
        """Refuse a strength that does not begin at 1, and stiffness beyond a number's digits."""
        table = self.strength
        if not self.is_general:
            return
        if not isinstance(table, str):
            slips, factors = np.array(table).T
            begins = len(table) > 1 and table[0] == (0.0, 1.0)
            grows = begins and np.all(np.diff(slips) >= SHORTEST_SLIP)
            if not (grows and factors.min() >= 0.0 and factors.max() <= LARGEST_FACTOR):
                raise SettingError(
                    "strength",
                    table,
                    "at least two points (slip, factor), the first (0, 1), factors from 0 to "
                    f"{plain(LARGEST_FACTOR)}, slips that grow by {plain(SHORTEST_SLIP)} m",
                    "the factor at slip 0 is 1, as the rest of the law says what friction is there",
                )
        low, high = (share * self.contact_unit for share in STIFFNESSES)
        for name in self.STIFFNESSES:
            value = getattr(self, name)
            if self.applies(name) and value and not low <= value <= high:
                unit = about(self.definitions()[name]).unit
                raise SettingError(
                    name,
                    value,
                    f"0, or from {plain(low)} {unit} to {plain(high)} {unit} with such bodies",
                    "write 0 where nothing gives way, or take away friction where nothing holds",
                )


def as_points(where: Array, values: Array) -> Pairs:
    """Points with as many digits as one likes to read."""
    return tuple((float(f"{a:.6g}"), float(f"{b:.6g}")) for a, b in zip(where, values, strict=True))
