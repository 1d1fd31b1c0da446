"""Settings of time and of load paths, which all scenes have, and the instants of a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache, cached_property

import numpy as np
import param

from solver.arrays import Array
from solver.discrete.drives import Drive
from solver.settings.definitions import LOAD, CurveParameter, Rows, about
from solver.settings.friction import FrictionSettings
from solver.settings.load_paths import (
    NO_KNOTS,
    SAME,
    Preset,
    apart,
    instants_of,
    interpolate,
    thinned,
    turning_knots,
)

EVERY_POINT = 2_000_000
"""Nodes times instants up to which every point of a table of a path is an instant: 10 s
along the bar. Beyond, those stay without which it would be wrong by `THINNED`
somewhere."""
THINNED = 1e-3
"""Share of its range by which a path that is thinned may differ from its table."""
POINTS = 9
"""Of a table that stands for a preset which is not linear between its corners."""
STRAIGHT = 1e-9
"""Share of its range by which rounding bends a straight part of a path."""


class LoadSettings(FrictionSettings):
    """Settings of time and of load paths, beside those of the method and of friction."""

    elements: param.Integer[int]

    cycles = LOAD.count(
        1,
        (1, 5000),
        (1, 20),
        "How often what the presets of load paths do, after their beginning, is done in the "
        "interval; a preset that does not come back (ramp, hold, random) stays as it is.",
        applies=lambda settings: settings.is_repeatable,
    )
    duration = LOAD.quantity(
        1.0,
        (1e-9, 1e9),
        (0.1, 10.0),
        "Length of the time interval. Friction does not feel the rate: only the time axis changes.",
        title="Duration T",
        unit="s",
    )
    instants = LOAD.count(
        101,
        (1, 20_001),
        (11, 401),
        "Number of instants at which the problem is solved, at least: points at which a path turns "
        "or bends are instants too, and the load is linear between them.",
    )
    seed = LOAD.count(
        1,
        (0, 2**31 - 1),
        (0, 50),
        "Seed of random load paths: the same seed gives the same path.",
        applies=lambda settings: any(
            getattr(settings, name) == "random" for name in settings.paths
        ),
    )

    @property
    def n_nodes(self) -> int:
        """Number of nodes of all bodies."""
        return self.n_bodies * (self.elements + 1)

    @property
    def paths(self) -> tuple[str, ...]:
        """Names of the curves over time that do something."""
        return tuple(
            name
            for name, definition in self.definitions().items()
            if isinstance(definition, CurveParameter)
            and definition.abscissa == "time"
            and self.applies(name)
        )

    @classmethod
    @cache
    def _sizes(cls) -> Mapping[str, tuple[str, ...]]:
        """Settings of what presets of each path over time may reach."""
        paths = {
            name: about(definition).path
            for name, definition in cls.definitions().items()
        }
        return {
            path: tuple(n for n in paths if paths[n] == path)
            for path in paths.values()
            if path
        }

    def size_setting(self, path: str) -> str | None:
        """Setting of the largest value that a preset of a path reaches; None where that is 1."""
        sizes = self._sizes().get(path, ())
        definitions = self.definitions()
        acting = (name for name in sizes if about(definitions[name]).applies(self))
        return next(acting, sizes[0] if sizes else None)

    def size_of(self, path: str) -> float:
        """Largest value that a preset of a path over time reaches."""
        name = self.size_setting(path)
        if name is None:
            return 1.0
        return float(getattr(self, name))

    def acts(self, path: str) -> bool:
        """Return whether a path over time has any size, of its preset or of its own."""
        return not isinstance(getattr(self, path), str) or self.size_of(path) != 0.0

    def size_or_table(self, path: str) -> str:
        """Name of the setting by which a path becomes smaller: of its size, or its table."""
        if isinstance(getattr(self, path), str):
            return self.size_setting(path) or path
        return path

    def curve_units(self, name: str) -> tuple[str, ...]:
        """Units of a curve under the present values: those of a path are as its size."""
        units: tuple[str, ...] = self.definitions()[name].units
        size = self.size_setting(name)
        if size is None:
            return units
        return (units[0], about(self.definitions()[size]).unit)

    def preset(self, name: str) -> Preset | None:
        """Preset that a path over time has; None where it is a table."""
        value = getattr(self, name)
        if not isinstance(value, str):
            return None
        preset: Preset = self.definitions()[name].presets[value]
        return preset

    @property
    def is_repeatable(self) -> bool:
        """Return whether any load path is a preset that comes back to where it began."""
        presets = map(self.preset, self.paths)
        return any(
            preset is not None and preset.repeats is not None for preset in presets
        )

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
            instants = self._instants(
                {name: self._thinned(name) for name in self._tables}
            )
        instants.flags.writeable = False
        return instants

    @property
    def _tables(self) -> tuple[str, ...]:
        return tuple(name for name in self.paths if self.preset(name) is None)

    def _thinned(self, name: str) -> Rows:
        """Points of a table without which its path would be wrong by a share of its range."""
        table: Rows = getattr(self, name)
        kept = thinned(table, THINNED * float(np.ptp(np.array(table)[:, 1])))
        return tuple(table[place] for place in kept)

    def _instants(self, tables: Mapping[str, Rows]) -> Array:
        """Instants for these tables and all presets; a single one has those where paths turn."""
        knots = {name: np.array(table)[:, 0] for name, table in tables.items()}
        presets = (
            name for name in self.paths if name not in tables and self.size_of(name)
        )
        knots |= {name: self.knots(name) for name in presets}
        if self.instants == 1:
            knots = {name: self._turning(name, times) for name, times in knots.items()}
        given = [knots[name] for name in tables]
        corners = [times for name, times in knots.items() if name not in tables]
        joined = (np.concatenate([NO_KNOTS, *times]) for times in (given, corners))
        return instants_of(self.duration, self.instants, *joined)

    def knots(self, name: str) -> Array:
        """Times at which a path turns or bends, s; a table's points."""
        preset = self.preset(name)
        if preset is None:
            return np.array(getattr(self, name))[:, 0]
        return self.duration * preset.corners(self.seed, self.cycles)

    def _turning(self, name: str, knots: Array) -> Array:
        inside = knots[(knots > 0.0) & (knots < self.duration)]
        every = np.concatenate([[0.0], inside, [self.duration]])
        return turning_knots(every, self.path_at(name, every))

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
        return self.path_at(name, self.times())

    def path_at(self, name: str, instants: Array) -> Array:
        """The same at instants of one's own, s."""
        preset = self.preset(name)
        if preset is None:
            return interpolate(getattr(self, name), instants)
        values = preset.value(instants / self.duration, self.seed, self.cycles)
        return self.size_of(name) * values

    def drives(self) -> tuple[Drive, ...]:
        """Loads and motions over time that are not zero, by the settings of their sizes."""
        found = []
        for path in self.paths:
            values = self.path(path)
            if np.any(values):
                unit = self.curve_units(path)[1]
                found.append(Drive(self.size_or_table(path), unit, values))
        return tuple(found)

    def points(self, name: str) -> Rows:
        """Points of a curve or rows of a table, or those that stand for its preset."""
        value: str | Rows = getattr(self, name)
        if not isinstance(value, str):
            return value
        preset = self.definitions()[name].presets[value]
        if not isinstance(preset, Preset):
            rows: Rows = preset.rows(self)
            return rows
        even = np.linspace(0.0, self.duration, (POINTS - 1) * self.cycles + 1)
        times = instants_of(self.duration, 2, NO_KNOTS, self.knots(name))
        times = instants_of(self.duration, 2, times, even)
        values = self.path_at(name, times)
        kept = thinned(
            np.column_stack([times, values]), STRAIGHT * float(np.ptp(values))
        )
        return as_points(times[kept], values[kept])


def as_points(where: Array, values: Array) -> Rows:
    """Points with as many digits as one likes to read."""
    return tuple(
        (float(f"{a:.6g}"), float(f"{b:.6g}"))
        for a, b in zip(where, values, strict=True)
    )
