"""Definitions of settings that several scenes have alike."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

import numpy as np
import param

from solver.arrays import Array
from solver.definitions import CurveParameter, SettingError, count, curve, quantity
from solver.discrete.rods import Rods
from solver.discrete.rope import Rope
from solver.loads import PRESSURES
from solver.settings import Settings

S = TypeVar("S", Rods, Rope)

PROFILES = {
    "uniform": ((0.0, 1.0), (1.0, 1.0)),
    "rising": ((0.0, 0.2), (1.0, 1.8)),
    "falling": ((0.0, 1.8), (1.0, 0.2)),
    "gap": ((0.0, 1.0), (0.4, 1.0), (0.401, 0.0), (0.599, 0.0), (0.6, 1.0), (1.0, 1.0)),
}
"""Factors along a body, over shares of its length."""
PLANE_GROWS = ("elements", "elements_up", "substructures", "substructures_up")


def seed(applies: Callable[[Any], bool]) -> param.Integer[int]:
    """Define the seed of random load paths."""
    return count(
        1,
        (0, 2**31 - 1),
        (0, 50),
        "Seed of random load paths: the same seed gives the same path.",
        group="Load",
        title="Seed",
        applies=applies,
    )


def duration() -> param.Number[float]:
    """Define the length of the time interval."""
    return quantity(
        1.0,
        (1e-9, 1e9),
        (0.1, 10.0),
        "Length of the time interval. Friction does not feel the rate: only the time axis changes.",
        group="Load",
        title="Duration T",
        unit="s",
        logarithmic=True,
    )


def instants(default: int) -> param.Integer[int]:
    """Define the number of instants."""
    return count(
        default,
        (1, 20_001),
        (11, 401),
        "Number of instants at which the problem is solved, at least: points at which a path turns "
        "or bends are instants too, and the load is linear between them.",
        group="Load",
        title="Instants",
    )


def friction(which: str, *, largest: float = 1e6) -> param.Number[float]:
    """Define a coefficient of friction."""
    return quantity(
        0.3,
        (0.0, largest),
        (0.0, 1.0),
        f"Coefficient of friction {which}.",
        group="Contact",
        title="Friction coefficient μ",
    )


def friction_profile(body: str, presets: Iterable[str] = PROFILES) -> CurveParameter:
    """Define how mu varies along a body."""
    return curve(
        "uniform",
        presets,
        "position",
        "factor",
        ("m", ""),
        f"Factor on mu along {body}: a preset, or points (m, factor).",
        group="Contact",
        title=f"μ along {body}",
    )


def friction_factors(which: str) -> CurveParameter:
    """Define how mu varies from interface to interface."""
    return curve(
        "same",
        ("same",),
        "interface",
        "factor",
        ("", ""),
        f"Factor on mu of each interface {which}. same: 1. Or points (interface, factor), one for "
        "each, numbered from 1 on.",
        group="Contact",
        title="μ of each interface",
    )


def pressure(which: str, slider: float) -> param.Number[float]:
    """Define the pressure of rods, per length, up to that value on its slider."""
    return quantity(
        5000.0,
        (0.0, 1e15),
        (0.0, slider),
        f"Pressure p of {which}, per length.",
        group="Contact",
        title="Pressure p",
        unit="N/m",
        applies=lambda settings: isinstance(settings.pressure_load, str),
    )


def pressure_load() -> CurveParameter:
    """Define how that pressure goes on over time."""
    return curve(
        "steady",
        PRESSURES,
        "time",
        "pressure",
        ("s", "N/m"),
        "Pressure over time. loosening: it stays for a quarter of the interval, and falls to a "
        "fifth, as of a bolt. tightening: the other way. shaken: it falls to a fifth and comes "
        "back, six times. Or points (s, N/m).",
        group="Contact",
        title="p over time",
    )


def refuse_negative(settings: Settings, name: str, what: str, unit: str = "") -> None:
    """Refuse a table with values below zero.

    Parameters
    ----------
    settings, name
        Whose, and which of its curves.
    what, unit
        A value in words, and a blank and its unit.

    Raises
    ------
    SettingError
        For a table that goes below zero.
    """
    table = getattr(settings, name)
    if not isinstance(table, str) and min(value for _, value in table) < 0.0:
        allowed = f"{what}s of at least 0{unit}"
        raise SettingError(name, table, allowed, f"raise the negative {what}")


def factors_of(settings: Settings, count: int) -> Array | None:
    """Factor on mu of so many interfaces, shape (count,); None where mu is the same.

    Raises
    ------
    SettingError
        For a table that lacks an interface, or has others, and for factors below zero.
    """
    name = "friction_factors"
    if isinstance(getattr(settings, name), str):
        return None
    refuse_negative(settings, name, "factor")
    return of_each(settings, name, count, "interface")


def of_each(settings: Settings, name: str, count: int, what: str) -> Array:
    """Values of a table that has one for each of so many, shape (count,).

    Parameters
    ----------
    settings, name
        Whose, and which of its tables.
    count, what
        Their number, and what they are.

    Raises
    ------
    SettingError
        For a table that lacks one, or has others.
    """
    table = getattr(settings, name)
    numbers, values = np.array(table).T
    if not np.array_equal(numbers, np.arange(1, count + 1)):
        raise SettingError(
            name,
            table,
            f"{count} pairs, one for each {what}",
            f"there are {len(table)}: number each {what} from 1 to {count}",
        )
    return np.asarray(values)


def ever_coarser(structure: S | None) -> Iterator[S]:
    """Yield the same structure, uncut, on ever coarser meshes, the finest first."""
    while structure is not None and (structure := structure.coarser()) is not None:
        yield structure


def size(
    default: float, slider: tuple[float, float], title: str, doc: str, group: str
) -> param.Number[float]:
    """Define a length of a body."""
    return quantity(
        default, (1e-6, 1e4), slider, doc, group=group, title=title, unit="m", logarithmic=True
    )


def young(
    group: str, default: float = 210e9, slider: tuple[float, float] = (1e8, 1e12)
) -> param.Number[float]:
    """Define Young's modulus, that of steel by default."""
    return quantity(
        default,
        (1.0, 1e18),
        slider,
        "Young's modulus.",
        group=group,
        title="Young's modulus E",
        unit="Pa",
        logarithmic=True,
    )


def section(doc: str, group: str) -> param.Number[float]:
    """Define the area of the cross section of a rod, that of Table 1 by default."""
    return quantity(
        3.14e-6,
        (1e-15, 100.0),
        (1e-7, 1e-4),
        doc,
        group=group,
        title="Cross section S",
        unit="m^2",
        logarithmic=True,
    )
