"""One bar in several units: the iterates must be the same."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import islice

import numpy as np

from solver.arrays import Array
from solver.latin import Iterate, iterations
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of
from solver.study.stability.case import METHODS

SCENE = BarSettings.scene
"""What `invariance` is about."""
UNITS = {
    "millimetres and newtons": (1e3, 1.0),
    "inches and pounds": (1.0 / 0.0254, 1.0 / 4.4482216152605),
}
"""Units in a metre and in a newton."""
SAME_UP_TO = 1e-10
"""Relative difference of iterates that are the same."""
SIZE = {"elements": 24, "substructures": 4, "instants": 31}
ITERATIONS = 40


def invariance() -> dict[str, float]:
    """Compare iterates of one bar written in several units.

    Returns
    -------
    Largest relative difference of displacement and friction force from those in metres and
    newtons, over some iterations, by units and method.
    """
    differences = {}
    for method, options in METHODS.items():
        own = _iterates(options, 1.0, 1.0)
        for units, (length, force) in UNITS.items():
            differences[f"{units}, {method}"] = max(
                max(
                    _difference(first.displacement * length, second.displacement),
                    _difference(first.friction_force * force, second.friction_force),
                )
                for first, second in zip(own, _iterates(options, length, force), strict=True)
            )
    return differences


def _iterates(options: Mapping[str, object], length: float, force: float) -> list[Iterate]:
    """Iterates of the bar of Table 1, for so many units in a metre and in a newton."""
    table = BarSettings.checked({})
    in_units = {
        "length": table.length * length,
        "section": table.section * length**2,
        "young": table.young * force / length**2,
        "pressure": table.pressure * force / length,
        "peak": table.peak * force,
    }
    settings = BarSettings.checked({**SIZE, **options, **in_units})
    return list(islice(iterations(discretise(settings), method_of(settings)), ITERATIONS))


def _difference(first: Array, second: Array) -> float:
    size = float(np.abs(first).max())
    return float(np.abs(first - second).max()) / size if size > 0.0 else float(np.abs(second).max())


def is_same(differences: Mapping[str, float]) -> bool:
    """Whether no unit changed an iterate."""
    return all(difference <= SAME_UP_TO for difference in differences.values())


def message(differences: Mapping[str, float]) -> str:
    """What `invariance` came to, in a sentence."""
    units = ", ".join(f"{difference:.1e} {name}" for name, difference in differences.items())
    same = "the same" if is_same(differences) else "other"
    return f"In other units the bar has {same} iterates; largest relative difference: {units}."
