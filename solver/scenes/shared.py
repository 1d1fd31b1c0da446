"""What several scenes have alike: definitions of settings, and words of their sentences."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import param

from solver.arrays import Array
from solver.settings.definitions import (
    CONTACT,
    LOAD,
    POSITIVE,
    CurveParameter,
    Rows,
    SettingGroup,
    TablePreset,
)
from solver.settings.load_paths import PRESETS, PRESSURES, Preset, interpolate
from solver.settings.profiles import Profile, means, shares_of
from solver.settings.scene import Settings

STRAND = SettingGroup("Strand")
PROFILES = {
    "uniform": Profile("1 all along", ((0.0, 1.0), (1.0, 1.0))),
    "rising": Profile(
        "rises evenly from 0.2 at the left end to 1.8 at the right end",
        ((0.0, 0.2), (1.0, 1.8)),
    ),
    "falling": Profile(
        "falls evenly from 1.8 at the left end to 0.2 at the right end",
        ((0.0, 1.8), (1.0, 0.2)),
    ),
    "gap": Profile(
        "1, and 0 in the middle fifth of the length",
        ((0.0, 1.0), (0.4, 1.0), (0.401, 0.0), (0.599, 0.0), (0.6, 1.0), (1.0, 1.0)),
    ),
}
"""Factors along a body."""
BY_UNIT = {
    "m": "displacement",
    "K": "temperature",
    "°": "angle",
    "1/m": "curvature",
    "Pa": "traction",
}
"""What a path without a word of its own has, by its unit; else it is a force."""
AGAIN = 2
"""Times that a load comes and goes from which it does so again and again."""


def friction(which: str, *, largest: float = 1e6) -> param.Number[float]:
    """Define a coefficient of friction."""
    return CONTACT.quantity(
        0.3,
        (0.0, largest),
        (0.0, 1.0),
        f"Coefficient of friction {which}.",
        title="Friction coefficient μ",
    )


def profile(
    what: str,
    body: str,
    presets: Mapping[str, Profile] = PROFILES,
    doc: str = "",
    group: SettingGroup = CONTACT,
    **others: Any,
) -> CurveParameter:
    """Define a factor on something along a body; its default is the first preset.

    Help is needed of what is more than a preset or points; `others` are what a curve
    takes.
    """
    name = what.removeprefix("the ")
    if name == what:
        title = name
    else:
        title = name.capitalize()
    return group.curve(
        next(iter(presets)),
        {
            preset: TablePreset(
                profile.description, partial(_over_length, profile.points)
            )
            for preset, profile in presets.items()
        },
        {"position": "m", "factor": ""},
        f"Factor on {what} along {body}: {doc or 'a preset, or points (m, factor).'}",
        title=f"{title} along {body}",
        **others,
    )


def _over_length(shares: Rows, settings: Settings) -> Rows:
    return tuple((share * settings.length, factor) for share, factor in shares)


def at_nodes(settings: Settings, places: Array, *profiles: str) -> Array:
    """Product of the factors of one or two profiles at nodes, from their places, (n_nodes,), m.

    Of tables it is the mean over the shares of the nodes.
    """
    tables = [settings.points(name) for name in profiles]
    if all(isinstance(getattr(settings, name), str) for name in profiles):
        return math.prod(
            (interpolate(table, places) for table in tables), start=np.ones(1)
        )
    return means(tables, shares_of(places))


def friction_factors(which: str) -> CurveParameter:
    """Define how mu varies from interface to interface."""
    return CONTACT.curve(
        "same",
        {
            "same": TablePreset(
                "1 of each", lambda settings: same_for(settings.n_interfaces)
            )
        },
        {"interface": "", "factor": ""},
        f"Factor on mu of each interface {which}: a preset, or points (interface, "
        "factor), one for each, numbered from 1 on.",
        bounds=POSITIVE,
        title="μ of each interface",
    )


def sized_path(
    path: str,
    what: str,
    unit: str,
    default: float,
    ends: tuple[float, float],
    slider: tuple[float, float],
    doc: str,
    preset: str,
    presets: Mapping[str, Preset] = PRESETS,
    *,
    applies: Callable[[Any], bool] = lambda settings: True,
    bounds: Sequence[tuple[float, float]] = (),
    group: SettingGroup = LOAD,
    **record: Any,
) -> tuple[param.Number[float], CurveParameter]:
    """Define the largest value that presets of a path over time reach, and the path.

    Where that value is 0 by default, there is no path as long as it is. `path` is the
    name of its setting. The path starts as a `preset`, with `bounds` of its columns;
    `record` is of the value.
    """
    record = {
        "title": f"{what[:1].upper()}{what[1:]}",
        "unit": unit,
        "path": path,
    } | record
    size = group.quantity(default, ends, slider, doc, applies=applies, **record)
    named = (kind for kind in ("pressure", "tension") if kind in what)
    over_time = group.curve(
        preset,
        presets,
        {"time": "s", next(named, BY_UNIT.get(unit, "force")): unit},
        f"{what[:1].upper()}{what[1:]} over time: a preset, whose value is "
        f"{record['title']}, or points (s, {unit}).",
        bounds=bounds,
        title=f"Path of the {what}",
        applies=lambda settings: (
            applies(settings) and bool(default or settings.acts(path))
        ),
    )
    return size, over_time


def pressure(which: str, slider: float) -> tuple[param.Number[float], CurveParameter]:
    """Define the pressure of rods, per length, up to that value on its slider, and its path."""
    return sized_path(
        "pressure_load",
        "pressure",
        "N/m",
        5000.0,
        (0.0, 1e15),
        (0.0, slider),
        f"Pressure p of {which}, per length.",
        "steady",
        PRESSURES,
        bounds=POSITIVE,
        group=CONTACT,
        title="Pressure p",
        places=("top y",),
    )


def bound(settings: Any, factors: Array) -> Array:
    """Mu p of rods at nodes, N/m, (n_nodes,), or (n_nodes, n_instants) where it changes."""
    density = settings.friction * factors
    if settings.pressure_load == "steady":
        return np.asarray(density * settings.pressure)
    return np.outer(density, settings.path("pressure_load"))


def factors_of(settings: Any) -> Array:
    """Factor on mu of each interface, (n_interfaces,); a table of others is refused."""
    return of_each(settings, "friction_factors", settings.n_interfaces, "interface")


def same_for(count: int) -> Rows:
    """Table of as many ones."""
    return tuple((float(number), 1.0) for number in range(1, count + 1))


def of_each(settings: Settings, name: str, count: int, what: str) -> Array:
    """Values of a table that has one for each of so many, (count,); others are refused."""
    table = settings.points(name)
    numbers, values = np.array(table).T
    if not np.array_equal(numbers, np.arange(1, count + 1)):
        raise settings.refusal(
            name,
            f"{count} pairs, one for each {what}",
            f"there are {len(table)}: number each {what} from 1 to {count}",
        )
    return np.asarray(values)


def size(
    default: float,
    slider: tuple[float, float],
    title: str,
    doc: str,
    group: SettingGroup,
) -> param.Number[float]:
    """Define a length of a body."""
    return group.quantity(default, (1e-6, 1e4), slider, doc, title=title, unit="m")


def young(
    group: SettingGroup,
    default: float = 210e9,
    slider: tuple[float, float] = (1e8, 1e12),
) -> param.Number[float]:
    """Define Young's modulus, that of steel by default."""
    return group.quantity(
        default,
        (1.0, 1e18),
        slider,
        "Young's modulus.",
        title="Young's modulus E",
        unit="Pa",
    )


