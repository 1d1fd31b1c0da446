"""Random runs of all scenes, with random mesh, cuts, loads, profiles and method.

Every setting is drawn by its own definition, over the range of its slider, so that a
new setting is drawn as well. Settings that have to fit together are drawn together:
elements and their aspect here, and loads and the friction law in
`solver.study.random_loads`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import param
from numpy.random import Generator

from solver.arrays import Array
from solver.scenes import CATALOGUE
from solver.settings.definitions import (
    CurveParameter,
    is_logarithmic,
    names_of,
    properties_of,
)
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.random_loads import OFTEN_LOADS, SELDOM, log_uniform, random_loads
from solver.study.stability import NOT_WRONG, StabilityCase

LARGEST_FIELD = 6_000
"""Largest number of nodes times instants of a run: a thousand iterations then take
seconds. A limit on counts, not on time, gives the same rows on every machine."""
MOST_INSTANTS = 101
SIZES = (
    "elements",
    "elements_up",
    "wires",
    "layers",
    "bricks",
    "courses",
    "voussoirs",
    "rings",
)
"""Numbers of a mesh; all decades are equally likely."""
FEWEST = {"rings": 1}
"""Smallest of these numbers, where it is not 2."""
WIDE = {
    "poisson": (0.0, 0.4999),
    "friction": (0.02, 2.0),
    "relaxation": (0.4, 1.0),
    "k_scale": (1e-3, 1e3),
}
"""Ranges other than those of the sliders."""
KEPT = {"max_iterations", "method", "opening", "opening_height", "scale"}
"""Settings that are not drawn by their definition alone."""
NARROW = (1e-5, 1e-2)
"""Widths of narrow peaks, as shares of the interval or the length: most lie between
instants."""
CHANGED = 0.15
"""Share of the runs in which a setting differs from its default."""
IDLE = 0.5
"""The same share of settings that do nothing by default, and need another to be drawn.
"""
OFTEN = {
    "friction_law": 0.6,
    "strength": 0.8,
    "left": 0.6,
    "right": 0.6,
    "top": 0.6,
    "left_end": 0.6,
    "right_end": 0.6,
    "grip": 0.6,
    "bending": 0.6,
    "linear_stage": 0.3,
    "cycles": 0.3,
    **OFTEN_LOADS,
}
"""The same share of settings that change the kind of problem, or the method: all kinds
of ends, sides, laws and loads are to come together."""
OF_HEAPS = 0.3, 2.0
"""Coefficients of friction in heaps of round wires."""
WITH_OPENING = 0.4
"""Share of the walls with room for an opening that have one."""
TRIALS = 10_000
"""Largest number of draws until settings fit together."""


def random_cases(
    scenes: Sequence[str], number: int, seed: int
) -> Iterator[StabilityCase]:
    """Random runs of some or all scenes: row n is of scene n modulo their number."""
    names = list(scenes or CATALOGUE)
    for row in range(number):
        yield random_case(draw(names[row % len(names)], seed, row), seed, row)


def random_case(settings: Settings, seed: int, row: int) -> StabilityCase:
    """Case of random settings: passes if the answer is right within their accuracy."""
    return StabilityCase(
        title=f"row {row} of seed {seed}",
        scene=settings.scene,
        values=settings.changed(),
        expected=NOT_WRONG,
        method=settings.method,
        error_force=settings.accuracy,
        error_displacement=math.inf,
    )


def draw(scene: str, seed: int, row: int) -> Settings:
    """Random settings of a run, determined by seed and row.

    Raises
    ------
    SettingError
        If no settings within the limit of size are found.
    """
    generator = np.random.default_rng([seed, row, *scene.encode()])
    kind = CATALOGUE[scene]
    last = SettingError(
        scene, row, f"up to {LARGEST_FIELD} nodes times instants", "draw smaller"
    )
    for _ in range(TRIALS):
        try:
            mesh = _mesh(kind, generator)
            # Most meshes are too large, and what else is drawn makes none smaller.
            if kind(**mesh).n_nodes * mesh["instants"] > LARGEST_FIELD:
                continue
            settings = kind.checked(_values(kind, mesh, generator))
            # Paths may have turns, and so instants, of their own.
            if settings.n_nodes * settings.n_instants > LARGEST_FIELD:
                continue
            # Settings that do nothing beside the others are left out of the row.
            values: dict[str, Any] = {"method": settings.method}
            for name, value in settings.changed().items():
                if settings.applies(name):
                    values[name] = value
            return kind.checked(values)
        except SettingError as refusal:
            last = refusal
    raise last


def _values(kind: Any, mesh: dict[str, Any], generator: Generator) -> dict[str, Any]:
    """Values of the settings of a random run on a mesh, by name, in SI."""
    values = dict(mesh)
    values["method"] = "paper" if generator.random() < 0.35 else "fast"
    _draw_alone(kind, values, generator)
    _fit_together(kind, values, generator)
    values |= random_loads(kind, values, generator)
    # Blocks that move before anything presses have no determinate positions.
    if not kind.has_joints:
        values |= _paths(kind, values, generator)
    return values


def _mesh(kind: Any, generator: Generator) -> dict[str, Any]:
    """Random numbers of instants, elements and substructures, by name."""
    definitions = kind.definitions()
    # Most runs have many instants; some have few, down to a single one.
    fewest = MOST_INSTANTS // 3
    if generator.random() < 0.3:
        fewest = 1
    values: dict[str, Any] = {"instants": _count(generator, fewest, MOST_INSTANTS)}
    for name in SIZES:
        if name in definitions:
            smallest = FEWEST.get(name, 2)
            largest = definitions[name].softbounds[1]
            values[name] = _count(generator, smallest, largest)
    for part, whole in kind.PARTS.items():
        if part != "broken":
            largest = min(values[whole], definitions[part].softbounds[1])
            values[part] = _count(generator, 1, largest)
    return values


def _count(generator: Generator, low: int, high: int) -> int:
    """Random integer, log-uniformly distributed."""
    return min(int(log_uniform(generator, low, high + 1)), high)


def _draw_alone(kind: Any, values: dict[str, Any], generator: Generator) -> None:
    """Add random values of the settings that depend only on their definition."""
    is_mixed = generator.random() < 0.5
    default = kind()
    for name, definition in kind.definitions().items():
        # Half of the runs have a method as it is, the others a mixture of its parts.
        is_method = (
            properties_of(definition).group == "Method" and name != "linear_stage"
        )
        if name in values or name in KEPT or (is_method and not is_mixed):
            continue
        usual = CHANGED
        if not default.applies(name):
            usual = IDLE
        if generator.random() < OFTEN.get(name, usual):
            values[name] = _drawn(name, definition, generator)


def _fit_together(kind: Any, values: dict[str, Any], generator: Generator) -> None:
    """Change random values to fit the mesh."""
    if "friction_factors" in values:
        values["friction_factors"] = _friction_factors(kind, values, generator)
    if "layer_lengths" in values and generator.random() < 0.5:
        shares = [1.0, *generator.uniform(0.1, 1.0, values["layers"] - 1).tolist()]
        lengths = enumerate(generator.permutation(shares), start=1)
        values["layer_lengths"] = [list(row) for row in lengths]
    if "elements_up" in values:
        _fit_aspect(kind, values, generator)
    if "opening" in kind.definitions() and generator.random() < WITH_OPENING:
        room = values["bricks"] - 2, values["courses"] - 1
        if min(room) > 0:
            sizes = generator.integers(1, np.add(room, 1)).tolist()
            values["opening"], values["opening_height"] = sizes
    if values.get("arrangement") == "heap":
        # On less friction heaps of several rows roll apart at once.
        values["friction"] = float(generator.uniform(*OF_HEAPS))
    if "cycles" in values:
        # Every cycle takes instants of its own.
        values["cycles"] = min(values["cycles"], max((values["instants"] - 1) // 4, 1))


def _friction_factors(
    kind: Any, values: dict[str, Any], generator: Generator
) -> list[list[float]]:
    """Random factor on mu for every interface of layers or wires, by its number."""
    names = ("layers", "wires", "construction", "mesh")
    numbers = {name: values[name] for name in names if name in values}
    rows = []
    for number, _ in kind.checked(numbers).points("friction_factors"):
        rows.append([number, log_uniform(generator, 0.1, 10.0)])
    return rows


def _fit_aspect(kind: Any, values: dict[str, Any], generator: Generator) -> None:
    """Choose the height such that the aspect ratio of elements is at most 100."""
    length = values.setdefault("length", kind.definitions()["length"].default)
    power = 0.7
    if generator.random() < 2.0 * CHANGED:
        power = 2.0
    aspect = 10.0 ** generator.uniform(-power, power)
    across = length * values["elements_up"] / (values["elements"] * aspect)
    values[kind.across] = across


def _paths(kind: Any, values: dict[str, Any], generator: Generator) -> dict[str, Any]:
    """Random tables of some load paths, by name."""
    settings = kind.checked(values)
    tables = {}
    for path in settings.paths:
        if generator.random() < CHANGED:
            size = settings.size_of(path)
            lowest = kind.definitions()[path].bounds[1][0]
            smallest = -1.0 if lowest < 0.0 else 0.0
            count = int(generator.integers(1, 8))
            turns = size * generator.uniform(smallest, 1.0, count)
            tables[path] = _table(turns, size, settings.duration, generator)
    return tables


def _drawn(name: str, definition: Any, generator: Generator) -> object:
    """Random value of a setting, from its definition only."""
    if isinstance(definition, CurveParameter):
        make = TABLES.get(definition.abscissa)
        if make and generator.random() < 0.4:
            return make(name, generator)
    if isinstance(definition, param.Boolean):
        return bool(generator.random() < 0.5)
    names = names_of(definition)
    if names:
        return str(generator.choice(names))
    low, high = WIDE.get(name, definition.softbounds)
    if isinstance(definition, param.Integer):
        return int(generator.integers(low, high + 1))
    if is_logarithmic(definition):
        return log_uniform(generator, low, high)
    return float(generator.uniform(low, high))


def _construction(_name: str, generator: Generator) -> list[list[float]]:
    """Random construction of a rope: a core, and one or two layers around it."""
    rows = [[1, float(generator.uniform(2e-3, 8e-3)), 0.0, 2e11]]
    around = rows[0][1]
    for _ in range(int(generator.integers(1, 3))):
        diameter = generator.uniform(0.3, 1.0) * rows[-1][1]
        lay = generator.uniform(5.0, 30.0)
        room = np.pi * (around + diameter) * np.cos(np.radians(lay))
        fitting = max(int(0.95 * room / diameter), 1)
        wires = int(generator.integers(1, fitting + 1))
        angle = float(generator.choice([-1.0, 1.0]) * lay)
        modulus = log_uniform(generator, 1e9, 1e12)
        rows.append([wires, float(diameter), angle, modulus])
        around += 2.0 * diameter
    return rows


def _profile(name: str, generator: Generator) -> list[list[float]]:
    """Random factors along a body; zeros are allowed, except for a section."""
    factors = 10.0 ** generator.uniform(-1.0, 1.0, int(generator.integers(2, 7)))
    if name != "section_profile":
        factors[generator.random(len(factors)) < SELDOM] = 0.0
    return _table(factors, float(10.0 ** generator.uniform(-1.0, 1.0)), 1.0, generator)


def _strength(_name: str, generator: Generator) -> list[list[float]]:
    """Random factors on friction over slip, from 1 on."""
    count = int(generator.integers(1, 5))
    slips = np.cumsum(10.0 ** generator.uniform(-6.0, -3.0, count))
    factors = generator.uniform(0.0, 2.0, len(slips))
    return [[0.0, 1.0], *np.column_stack([slips, factors]).tolist()]


TABLES = {"slip": _strength, "position": _profile, "wires": _construction}
"""Functions that draw a table, by its abscissa."""


def _table(
    values: Array, peak: float, extent: float, generator: Generator
) -> list[list[float]]:
    """Table of values, (n_values,), at random positions from 0 to an extent.

    Every third table has a narrow peak, too: it shows whether instants, or points, miss
    what happens between them.
    """
    where = np.sort(generator.uniform(0.0, extent, len(values)))
    if generator.random() < 1.0 / 3.0:
        half = 0.5 * extent * log_uniform(generator, *NARROW)
        middle = float(generator.uniform(half, extent - half))
        feet = middle + half * np.array([-1.0, 1.0])
        outside = (where < feet[0]) | (where > feet[1])
        left, right = np.interp(feet, where, values)
        where = np.concatenate([where[outside], [feet[0], middle, feet[1]]])
        values = np.concatenate([values[outside], [left, peak, right]])
        order = np.argsort(where)
        where = where[order]
        values = values[order]
    rows: list[list[float]] = np.column_stack([where, values]).tolist()
    return rows
