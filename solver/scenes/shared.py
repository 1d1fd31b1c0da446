"""Parts that scenes share: definitions of settings, and phrases for sentences."""

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
"""Names of the value of a path by its unit; of all other units it is "force"."""
SLACK = 1e-9
"""Share by which rounding may exceed a limit."""
AGAIN = 2
"""Smallest number of times that a load comes and goes "again and again"."""


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
    """Define a factor on a quantity along a body; its default is the first preset.

    `doc` is the help on presets and points where they mean more than that; `others` are
    further arguments of `SettingGroup.curve`.
    """
    name = what.removeprefix("the ")
    title = name
    if name != what:
        title = name.capitalize()
    tables = {}
    for preset, profile in presets.items():
        rows = partial(_over_length, profile.points)
        tables[preset] = TablePreset(profile.description, rows)
    return group.curve(
        next(iter(presets)),
        tables,
        {"position": "m", "factor": ""},
        f"Factor on {what} along {body}: {doc or 'a preset, or points (m, factor).'}",
        title=f"{title} along {body}",
        **others,
    )


def _over_length(shares: Rows, settings: Settings) -> Rows:
    """Points (position, factor), m, from points (share of the length, factor)."""
    return tuple((share * settings.length, factor) for share, factor in shares)


def at_nodes(settings: Settings, places: Array, *profiles: str) -> Array:
    """Product of the factors of one or two profiles at nodes, (n_nodes,).

    Where one of them is a table it is the mean over the shares of the nodes. `places`
    are the positions of the nodes, (n_nodes,), m.
    """
    tables = [settings.points(name) for name in profiles]
    if all(isinstance(getattr(settings, name), str) for name in profiles):
        return math.prod(
            (interpolate(table, places) for table in tables), start=np.ones(1)
        )
    return means(tables, shares_of(places))


def friction_factors(which: str) -> CurveParameter:
    """Define the table of factors on mu of the interfaces."""
    same = TablePreset("1 of each", lambda settings: same_for(settings.n_interfaces))
    return CONTACT.curve(
        "same",
        {"same": same},
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
    """Define a path over time, and the setting of its presets' largest value.

    A path whose value is 0 by default applies only while the value is not 0.

    Parameters
    ----------
    path
        Name of the setting of the path.
    what, unit
        The quantity, and its unit.
    default, ends, slider, doc
        Default, bounds, slider range and help of the value.
    preset, presets
        Default of the path, and all its presets.
    applies
        Function of all settings: whether both of them apply.
    bounds
        Bounds of the columns of the path.
    group
        Heading of both settings.
    record
        Title and further `SettingProperties` of the value.
    """
    name = f"{what[:1].upper()}{what[1:]}"
    entries = {"title": name, "unit": unit, "path": path} | record
    size = group.quantity(default, ends, slider, doc, applies=applies, **entries)
    over_time = group.curve(
        preset,
        presets,
        {"time": "s", _column_name(what, unit): unit},
        f"{name} over time: a preset, whose value is {entries['title']}, or points "
        f"(s, {unit}).",
        bounds=bounds,
        title=f"Path of the {what}",
        applies=lambda settings: (
            applies(settings) and bool(default or settings.is_active(path))
        ),
    )
    return size, over_time


def _column_name(what: str, unit: str) -> str:
    """Name of the column of a quantity in a table of its path."""
    for kind in ("pressure", "tension"):
        if kind in what:
            return kind
    return BY_UNIT.get(unit, "force")


def pressure(which: str, slider: float) -> tuple[param.Number[float], CurveParameter]:
    """Define the pressure of rods per length, with slider range, and its path."""
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


def strength(settings: Any, factors: Array) -> Array:
    """Friction strength mu p of rods at nodes, N/m, from factors, (n_nodes,).

    Shape (n_nodes,), or (n_nodes, n_instants) where the pressure changes.
    """
    density = settings.friction * factors
    if settings.pressure_load == "steady":
        return np.asarray(density * settings.pressure)
    return np.outer(density, settings.path("pressure_load"))


def factors_of(settings: Any) -> Array:
    """Factor on mu of each interface, (n_interfaces,); refuse other tables."""
    return of_each(settings, "friction_factors", settings.n_interfaces, "interface")


def same_for(count: int) -> Rows:
    """Table with the value 1 for each number from 1 to a count."""
    return tuple((float(number), 1.0) for number in range(1, count + 1))


def of_each(settings: Settings, name: str, count: int, what: str) -> Array:
    """Values of a table with a row for each part, (count,); refuse other tables."""
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


def unit_weight(
    default: float,
    bodies: str,
    applies: Callable[[Any], bool] = lambda settings: True,
) -> param.Number[float]:
    """Define the weight per volume of bodies."""
    return LOAD.quantity(
        default,
        (0.0, 1e12),
        (0.0, 1e5),
        f"Weight per volume of {bodies}, which begins to act in the first quarter.",
        unit="N/m^3",
        places=("body",),
        applies=applies,
    )


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
    """Phrase for a load over time: direction of push and pull, to and fro.

    Parameters
    ----------
    path
        Load over time, (n_instants,), of any unit.
    forward, backward
        Words for a positive and for a negative load.
    both
        Words for a load of both signs, made from `forward`.
    back
        Words for a load that returns towards zero, made from the word for its sign.
    """
    size = np.abs(path)
    peak = float(size.max(initial=0.0))
    if peak == 0.0:
        return f"not {forward}"
    if min(path.max(), -path.min()) > 0.0:
        return both.format(forward)
    word = forward if path.max() > 0.0 else backward
    is_large = np.concatenate([[False], size > 0.5 * peak, [False]])
    rises = int(np.sum(is_large[1:] & ~is_large[:-1]))
    if rises >= AGAIN:
        return f"{word} again and again"
    if size[-1] < 0.5 * peak:
        return back.format(word)
    return word


def listed(parts: Sequence[str]) -> str:
    """Join parts with commas, and the last one with "and"."""
    *first, last = parts
    if first:
        return f"{', '.join(first)} and {last}"
    return last


def is_steel(young: float) -> bool:
    """Check whether Young's modulus, Pa, is about that of steel."""
    return 190e9 <= young <= 220e9
