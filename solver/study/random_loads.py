"""Loads and friction laws of random runs, measured by what friction can carry.

Loads are drawn as shares of the force that friction can hold, and lengths and
stiffnesses of the friction law as shares of the motion and the stiffness of bodies.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.random import Generator

from solver.settings.definitions import properties_of

SELDOM = 0.2
"""Share of the runs with a load that the scene does not have by default."""
OFTEN_LOADS = {"temperature": 0.4, "settlement": 0.4}
"""The same share of loads that are more frequent, by name."""
SMALLEST = 0.03
LARGEST = 10.0
LARGEST_ON_BRICKS = 0.5
"""Smallest and largest load, over the largest friction force; bricks, which nothing
else holds, get smaller ones."""
FORWARD = 0.7
"""Share of the loads in the positive direction."""
PRESSING = "pressure", "normal_stress", "tension", "press"
"""Loads that are as large as the pressing force itself."""
WITHOUT_PATH = (
    "normal_stress",
    "shear_stress",
    "unit_weight",
    "body_force_x",
    "body_force_y",
)
"""Loads that do not change with time."""
SLIPS = 0.01, 10.0
"""Slip at which friction is the last, over the motion of the bodies."""
SPRINGS = 1.0, 1e4
"""Stiffness of contacts over that of bodies."""


CONTACTS = -3.5, -1.6
"""Decimal logarithms of half a contact of round wires over their radius."""
OPENING = 100.0
"""Motion of the abutment of an arch, over its radius and the strain of its weight, that
opens joints."""


def log_uniform(generator: Generator, low: float, high: float) -> float:
    """Random positive number, log-uniformly distributed."""
    return float(np.exp(generator.uniform(math.log(low), math.log(high))))


def random_loads(
    kind: Any, values: Mapping[str, Any], generator: Generator
) -> dict[str, Any]:
    """Random loads, and sizes of the friction law, by the names of their settings.

    Parameters
    ----------
    kind
        Settings of the scene.
    values
        Values drawn so far, by name, in SI.
    generator
        Source of random numbers.
    """
    definitions = kind.definitions()
    default = kind()
    given = {name: definition.default for name, definition in definitions.items()}
    given.update(values)
    if "length" not in given:
        given["length"] = default.parts.size
    scales = _scales(kind, given, generator)
    friction, largest = _friction_and_largest_load(given)
    sizes: dict[str, Any] = {}
    for name, definition in definitions.items():
        record = properties_of(definition)
        is_load = record.path or name in WITHOUT_PATH
        if not is_load or record.unit not in scales:
            continue
        is_seldom = not definition.default and default.applies(name)
        if is_seldom and generator.random() > OFTEN_LOADS.get(name, SELDOM):
            continue
        factor = _load_factor(name, friction, largest, generator)
        sizes[name] = factor * scales[record.unit]
    sizes |= _strengths(kind, given, sizes, scales, values, generator)
    sizes |= _friction_law(kind, given, scales["m"], values, generator)
    if "radius" in definitions:
        # A parabola with this radius leaves a gap at its ends as wide as bodies move.
        flat = given["length"] ** 2 / (8.0 * scales["m"])
        sizes["radius"] = flat * 10.0 ** generator.uniform(-1.5, 1.5)
    return sizes


def _friction_and_largest_load(given: Mapping[str, Any]) -> tuple[float, float]:
    """Coefficient of friction that limits loads, and largest load over friction.

    `given` are all settings by name. A wall of bricks tips before it slides where
    friction is larger than its width over its height.
    """
    friction = given["friction"]
    if "voussoirs" in given:
        return friction, LARGEST_ON_BRICKS
    if "bricks" not in given:
        return friction, LARGEST
    width = given["length"] * given["bricks"]
    height = given["height"] * given["courses"]
    return min(friction, 0.5 * width / height), LARGEST_ON_BRICKS


def _load_factor(
    name: str, friction: float, largest: float, generator: Generator
) -> float:
    """Random load over the pressing force, by the name of its setting."""
    share = log_uniform(generator, SMALLEST, largest)
    factor = friction * share
    if generator.random() >= FORWARD:
        factor = -factor
    if name in PRESSING:
        return 1.0
    # More pressure of a fluid than presses would open the fault.
    if name == "overpressure":
        return float(generator.uniform(0.0, 1.0))
    if name == "unit_weight":
        return float(generator.uniform(0.0, 0.1))
    if "_normal_" in name or name == "body_force_y":
        return -1.0 if generator.random() < 0.9 else 1.0
    return factor


def _strengths(
    kind: Any,
    given: Mapping[str, Any],
    loads: Mapping[str, float],
    scales: Mapping[str, float],
    values: Mapping[str, Any],
    generator: Generator,
) -> dict[str, float]:
    """Random cohesion and cap, relative to the friction of the pressing force.

    Parameters
    ----------
    kind, given, loads, scales
        Settings of the scene, all values, loads, and scales by unit.
    values
        Values drawn so far: those of cohesion and cap are replaced.
    generator
        Source of random numbers.
    """
    sizes = {}
    pressing = loads.get("pressure", loads.get("normal_stress"))
    for name in ("cohesion", "friction_cap"):
        unit = properties_of(kind.definitions()[name]).unit
        size = pressing or scales.get(unit)
        if name in values and size:
            share = given["friction"] * size
            sizes[name] = share * log_uniform(generator, 0.01, 10.0)
    return sizes


def _friction_law(
    kind: Any,
    given: Mapping[str, Any],
    motion: float,
    values: Mapping[str, Any],
    generator: Generator,
) -> dict[str, Any]:
    """Random lengths and stiffnesses of the friction law, if it has any.

    Slips are measured by the motion of the bodies, m, springs by their stiffness.
    """
    sizes: dict[str, Any] = {}
    if "slip_length" in values:
        sizes["slip_length"] = motion * log_uniform(generator, *SLIPS)
    table = values.get("strength")
    if isinstance(table, list):
        last = motion * log_uniform(generator, *SLIPS)
        end = table[-1][0]
        sizes["strength"] = [[last * slip / end, factor] for slip, factor in table]
    stiffness = _stiffness(kind, given)
    for name in ("tangential_stiffness", "normal_stiffness"):
        if name in values:
            sizes[name] = stiffness * log_uniform(generator, *SPRINGS)
    return sizes


def _stiffness(kind: Any, given: Mapping[str, Any]) -> float:
    """Stiffness of a body per length of a rod, N/m^2, or per area, N/m^3."""
    length: float = given["length"]
    if "construction" in given:
        return float(_section(kind, given).stiffness) / length**2
    if "section" in given:
        return float(given["young"] * given["section"]) / length**2
    return float(given["young"]) / length


def _section(kind: Any, given: Mapping[str, Any]) -> Any:
    """Cross-section of a rope."""
    names = {"construction", "layers"} & given.keys()
    return kind.checked({name: given[name] for name in names}).section


def _scales(
    kind: Any, given: Mapping[str, Any], generator: Generator
) -> dict[str, float]:
    """Scales by unit: pressing force, and motion and strain under an equal load."""
    if "construction" in given:
        return _scales_of_rope(kind, given, generator)
    if "wrap" in given:
        return _scales_of_band(given, generator)
    if "section" in given:
        return _scales_of_rod(given)
    if "slack" in given:
        weight = given["weight"]
        return {"Pa": weight / given["length"], "m": weight / given["spring"]}
    if "voussoirs" in given:
        return _scales_of_arch(given)
    if "rings" in given:
        return _scales_of_wires(given, generator)
    return _scales_in_plane(kind, given, generator)


def _scales_of_arch(given: Mapping[str, Any]) -> dict[str, float]:
    """Scales of an arch by unit: weight, and motions of abutments that open joints."""
    radius = given["length"]
    volume = math.radians(given["span"]) * given["thickness"] * radius**2
    strain = given["unit_weight"] * radius / given["young"]
    return {"N": given["unit_weight"] * volume, "m": OPENING * strain * radius}


def _scales_of_wires(
    given: Mapping[str, Any], generator: Generator
) -> dict[str, float]:
    """Scales of round wires by unit: force for a random contact width, and motion."""
    half_width = 10.0 ** generator.uniform(*CONTACTS)
    force = half_width**2 * given["young"] * given["length"]
    return {
        "N": force,
        "m": force / given["young"],
        "N/m^3": force / given["length"] ** 2,
    }


def _scales_of_rope(
    kind: Any, given: Mapping[str, Any], generator: Generator
) -> dict[str, float]:
    """Scales of a rope by unit, with a random strain of its tension."""
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


def _scales_of_band(given: Mapping[str, Any], generator: Generator) -> dict[str, float]:
    """Scales of a band on a guide by unit, with a random strain of its tension."""
    strain = 10.0 ** generator.uniform(-6.0, -2.0)
    length = given["length"]
    if given["guide"] == "drum":
        length = math.radians(given["wrap"]) * given["drum_radius"]
    tension = strain * given["young"] * given["section"]
    return {"N": tension, "m": strain * length}


def _scales_of_rod(given: Mapping[str, Any]) -> dict[str, float]:
    """Scales of a rod under its pressure, by unit."""
    pressed = given["pressure"] * given["length"]
    strain = pressed / (given["young"] * given["section"])
    return {
        "N": pressed,
        "N/m": given["pressure"],
        "m": strain * given["length"],
        "K": strain / given.get("expansion", math.inf),
    }


def _scales_in_plane(
    kind: Any, given: Mapping[str, Any], generator: Generator
) -> dict[str, float]:
    """Scales of bodies in the plane by unit, with a random strain of the pressure."""
    length = given["length"]
    height = given[kind.across] * given.get("layers", 1) * given.get("courses", 1)
    smallest = -6.0
    bent = 1.0
    if "layers" in given:
        smallest = -7.0
        # A force at the end moves slender bodies by bending, far more than by strain.
        bent = 8.0 / 3.0 * (length / height) ** 3
    strain = 10.0 ** generator.uniform(smallest, -3.0)
    pressure = strain * given["young"]
    return {
        "Pa": pressure,
        "m": bent * strain * height,
        "N/m": pressure * height / 1.5,
        "N·m/m": pressure * length * height / 3.0,
        "N/m^3": pressure / height,
        "°": 20.0,
    }
