"""Random loads, up to ten times what friction carries."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.random import Generator

from solver.scenes.rope import RopeSettings
from solver.scenes.sides import AT_REST, COMPONENTS, LOADED_SIDES, PRESCRIBED

SMALLEST, LARGEST = 0.03, 10.0
"""Loads over what friction carries."""
Values = Mapping[str, Any]
Sizes = dict[str, float]


def _share(generator: Generator) -> float:
    """A load over what friction carries, pushing as often as pulling."""
    size = float(np.exp(generator.uniform(np.log(SMALLEST), np.log(LARGEST))))
    return size if generator.random() < 0.7 else -size


def bar_loads(values: Values, generator: Generator) -> Sizes:
    """The loads of the bar; each beside those of its ends in a fifth of all runs."""
    length = values["length"]
    carried = values["friction"] * values["pressure"] * length
    stretched = carried * length / (values["young"] * values["section"])
    peak = carried * _share(generator)
    loads = {"peak": peak, "load": peak}
    loads["left_force"] = carried * _share(generator)
    loads["right_displacement"] = stretched * _share(generator)
    others = {
        **{"body_force": carried / length, "support_displacement": stretched},
        **{"settlement": stretched, "temperature": stretched / length / values["expansion"]},
    }
    return loads | {
        name: size * _share(generator) for name, size in others.items() if generator.random() < 0.2
    }


def strand_loads(values: Values, generator: Generator) -> Sizes:
    """The tension of the strand; wires are not pushed."""
    carried = values["friction"] * values["pressure"] * values["length"]
    peak = carried * abs(_share(generator))
    return {"peak": peak, "load": peak}


def block_loads(values: Values, generator: Generator) -> Sizes:
    """What presses and drags the block, and the radius under it to match.

    What is pressed in is 1e-6 to 1e-3 of the height; other sides than the top are loaded alike.
    """
    strain = 10.0 ** generator.uniform(-6.0, -3.0)
    height, young = values["height"], values["young"]
    loads: Sizes = {}
    for side in LOADED_SIDES:
        if values[side] in AT_REST:
            continue
        for component, prescribed in zip(COMPONENTS, PRESCRIBED[values[side]], strict=True):
            share = values["friction"] * _share(generator)
            if component == "normal":
                # The top presses, but now and then.
                share = -1.0 if generator.random() < 0.9 else 1.0
            depth = height if side == "top" else values["length"]
            kind, size = ("displacement", depth) if prescribed else ("traction", young)
            loads[f"{side}_{component}_{kind}"] = share * strain * size
            loads[f"{side}_{component}_load"] = share * strain * size
    pressed_in = strain * height
    loads["radius"] = values["length"] ** 2 / (
        8.0 * pressed_in * 10.0 ** generator.uniform(-1.5, 1.5)
    )
    if generator.random() < 0.1:
        loads["body_force_y"] = -strain * young / height
    if generator.random() < 0.1:
        loads["body_force_x"] = values["friction"] * strain * young / height * _share(generator)
    return loads


def layers_loads(values: Values, generator: Generator) -> Sizes:
    """What bends and pulls the stack: by the shear that friction carries between layers."""
    length, thickness = values["length"], values["thickness"]
    height = thickness * values["layers"]
    pressure = values["young"] * 10.0 ** generator.uniform(-7.0, -4.0)
    carried = values["friction"] * pressure
    # Shear in the middle of a cantilever, 3/2 of the mean, under a force at its end.
    bent = carried * length**3 / (0.375 * values["young"] * height**2)
    moment = carried * length * height / 3.0
    loads = {
        "pressure": pressure,
        "pressure_load": pressure,
        "deflection": bent * _share(generator),
        "moment": moment * _share(generator),
        "force": carried * height / 1.5 * _share(generator),
    }
    loads["bend_load"] = loads[values["bending"]]
    if generator.random() < 0.3:
        loads["pull"] = carried * length / height * _share(generator)
    return loads


def rope_loads(values: Values, generator: Generator) -> Sizes:
    """The tension of the rope, and how far it is bent: by where its outer wires slip first."""
    given = {name: values[name] for name in ("construction", "layers")}
    section = RopeSettings.checked(given).section
    tension = section.stiffness * 10.0 ** generator.uniform(-4.0, -2.0)
    helix = section.helix(len(section.layers) - 1)
    strain = tension / section.stiffness
    first = values["friction"] * strain * abs(np.sin(helix.lay)) / helix.radius
    bent = float(first * _share(generator))
    return {"tension": tension, "tension_load": tension, "curvature": bent, "load": bent}


def incline_loads(values: Values, generator: Generator) -> Sizes:
    """The angle of a slope up to which a table goes."""
    return {"slope_load": float(values["slope"] * generator.uniform(0.0, 1.0))}


def fault_loads(values: Values, generator: Generator) -> Sizes:
    """What presses, shears and loosens a fault: the fluid presses less than the rest does."""
    pressing = values["young"] * 10.0 ** generator.uniform(-6.0, -3.0)
    fluid = float(pressing * generator.uniform(0.0, 1.0))
    stress = values["friction"] * pressing * _share(generator)
    return {
        "normal_stress": pressing,
        "overpressure": fluid,
        "injection_load": fluid,
        "shear_stress": stress,
    }


def wall_loads(values: Values, generator: Generator) -> Sizes:
    """What presses a wall, and what moves its top while its bricks are held.

    Up to half of the strain by which the pressure shortens it, and of the smaller one of the
    tractions at which rigid blocks slide and tip. Paths are presets: with a table the top may be
    moved before anything presses, and then where bricks lie is not determinate.
    """
    pressure = values["young"] * 10.0 ** generator.uniform(-6.0, -3.0)
    height = values["height"] * values["courses"]
    stable = min(values["friction"], 0.5 * values["length"] * values["bricks"] / height)
    share = float(generator.uniform(-0.5, 0.5))
    return {
        "pressure": pressure,
        "displacement": share * pressure / values["young"] * height,
        "traction": share * stable * pressure,
        "unit_weight": 0.1 * pressure / height * float(generator.uniform()),
        "slope": 20.0 * share * stable,
    }


LOADS: dict[str, Callable[[Values, Generator], Sizes]] = {
    "bar": bar_loads,
    "strand": strand_loads,
    "block": block_loads,
    "layers": layers_loads,
    "rope": rope_loads,
    "fault": fault_loads,
    "incline": incline_loads,
    "wall": wall_loads,
}
"""Sizes of loads by name, which depend on the other values; of curves, those of their tables. A
scene without an entry has its loads drawn by their definitions alone."""