def section(doc: str, group: SettingGroup) -> param.Number[float]:
    """Define the area of the cross section of a rod, that of Table 1 by default."""
    return group.quantity(
        3.14e-6,
        (1e-15, 100.0),
        (1e-7, 1e-4),
        doc,
        title="Cross section S",
        unit="m^2",
    )


def acting(
    path: Array,
    forward: str,
    backward: str,
    both: str = "{} to and fro",
    back: str = "{} and let go",
) -> str:
    """What is done over time by a load: forward where it is positive, backward, or both.

    It is said in other words that it is done both ways, and that it comes back.
    """
    size = np.abs(path)
    peak = float(size.max(initial=0.0))
    if peak == 0.0:
        return f"not {forward}"
    if min(path.max(), -path.min()) > 0.0:
        return both.format(forward)
    word = forward if path.max() > 0.0 else backward
    over = np.concatenate([[False], size > 0.5 * peak, [False]])
    times = int(np.sum(over[1:] & ~over[:-1]))
    if times >= AGAIN:
        return f"{word} again and again"
    if size[-1] < 0.5 * peak:
        return back.format(word)
    return word


def listed(parts: Sequence[str]) -> str:
    """Write parts with commas, and the last with an "and"."""
    *first, last = parts
    if first:
        return f"{', '.join(first)} and {last}"
    return last


def is_steel(young: float) -> bool:
    """Return whether something is about as stiff as steel."""
    return 190e9 <= young <= 220e9
