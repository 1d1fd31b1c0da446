"""One bar in several units: the iterates must be the same."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import islice

import numpy as np

from solver.arrays import Array
from solver.latin import iterations
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of
from solver.study.audit.cases import METHODS

SCENE = BarSettings.scene
"""Which scene `invariance` is about."""
UNITS = {
    "millimetres and newtons": (1e3, 1.0),
    "inches and pounds": (1.0 / 0.0254, 1.0 / 4.4482216152605),
}
"""Units in a metre and in a newton."""
SAME_UP_TO = 1e-10
"""Relative difference of iterates that are the same."""


def invariance(number: int = 40) -> dict[str, float]:
    """Compare iterates of one bar written in several units.

    Returns
    -------
    Largest relative difference of displacement and friction force from those in metres and
    newtons, over some iterations, by units and method.
    """
    size = {"elements": 24, "substructures": 4, "instants": 31}
    found = {}
    for method, options in METHODS.items():
        for units, (length, force) in UNITS.items():
            pair = (
                BarSettings.checked({**size, **options, **bar_in_units(*of)})
                for of in ((1.0, 1.0), (length, force))
            )
            both = (
                islice(iterations(discretise(chosen), method_of(chosen)), number) for chosen in pair
            )
            found[f"{units}, {method}"] = max(
                max(
                    _apart(one.displacement * length, other.displacement),
                    _apart(one.friction_force * force, other.friction_force),
                )
                for one, other in zip(*both, strict=True)
            )
    return found


def bar_in_units(length: float, force: float) -> dict[str, float]:
    """Give the settings of Table 1 that have units, for so many units in a metre and a newton."""
    table = BarSettings.checked({})
    return {
        "length": table.length * length,
        "section": table.section * length**2,
        "young": table.young * force / length**2,
        "pressure": table.pressure * force / length,
        "peak": table.peak * force,
    }


def _apart(one: Array, other: Array) -> float:
    size = float(np.abs(one).max())
    return float(np.abs(one - other).max()) / size if size > 0.0 else float(np.abs(other).max())


def words_of(apart: Mapping[str, float]) -> str:
    """Say what `invariance` found."""
    units = ", ".join(f"{found:.1e} {name}" for name, found in apart.items())
    same = "the same" if is_same(apart) else "other"
    return f"In other units the bar has {same} iterates; largest relative difference: {units}."


def is_same(apart: Mapping[str, float]) -> bool:
    """Tell whether no unit changed an iterate."""
    return all(found <= SAME_UP_TO for found in apart.values())
