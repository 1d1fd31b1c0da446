"""What the settings of all scenes have alike: a mesh that is cut, and paths over time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache, cached_property
from typing import ClassVar, Self

import numpy as np

from solver.arrays import Array
from solver.definitions import Pairs, Rows, SettingError, about, count, quantity
from solver.discrete.problem import Problem
from solver.discrete.structure import LoopFields, Structure
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
from solver.scenes.entry import Features
from solver.scenes.friction_law import FrictionSettings

LARGEST_FIELD = 25_000_000
"""Nodes times instants; a run keeps about ten fields over them."""
EVERY_POINT = 2_000_000
"""Nodes times instants up to which every point of a table of a path is an instant: 10 s along the
bar. Beyond, those stay without which it would be wrong by `THINNED` somewhere."""
THINNED = 1e-3
"""Share of its range by which a path that is thinned may differ from its table."""
POINTS = 9
"""Of a table that stands for a preset which is not linear between its corners."""
STRAIGHT = 1e-9
"""Share of its range by which rounding bends a straight part of a path."""


class SceneSettings(FrictionSettings):
    """Settings of a scene: those of the method and of friction, and its own."""

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

    duration = quantity(
        1.0,
        (1e-9, 1e9),
        (0.1, 10.0),
        "Length of the time interval. Friction does not feel the rate: only the time axis changes.",
        group="Load",
        title="Duration T",
        unit="s",
        logarithmic=True,
    )
    instants = count(
        101,
        (1, 20_001),
        (11, 401),
        "Number of instants at which the problem is solved, at least: points at which a path turns "
        "or bends are instants too, and the load is linear between them.",
        group="Load",
        title="Instants",
    )
    seed = count(
        1,
        (0, 2**31 - 1),
        (0, 50),
        "Seed of random load paths: the same seed gives the same path.",
        group="Load",
        title="Seed",
        applies=lambda settings: any(
            getattr(settings, name) == "random" for name in settings.paths
        ),
    )

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
    PROFILES: ClassVar[Mapping[str, Pairs]] = {}
    """Presets of factors along the body, over shares of its length."""

    @classmethod
    def chief(cls) -> tuple[str, ...]:
        """Settings that a scene is about: the path and size of its load, friction, cuts, and k."""
        return (cls.PATH, "seed", *cls.LOADS, "friction", "substructures", "k_scale")

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

    @classmethod
    @cache
    def _sizes(cls) -> Mapping[str, tuple[str, ...]]:
        """Settings of what presets of each path over time may reach."""
        paths = {name: about(definition).path for name, definition in cls.definitions().items()}
        return {
            path: tuple(n for n in paths if paths[n] == path) for path in paths.values() if path
        }

    def size_setting(self, path: str) -> str | None:
        """Setting of the largest value that a preset of a path reaches; None where that is 1."""
        sizes, definitions = self._sizes().get(path, ()), self.definitions()
        acting = (name for name in sizes if about(definitions[name]).applies(self))
        return next(acting, sizes[0] if sizes else None)

    def size_of(self, path: str) -> float:
        """Largest value that a preset of a path over time reaches."""
        name = self.size_setting(path)
        return 1.0 if name is None else float(getattr(self, name))

    def acts(self, path: str) -> bool:
        """Whether a path over time has any size, of its preset or of its own."""
        return not isinstance(getattr(self, path), str) or self.size_of(path) != 0.0

    def size_or_table(self, path: str) -> str:
        """Name of the setting by which a path becomes smaller: of its size, or its table."""
        return self.size_setting(path) or path if isinstance(getattr(self, path), str) else path

    def curve_units(self, name: str) -> tuple[str, ...]:
        """Units of a curve under the present values: those of a path are as its size."""
        units, size = super().curve_units(name), self.size_setting(name)
        return units if size is None else (units[0], about(self.definitions()[size]).unit)

    def behind(self) -> Mapping[str, str]:
        """Settings that place or scale what acts on the scene, where any does.

        By what they are behind: "right x" along a side, "body" throughout, "gap", "break". Of
        several the last counts that is not 0.
        """
        settings: dict[str, str] = {}
        for name, definition in self.definitions().items():
            for place in about(definition).places:
                if self.applies(name) and (place not in settings or getattr(self, name)):
                    settings[place] = name
        return settings

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
        if name == "strength":
            return self.strength_points()
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
        super().check_together()
        for part, whole in self.PARTS.items():
            value, most = getattr(self, part), getattr(self, whole)
            if value > most:
                raise self.refusal(
                    part,
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


def as_points(where: Array, values: Array) -> Pairs:
    """Points with as many digits as one likes to read."""
    return tuple((float(f"{a:.6g}"), float(f"{b:.6g}")) for a, b in zip(where, values, strict=True))
