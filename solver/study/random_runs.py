"""Random runs of any scene: wide in mesh, cuts, loads, profiles and method, yet not senseless.

Every setting is drawn by its own definition, over the range that its slider shows, so
that a new one is drawn as well. What has to fit together is drawn together: elements
and their aspect, and loads, which are measured by what friction can carry, and lengths
and stiffnesses of the law of friction, which are measured by how far bodies move and
how stiff they are.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import param
from numpy.random import Generator

from solver.arrays import Array
from solver.scenes import CATALOGUE
from solver.settings.definitions import (
    CurveParameter,
    SettingError,
    about,
    is_logarithmic,
)
from solver.settings.scene import Settings
from solver.study.stability import NOT_WRONG, StabilityCase

LARGEST_FIELD = 6_000
"""Nodes times instants of a run, at most: a thousand iterations then stay within
seconds; a matter of counts, not of clocks, so that a row is the same on every
machine."""
MOST_INSTANTS = 101
SIZES = "elements", "elements_up", "wires", "layers", "bricks", "courses"
"""Numbers of a mesh, all sizes alike."""
WIDE = {
    **{"poisson": (0.0, 0.4999), "friction": (0.02, 2.0)},
    **{"relaxation": (0.4, 1.0), "k_scale": (1e-3, 1e3)},
}
"""Ranges other than those of the sliders."""
KEPT = {"max_iterations", "method", "opening", "opening_height"}
"""Settings that are not drawn by their definition alone."""
NARROW = (1e-5, 1e-2)
"""Widths of narrow peaks, as shares of the interval or the length: most lie between
instants."""
CHANGED = 0.15
"""How often a setting differs from its default."""
SELDOM = 0.2
"""How often there is a load that a scene has not by itself."""
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
    "temperature": 0.4,
    "settlement": 0.4,
}
"""How often a setting is drawn that makes another problem, or has another method, of a
scene: all kinds of ends, sides, laws and loads are to come together. Of a load, how
often there is one."""
WITH_OPENING = 0.4
"""How often a wall that has room for an opening has one."""
SMALLEST = 0.03
LARGEST = 10.0
OF_BRICKS = 0.5
"""Loads over what friction carries; of bricks, which hang on nothing, the largest."""
PRESSING = "pressure", "normal_stress", "tension"
"""Loads that are as large as what presses."""
WITHOUT_PATH = (
    "normal_stress",
    "shear_stress",
    "unit_weight",
    "body_force_x",
    "body_force_y",
)
"""Loads that do not go on over time."""
SLIPS = 0.01, 10.0
"""Slip at which friction is the last, over how far bodies move."""
SPRINGS = 1.0, 1e4
"""Stiffness of contacts over that of bodies."""
TRIALS = 10_000


def random_cases(
    scenes: Sequence[str], number: int, seed: int
) -> Iterator[StabilityCase]:
    """Random runs of scenes, or of all, in turn; row n is of scene n modulo their number."""
    names = list(scenes or CATALOGUE)
    for row in range(number):
        yield random_case(draw(names[row % len(names)], seed, row), seed, row)


def random_case(settings: Settings, seed: int, row: int) -> StabilityCase:
    """Case of settings that were drawn; right are errors of its force within its accuracy."""
    return StabilityCase(
        f"row {row} of seed {seed}",
        settings.scene,
        settings.changed(),
        NOT_WRONG,
        settings.method,
        error_force=settings.accuracy,
        error_displacement=math.inf,
    )


def draw(scene: str, seed: int, row: int) -> Settings:
    """Settings of one random run; the same numbers give the same settings."""
    generator = np.random.default_rng([seed, row, *scene.encode()])
    kind = CATALOGUE[scene]
    last = SettingError(
        scene, row, f"up to {LARGEST_FIELD} nodes times instants", "draw smaller"
    )
    for _ in range(TRIALS):
        try:
            settings = kind.checked(_values(kind, generator))
            if settings.n_nodes * settings.n_instants > LARGEST_FIELD:
                continue
            # Without what does nothing beside the others, so that a row says what
            # matters.
            changed = settings.changed().items()
            values = {name: value for name, value in changed if settings.applies(name)}
            return kind.checked({"method": settings.method, **values})
        except SettingError as refusal:
            last = refusal
    raise last


def log_uniform(generator: Generator, low: float, high: float) -> float:
    """A random positive number, all its decades alike."""
    return float(np.exp(generator.uniform(math.log(low), math.log(high))))


def _count(generator: Generator, low: int, high: int) -> int:
    return min(int(log_uniform(generator, low, high + 1)), high)


def _values(kind: Any, generator: Generator) -> dict[str, Any]:
    definitions = kind.definitions()
    if generator.random() < 0.3:
        fewest = 1
    else:
        fewest = MOST_INSTANTS // 3
    values: dict[str, Any] = {"instants": _count(generator, fewest, MOST_INSTANTS)}
    for name in SIZES:
        if name in definitions:
            values[name] = _count(generator, 2, definitions[name].softbounds[1])
    for part, whole in kind.PARTS.items():
        if part != "broken":
            most = min(values[whole], definitions[part].softbounds[1])
            values[part] = _count(generator, 1, most)
    values["method"] = "paper" if generator.random() < 0.35 else "fast"
    is_mixed = generator.random() < 0.5
    rest = kind()
    for name, definition in definitions.items():
        is_method = about(definition).group == "Method" and name != "linear_stage"
        # What does nothing by itself is taken back, unless another setting is drawn to
        # go with it.
        often = OFTEN.get(name, CHANGED if rest.applies(name) else 0.5)
        if name in values or name in KEPT or (is_method and not is_mixed):
            continue
        if generator.random() < often:
            values[name] = _drawn(name, definition, generator)
    _fit_together(kind, values, generator)
    values |= _loads(kind, values, generator)
    # Where the top of a wall is moved before anything presses, where bricks lie is not
    # determinate.
    if kind.scene != "wall":
        settings = kind.checked(values)
        for path in settings.paths:
            if generator.random() < CHANGED:
                size = settings.size_of(path)
                lowest = definitions[path].bounds[1][0]
                least = -1.0 if lowest < 0.0 else 0.0
                turns = size * generator.uniform(
                    least, 1.0, int(generator.integers(1, 8))
                )
                values[path] = _table(turns, size, settings.duration, generator)
    return values


def _fit_together(kind: Any, values: dict[str, Any], generator: Generator) -> None:
    """Change what was drawn to what fits the mesh."""
    definitions = kind.definitions()
    if "friction_factors" in values:
        some = {
            n: values[n] for n in ("layers", "wires", "construction") if n in values
        }
        each = kind.checked(some).points("friction_factors")
        values["friction_factors"] = [
            [n, log_uniform(generator, 0.1, 10.0)] for n, _ in each
        ]
    if "layer_lengths" in values and generator.random() < 0.5:
        shares = [1.0, *generator.uniform(0.1, 1.0, values["layers"] - 1).tolist()]
        values["layer_lengths"] = [
            [n, s] for n, s in enumerate(generator.permutation(shares), 1)
        ]
    if (
        "elements_up" in values
    ):  # elements up to a hundred times as long as high, or as wide
        length = values.setdefault("length", definitions["length"].default)
        power = 2.0 if generator.random() < 2.0 * CHANGED else 0.7
        aspect = 10.0 ** generator.uniform(-power, power)
        values[kind.across] = (
            length * values["elements_up"] / (values["elements"] * aspect)
        )
    if "opening" in definitions and generator.random() < WITH_OPENING:
        room = values["bricks"] - 2, values["courses"] - 1
        if min(room) > 0:
            sizes = generator.integers(1, np.add(room, 1)).tolist()
            values["opening"], values["opening_height"] = sizes
    if "cycles" in values:
        # Every cycle takes instants of its own.
        values["cycles"] = min(values["cycles"], max((values["instants"] - 1) // 4, 1))


def _loads(
    kind: Any, values: Mapping[str, Any], generator: Generator
) -> dict[str, Any]:
    """Sizes of all that acts on a scene, by the unit of each and what friction carries."""
    definitions = kind.definitions()
    rest = kind()
    given = {**{name: each.default for name, each in definitions.items()}, **values}
    scales = _scales(kind, given, generator)
    largest = LARGEST
    mu = given["friction"]
    if "bricks" in given:
        tips = (
            0.5
            * given["length"]
            * given["bricks"]
            / (given["height"] * given["courses"])
        )
        largest = OF_BRICKS
        mu = min(mu, tips)
    sizes: dict[str, Any] = {}
    for name, definition in definitions.items():
        record = about(definition)
        is_load = (record.path or name in WITHOUT_PATH) and record.unit in scales
        is_seldom = not definition.default and rest.applies(name)
        if not is_load or (is_seldom and generator.random() > OFTEN.get(name, SELDOM)):
            continue
        share = log_uniform(generator, SMALLEST, largest)
        factor = mu * (share if generator.random() < 0.7 else -share)
        if name in PRESSING:
            factor = 1.0
        elif name in ("overpressure", "unit_weight"):
            factor = float(
                generator.uniform(0.0, 1.0 if name == "overpressure" else 0.1)
            )
        elif "_normal_" in name or name == "body_force_y":
            factor = -1.0 if generator.random() < 0.9 else 1.0
        sizes[name] = factor * scales[record.unit]
    for name in ("cohesion", "friction_cap"):
        pressing = sizes.get("pressure", sizes.get("normal_stress"))
        pressing = pressing or scales.get(about(definitions[name]).unit)
        if name in values and pressing:
            sizes[name] = (
                given["friction"] * pressing * log_uniform(generator, 0.01, 10.0)
            )
    sizes |= _law_of_friction(kind, given, scales["m"], values, generator)
    if "radius" in definitions:
        flat = given["length"] ** 2 / (8.0 * scales["m"])
        sizes["radius"] = flat * 10.0 ** generator.uniform(-1.5, 1.5)
    return sizes


def _law_of_friction(
    kind: Any,
    given: Mapping[str, Any],
    moved: float,
    values: Mapping[str, Any],
    generator: Generator,
) -> dict[str, Any]:
    """Lengths and stiffnesses of what was drawn of the law of friction.

    Slips are measured by how far bodies move, m; springs by the stiffness of bodies.
    """
    sizes: dict[str, Any] = {}
    if "slip_length" in values:
        sizes["slip_length"] = moved * log_uniform(generator, *SLIPS)
    if isinstance(table := values.get("strength"), list):
        last = moved * log_uniform(generator, *SLIPS)
        sizes["strength"] = [
            [last * slip / table[-1][0], factor] for slip, factor in table
        ]
    stiffness = _stiffness(kind, given)
    for name in ("tangential_stiffness", "normal_stiffness"):
        if name in values:
            sizes[name] = stiffness * log_uniform(generator, *SPRINGS)
    return sizes


def _stiffness(kind: Any, given: Mapping[str, Any]) -> float:
    """Stiffness of a body, per length along a rod, N/m^2, or per area, N/m^3."""
    length: float = given["length"]
    if "construction" in given:
        return float(_section(kind, given).stiffness) / length**2
    if "section" in given:
        return float(given["young"] * given["section"]) / length**2
    return float(given["young"]) / length


def _section(kind: Any, given: Mapping[str, Any]) -> Any:
    """Section of a rope."""
    names = {"construction", "layers"} & given.keys()
    return kind.checked({name: given[name] for name in names}).section


def _scales(
    kind: Any, given: Mapping[str, Any], generator: Generator
) -> dict[str, float]:
    """What presses on a scene, how far that moves it, and strains it as much, by unit."""
    if "construction" in given:
        section = _section(kind, given)
        strain = 10.0 ** generator.uniform(-4.0, -2.0)
        inclined = abs(math.sin(section.layers[-1].lay))
        radius = section.radii[-1]
        tension = section.stiffness * strain
        return {
            "N": tension,
            "1/m": strain * inclined / radius,
            "N/m": tension * inclined**2 / radius,
            "m": strain * radius,
        }
    length = given["length"]
    if "section" in given:
        pressed = given["pressure"] * length
        strain = pressed / (given["young"] * given["section"])
        warm = strain / given.get("expansion", math.inf)
        return {"N": pressed, "N/m": given["pressure"], "m": strain * length, "K": warm}
    if "slack" in given:
        weight = given["weight"]
        spring = given["spring"]
        return {"Pa": weight / length, "m": weight / spring}
    height = given[kind.across] * given.get("layers", 1) * given.get("courses", 1)
    strain = 10.0 ** generator.uniform(-7.0 if "layers" in given else -6.0, -3.0)
    pressure = strain * given["young"]
    # What bends slender bodies, as far as a force at their end does.
    if "layers" in given:
        bent = 8.0 / 3.0 * (length / height) ** 3
    else:
        bent = 1.0
    return {
        **{"Pa": pressure, "m": bent * strain * height, "N/m": pressure * height / 1.5},
        **{
            "N·m/m": pressure * length * height / 3.0,
            "N/m^3": pressure / height,
            "°": 20.0,
        },
    }


def _drawn(name: str, definition: Any, generator: Generator) -> object:
    """A value drawn by the definition alone."""
    if isinstance(definition, CurveParameter):
        make = TABLES.get(definition.abscissa)
        if make and generator.random() < 0.4:
            return make(name, generator)
        return str(generator.choice(list(definition.presets)))
    if isinstance(definition, param.Boolean):
        return bool(generator.random() < 0.5)
    if isinstance(definition, param.Selector):
        return str(generator.choice(definition.objects))
    low, high = WIDE.get(name, definition.softbounds)
    if isinstance(definition, param.Integer):
        return int(generator.integers(low, high + 1))
    if is_logarithmic(definition):
        return log_uniform(generator, low, high)
    return float(generator.uniform(low, high))


def _construction(_name: str, generator: Generator) -> list[list[float]]:
    """A core, and a layer or two of wires around it with room to spare."""
    rows = [[1, float(generator.uniform(2e-3, 8e-3)), 0.0, 2e11]]
    around = rows[0][1]
    for _ in range(int(generator.integers(1, 3))):
        diameter = generator.uniform(0.3, 1.0) * rows[-1][1]
        lay = generator.uniform(5.0, 30.0)
        room = np.pi * (around + diameter) * np.cos(np.radians(lay))
        most = max(int(0.95 * room / diameter), 1)
        wires = int(generator.integers(1, most + 1))
        sign = generator.choice([-1.0, 1.0])
        rows.append(
            [
                wires,
                float(diameter),
                float(sign * lay),
                log_uniform(generator, 1e9, 1e12),
            ]
        )
        around += 2.0 * diameter
    return rows


def _profile(name: str, generator: Generator) -> list[list[float]]:
    """Factors along a body, now and then zero but for a section."""
    factors = 10.0 ** generator.uniform(-1.0, 1.0, int(generator.integers(2, 7)))
    if name != "section_profile":
        factors[generator.random(len(factors)) < SELDOM] = 0.0
    return _table(factors, float(10.0 ** generator.uniform(-1.0, 1.0)), 1.0, generator)


def _strength(_name: str, generator: Generator) -> list[list[float]]:
    """Factors over slip, from 1 on, up and down."""
    slips = np.cumsum(
        10.0 ** generator.uniform(-6.0, -3.0, int(generator.integers(1, 5)))
    )
    factors = generator.uniform(0.0, 2.0, len(slips))
    return [[0.0, 1.0], *np.column_stack([slips, factors]).tolist()]


TABLES = {"slip": _strength, "position": _profile, "wires": _construction}
"""Of curves over what."""


def _table(
    values: Array, peak: float, extent: float, generator: Generator
) -> list[list[float]]:
    """Values at random places; every third time with a narrow peak among them."""
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
    return [
        [float(place), float(value)] for place, value in zip(where, values, strict=True)
    ]
