"""Random runs of any scene: wide in mesh, cuts, loads, profiles and method, yet not senseless.

Every setting is drawn by its own definition, over the range that its slider shows, so that a new
one is drawn as well. What has to fit together is drawn together: mesh and cuts, elements and
their aspect, and loads, which are measured by what friction can carry.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import param
from numpy.random import Generator

from solver.arrays import Array
from solver.definitions import CurveParameter, Parameter, SettingError, about, is_logarithmic
from solver.scenes import CATALOGUE
from solver.settings import Settings
from solver.study.stability.random_loads import LOADS
from solver.study.stability.stability_case import NOT_WRONG, StabilityCase

LARGEST_FIELD = 12_000
"""Displacements times instants of a run, at most: a thousand iterations then stay within seconds;
a matter of counts, not of clocks, so that a row is the same on every machine."""
MOST_INSTANTS = 101
ROD = {"elements": (10, 800)}
BODY = {"elements": (4, 96), "elements_up": (1, 32)}
MESHES = {
    "strand": {"elements": (10, 400), "wires": (2, 12)},
    "rope": {"elements": (6, 40), "layers": (1, 2)},
    "layers": {"elements": (4, 96), "elements_up": (1, 4), "layers": (2, 6)},
    "wall": {"elements": (2, 8), "elements_up": (2, 4), "bricks": (1, 8), "courses": (1, 8)},
}
"""Numbers of a mesh, all sizes alike; a scene without an entry has those of a rod or a body."""
CUTS = {"substructures": ("elements", 50), "substructures_up": ("elements_up", 6)}
"""Numbers of parts, at most that of these elements, and this many."""
WIDE = {"poisson": (0.0, 0.4999), "friction": (0.02, 2.0), "relaxation": (0.4, 1.0)}
"""Ranges other than those of the sliders."""
LAW = {"tangential_stiffness", "normal_stiffness", "cohesion", "friction_cap", "strength"}
"""Settings of the general friction law."""
PRESSES = ("pressure", "normal_stress")
"""Settings by which the size of cohesion and cap is drawn, where a scene has one."""
KEPT = {"max_iterations", "method"}
"""Settings that are not drawn by their definition alone."""
AS_THEY_ARE = {"wall": {"pressure_load"}}
"""Those of a scene that stay at their defaults: bricks that are lifted hang on nothing."""
INSTANTS_A_CYCLE = 4
"""At least, of what is drawn: more cycles take more instants than there is room for."""
COUNTED = "layers", "wires", "construction"
"""Settings that say how many interfaces there are."""
NARROW = (1e-5, 1e-2)
"""Widths of narrow peaks, as shares of the interval or the length: most lie between instants."""
FOOLISH = -3.0, 3.0
"""Decades of a factor on k that nobody would choose."""
CHANGED = 0.15
"""How often a setting differs from its default."""
TRIALS = 1000


def random_cases(scenes: Sequence[str], number: int, seed: int) -> Iterator[StabilityCase]:
    """Random runs of scenes in turn; row n is of scene n modulo their number.

    Parameters
    ----------
    scenes
        Names of the catalogue; all without.
    number, seed
        Of the runs, and of their draws.
    """
    names = list(scenes or CATALOGUE)
    for row in range(number):
        yield random_case(draw(names[row % len(names)], seed, row), seed, row)


def random_case(settings: Settings, seed: int, row: int) -> StabilityCase:
    """Case of settings that were drawn; right are errors of its force within its accuracy."""
    own = set(settings.changed()) & {*settings.METHODS["fast"], "k_update"}
    method = f"{settings.method}{', mixed' if own - {'tolerance'} else ''}"
    return StabilityCase(
        f"row {row} of seed {seed}",
        settings.scene,
        settings.changed(),
        NOT_WRONG,
        "pgd" if settings.linear_stage == "pgd" else method,
        error_force=settings.accuracy,
        error_displacement=math.inf,
    )


def draw(scene: str, seed: int, row: int) -> Settings:
    """Settings of one random run; the same numbers give the same settings.

    Parameters
    ----------
    scene
        A name of the catalogue.
    seed, row
        Of all runs, and the number of this one.

    Raises
    ------
    SettingError
        If the settings refused every draw.
    """
    generator = np.random.default_rng([seed, row, *scene.encode()])
    kind = CATALOGUE[scene]
    for _ in range(TRIALS):
        try:
            settings = kind.checked(_values(kind, generator))
            # Without what does nothing beside the others, so that a row says what matters.
            changed = settings.changed().items()
            values = {name: value for name, value in changed if settings.applies(name)}
            return kind.checked({"method": settings.method, **values})
        except SettingError as refusal:
            last = refusal
    raise last


def log_uniform(generator: Generator, low: float, high: float) -> float:
    """A random positive number, all its decades alike."""
    return float(np.exp(generator.uniform(math.log(low), math.log(high))))


def _values(kind: Any, generator: Generator) -> dict[str, Any]:
    definitions = kind.definitions()
    defaults = {name: definition.default for name, definition in definitions.items()}
    values = _mesh(kind.scene, definitions, generator)
    values["method"] = "paper" if generator.random() < 0.35 else "fast"
    mixed = generator.random() < 0.5
    for name, definition in definitions.items():
        if name in values or name in KEPT | AS_THEY_ARE.get(kind.scene, set()):
            continue
        if generator.random() < _often(name, about(definition).group, mixed):
            values[name] = _drawn(name, definition, generator)
    if "friction_factors" in values:
        some = {name: values[name] for name in COUNTED if name in values}
        each = kind.checked(some).points("friction_factors")
        values["friction_factors"] = [[n, log_uniform(generator, 0.1, 10.0)] for n, _ in each]
    if "layer_lengths" in values and generator.random() < 0.5:
        shares = [1.0, *generator.uniform(0.1, 1.0, values["layers"] - 1).tolist()]
        values["layer_lengths"] = [[n, s] for n, s in enumerate(generator.permutation(shares), 1)]
    if "elements_up" in definitions:  # elements up to a hundred times as long as high, or as wide
        length = values.setdefault("length", defaults["length"])
        power = 2.0 if generator.random() < 2.0 * CHANGED else 0.7
        aspect = 10.0 ** generator.uniform(-power, power)
        values[kind.across] = length * values["elements_up"] / (values["elements"] * aspect)
    if "cycles" in values:
        most = max((values["instants"] - 1) // INSTANTS_A_CYCLE, 1)
        values["cycles"] = min(values["cycles"], most)
    loads = LOADS.get(kind.scene)
    sizes = loads({**defaults, **values}, generator) if loads is not None else {}
    every = {**defaults, **values, **sizes}
    pressing = [every[name] for name in PRESSES if name in definitions]
    for name in ("cohesion", "friction_cap"):
        if name in values and pressing:
            most = every["friction"] * pressing[0]
            values[name] = most * log_uniform(generator, 0.01, 10.0)
    for name, size in sizes.items():
        if not isinstance(definitions[name], CurveParameter):
            values[name] = size
        elif generator.random() < CHANGED:
            values[name] = _path(size, every["duration"], generator)
    return values


def _often(name: str, group: str, mixed: bool) -> float:
    """How often a setting is drawn; those of the method seldom but in mixed ones."""
    if name in ("linear_stage", "accuracy", "tolerance"):
        return CHANGED
    if name.startswith("k_") and name.endswith("_scale"):
        return 2.0 * CHANGED if name == "k_scale" else 0.5 * CHANGED
    if name.startswith("pgd_") or name == "seed":
        return 0.5  # taken back without separated bases, or a random path
    if name in LAW:
        return 0.5  # taken back where the law is not the general one
    if group == "Method":
        return 2.0 * CHANGED if mixed else 0.0
    return (
        2.0 * CHANGED if name in ("load", "gap") or name.endswith(("_profile", "_end")) else CHANGED
    )


def _mesh(scene: str, definitions: dict[str, Parameter], generator: Generator) -> dict[str, Any]:
    """The mesh, its cuts, and as many instants as there is room for."""
    mesh: dict[str, Any] = {}
    while True:
        sizes = MESHES.get(scene, BODY if "elements_up" in definitions else ROD)
        for name, (low, high) in sizes.items():
            mesh[name] = min(int(log_uniform(generator, low, high + 1)), high)
        unknowns = math.prod(mesh.values()) * (2 if "elements_up" in mesh else 1)
        if unknowns <= LARGEST_FIELD // 3:
            break
    most = min(MOST_INSTANTS, LARGEST_FIELD // unknowns)
    fewest = max(1, most // 3) if generator.random() < 0.7 else 1
    mesh["instants"] = int(log_uniform(generator, fewest, most + 1))
    for name, (elements, largest) in CUTS.items():
        if name in definitions:
            most_cuts = min(mesh[elements], largest)
            mesh[name] = min(int(log_uniform(generator, 1, most_cuts + 1)), most_cuts)
    return mesh


def _drawn(name: str, definition: Any, generator: Generator) -> object:
    """A value drawn by the definition alone."""
    if isinstance(definition, CurveParameter):
        make = TABLES.get(definition.abscissa) if definition.is_path else _construction
        if make and generator.random() < 0.4:
            return make(name, generator)
        return str(generator.choice(list(definition.presets)))
    if isinstance(definition, param.Boolean):
        return bool(generator.random() < 0.5)
    if isinstance(definition, param.Selector):
        return str(generator.choice(definition.objects))
    if name in SPECIAL:
        return float(SPECIAL[name](generator))
    low, high = WIDE.get(name, definition.softbounds)
    if isinstance(definition, param.Integer):
        return int(generator.integers(low, high + 1))
    if is_logarithmic(definition):
        return log_uniform(generator, low, high)
    return float(generator.uniform(low, high))


SPECIAL: dict[str, Callable[[Generator], float]] = {
    "k_scale": lambda draw: (
        10.0 ** draw.uniform(*(FOOLISH if draw.random() < 0.4 else (-1.0, 1.0)))
    ),
    "poisson": lambda draw: (
        draw.uniform(0.0, 0.4999) if draw.random() < 0.5 else 0.5 - log_uniform(draw, 1e-4, 1e-1)
    ),
    "accuracy": lambda draw: log_uniform(draw, 1e-5, 0.1),
    "tolerance": lambda draw: log_uniform(draw, 1e-12, 1.0),
}


def _construction(_name: str, generator: Generator) -> list[list[float]]:
    """A core, and a layer or two of wires around it with room to spare."""
    rows = [[1, float(generator.uniform(2e-3, 8e-3)), 0.0, 2e11]]
    around = rows[0][1]
    for _ in range(int(generator.integers(1, 3))):
        diameter, lay = generator.uniform(0.3, 1.0) * rows[-1][1], generator.uniform(5.0, 30.0)
        room = np.pi * (around + diameter) * np.cos(np.radians(lay))
        most = max(int(0.95 * room / diameter), 1)
        wires, sign = int(generator.integers(1, most + 1)), generator.choice([-1.0, 1.0])
        rows.append([wires, float(diameter), float(sign * lay), log_uniform(generator, 1e9, 1e12)])
        around += 2.0 * diameter
    return rows


def _profile(name: str, generator: Generator) -> list[list[float]]:
    """Factors along a body, now and then zero but for a section, or with a narrow peak."""
    places = np.sort(generator.uniform(0.0, 1.0, int(generator.integers(2, 7))))
    factors = 10.0 ** generator.uniform(-1.0, 1.0, len(places))
    if name != "section_profile":
        factors[generator.random(len(places)) < 0.2] = 0.0
    peak = float(10.0 ** generator.uniform(-1.0, 1.0))
    return _with_peak(places, factors, peak, 1.0, generator)


def _strength(_name: str, generator: Generator) -> list[list[float]]:
    """Factors over slip, from 1 on, up and down."""
    slips = np.cumsum(10.0 ** generator.uniform(-6.0, -3.0, int(generator.integers(1, 5))))
    factors = generator.uniform(0.0, 2.0, len(slips))
    return [[0.0, 1.0], *([float(s), float(g)] for s, g in zip(slips, factors, strict=True))]


TABLES = {"slip": _strength, "position": _profile}
"""Of curves over what."""


def _path(size: float, duration: float, generator: Generator) -> list[list[float]]:
    """A path over time through a few points: reversals, jumps, narrow peaks among them."""
    times = np.sort(generator.uniform(0.0, duration, int(generator.integers(1, 8))))
    values = abs(size) * generator.uniform(-1.0, 1.0, len(times))
    return _with_peak(times, values, size, duration, generator)


def _with_peak(
    where: Array, values: Array, peak: float, extent: float, generator: Generator
) -> list[list[float]]:
    """Put a narrow peak onto a table, every third time."""
    if generator.random() < 1.0 / 3.0:
        half = 0.5 * extent * log_uniform(generator, *NARROW)
        middle = float(generator.uniform(half, extent - half))
        feet = middle + half * np.array([-1.0, 1.0])
        outside = (where < feet[0]) | (where > feet[1])
        left, right = np.interp(feet, where, values)
        where = np.concatenate([where[outside], [feet[0], middle, feet[1]]])
        values = np.concatenate([values[outside], [left, peak, right]])
        order = np.argsort(where)
        where, values = where[order], values[order]
    return [[float(place), float(value)] for place, value in zip(where, values, strict=True)]
