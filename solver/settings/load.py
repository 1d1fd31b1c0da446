"""Settings of time and of load paths of all scenes, and the instants of a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache, cached_property

import numpy as np
import param

from solver.arrays import Array
from solver.discrete.drives import Drive
from solver.settings.definitions import LOAD, CurveParameter, Rows, properties_of
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
along the bar. Beyond, points are left out while the path stays within `THINNED`."""
THINNED = 1e-3
"""Largest difference of a thinned path from its table, over the path's range."""
POINTS = 9
"""Points of a table that represents a preset with curved parts."""
STRAIGHT = 1e-9
"""Deviation of a straight part of a path by rounding, over the path's range."""


class LoadSettings(FrictionSettings):
    """Settings of time and load paths, beside those of method and friction."""

    elements: param.Integer[int]

    cycles = LOAD.count(
        1,
        (1, 5000),
        (1, 20),
        "How often what the presets of load paths do, after their beginning, is done "
        "in the interval; a preset that does not come back (ramp, hold, random) stays "
        "as it is.",
        applies=lambda settings: settings.is_repeatable,
    )
    duration = LOAD.quantity(
        1.0,
        (1e-9, 1e9),
        (0.1, 10.0),
        "Length of the time interval. Friction does not feel the rate: only the time "
        "axis changes.",
        title="Duration T",
        unit="s",
    )
    instants = LOAD.count(
        101,
        (1, 20_001),
        (11, 401),
        "Number of instants at which the problem is solved, at least: points at which "
        "a path turns or bends are instants too, and the load is linear between them.",
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

    @classmethod
    @cache
    def _curves(cls) -> tuple[str, ...]:
        """Names of the curves over time."""
        names = []
        for name, definition in cls.definitions().items():
            is_curve = isinstance(definition, CurveParameter)
            if is_curve and definition.abscissa == "time":
                names.append(name)
        return tuple(names)

    @cached_property
    def paths(self) -> tuple[str, ...]:
        """Names of the curves over time that apply under the present settings."""
        # Settings stay, and their instants ask for the paths again and again.
        return tuple(name for name in self._curves() if self.applies(name))

    @classmethod
    @cache
    def _sizes(cls) -> Mapping[str, tuple[str, ...]]:
        """Names of the settings of largest values, by the name of the path."""
        sizes: dict[str, tuple[str, ...]] = {}
        for name, definition in cls.definitions().items():
            path = properties_of(definition).path
            if path:
                sizes[path] = (*sizes.get(path, ()), name)
        return sizes

    def size_setting(self, path: str) -> str | None:
        """Name of the setting of a path's largest value; None if that is 1."""
        sizes = self._sizes().get(path, ())
        definitions = self.definitions()
        # Of several sizes, as a force or a displacement, the one that applies.
        for name in sizes:
            if properties_of(definitions[name]).applies(self):
                return name
        if sizes:
            return sizes[0]
        return None

    def size_of(self, path: str) -> float:
        """Largest value of a path over time, if it is a preset."""
        name = self.size_setting(path)
        if name is None:
            return 1.0
        return float(getattr(self, name))

    def is_active(self, path: str) -> bool:
        """Check whether a path is a table, or a preset with a nonzero largest value."""
        return not isinstance(getattr(self, path), str) or self.size_of(path) != 0.0

    def size_or_table(self, path: str) -> str:
        """Name of the setting that scales a path: its largest value, or its table."""
        if isinstance(getattr(self, path), str):
            return self.size_setting(path) or path
        return path

    def curve_units(self, name: str) -> tuple[str, ...]:
        """Units of a curve's columns under the present settings."""
        units: tuple[str, ...] = self.definitions()[name].units
        size = self.size_setting(name)
        if size is None:
            return units
        return (units[0], properties_of(self.definitions()[size]).unit)

    def preset(self, name: str) -> Preset | None:
        """Preset of a path over time; None where the path is a table."""
        value = getattr(self, name)
        if not isinstance(value, str):
            return None
        preset: Preset = self.definitions()[name].presets[value]
        return preset

    @property
    def is_repeatable(self) -> bool:
        """Check whether any load path is a preset that is periodic."""
        for name in self.paths:
            preset = self.preset(name)
            if preset is not None and preset.repeats is not None:
                return True
        return False

    def times(self) -> Array:
        """Instants, (n_instants,), s: points of all paths, and others between them."""
        return self._times

    @property
    def n_instants(self) -> int:
        """Number of instants: at least the setting `instants`."""
        return len(self._times)

    @cached_property
    def _times(self) -> Array:
        """Instants, (n_instants,), s; for large problems from thinned tables."""
        instants = self._instants({name: getattr(self, name) for name in self._tables})
        # Tables are thinned only where every point of them would cost minutes.
        if self.n_nodes * len(instants) > EVERY_POINT and self._tables:
            instants = self._instants(
                {name: self._thinned(name) for name in self._tables}
            )
        instants.flags.writeable = False
        return instants

    @cached_property
    def _tables(self) -> tuple[str, ...]:
        """Names of the paths over time that are tables."""
        return tuple(name for name in self.paths if self.preset(name) is None)

    def _thinned(self, name: str) -> Rows:
        """Points of a table that keep its path within a share of its range."""
        table: Rows = getattr(self, name)
        kept = thinned(table, THINNED * float(np.ptp(np.array(table)[:, 1])))
        return tuple(table[index] for index in kept)

    def _instants(self, tables: Mapping[str, Rows]) -> Array:
        """Instants, (n_instants,), s, for some tables and all presets.

        Of a path, all points are instants; where one instant is set, the points at
        which the path turns.
        """
        points = [NO_KNOTS]
        corners = [NO_KNOTS]
        for name, table in tables.items():
            times = np.array(table)[:, 0]
            if self.instants == 1:
                times = self._turning(name, times)
            points.append(times)
        for name in self.paths:
            # A path of size zero has no corners that matter.
            if name in tables or not self.size_of(name):
                continue
            times = self.knots(name)
            if self.instants == 1:
                times = self._turning(name, times)
            corners.append(times)
        return instants_of(
            self.duration,
            self.instants,
            np.concatenate(points),
            np.concatenate(corners),
        )

    def knots(self, name: str) -> Array:
        """Times at which a path has kinks, (n_knots,), s; of a table its points."""
        preset = self.preset(name)
        if preset is None:
            return np.array(getattr(self, name))[:, 0]
        return self.duration * preset.corners(self.seed, self.cycles)

    def _turning(self, name: str, knots: Array) -> Array:
        """Knots inside the interval at which a path reverses, (n_turns,), s."""
        inside = knots[(knots > 0.0) & (knots < self.duration)]
        every = np.concatenate([[0.0], inside, [self.duration]])
        return turning_knots(every, self.path_at(name, every))

    def left_out(self) -> Iterator[str]:
        """Yield sentences on points of tables that thinning removes from a run."""
        times = self.times()
        for name in self._tables:
            abscissae, values = np.array(getattr(self, name)).T
            inside = (abscissae >= times[0]) & (abscissae <= times[-1])
            given = abscissae[inside]
            solved = interpolate(np.column_stack([times, self.path(name)]), given)
            difference = float(np.abs(values[inside] - solved).max(initial=0.0))
            span = float(np.ptp(values))
            # A point that is an instant up to rounding is not left out.
            count = len(apart(given, times, SAME * self.duration))
            if self.instants > 1 and count and difference > STRAIGHT * span:
                share = f"{100.0 * difference / span:.2g} %"
                yield (
                    f"{name}: {count} of {len(values)} points are left out; they "
                    f"differ from the path that is solved by at most {share} of their "
                    "range"
                )

    def path(self, name: str) -> Array:
        """Values of a path at the instants of the run, (n_instants,), in its unit.

        A preset is scaled by the setting of its size; a table has its own size.
        """
        return self.path_at(name, self.times())

    def path_at(self, name: str, instants: Array) -> Array:
        """Values of a path at given instants, s; both of shape (n_instants,)."""
        preset = self.preset(name)
        if preset is None:
            return interpolate(getattr(self, name), instants)
        # Presets are functions of the phase, so that a longer run has the same path.
        values = preset.value(instants / self.duration, self.seed, self.cycles)
        return self.size_of(name) * values

    def drives(self) -> tuple[Drive, ...]:
        """Non-zero loads and motions over time, by the settings of their sizes."""
        drives = []
        for path in self.paths:
            values = self.path(path)
            if np.any(values):
                unit = self.curve_units(path)[1]
                drives.append(Drive(self.size_or_table(path), unit, values))
        return tuple(drives)

    def points(self, name: str) -> Rows:
        """Rows of a curve: of its table, or of a table equivalent to its preset."""
        value: str | Rows = getattr(self, name)
        if not isinstance(value, str):
            return value
        preset = self.definitions()[name].presets[value]
        if not isinstance(preset, Preset):
            rows: Rows = preset.rows(self)
            return rows
        # Curved parts need points between the knots; straight ones lose them again
        # below.
        even = np.linspace(0.0, self.duration, (POINTS - 1) * self.cycles + 1)
        times = instants_of(self.duration, 2, NO_KNOTS, self.knots(name))
        times = instants_of(self.duration, 2, times, even)
        values = self.path_at(name, times)
        kept = thinned(
            np.column_stack([times, values]), STRAIGHT * float(np.ptp(values))
        )
        return as_points(times[kept], values[kept])


def as_points(abscissae: Array, values: Array) -> Rows:
    """Points (abscissa, value) with six digits, from arrays of shape (n_points,)."""
    points = []
    for abscissa, value in zip(abscissae, values, strict=True):
        points.append((float(f"{abscissa:.6g}"), float(f"{value:.6g}")))
    return tuple(points)
