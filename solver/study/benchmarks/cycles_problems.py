"""Problems whose load repeats itself, for any number of cycles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

INSTANTS = 40
"""Of a cycle."""
FEW = (1, 2, 5, 10)
MANY = (1, 2, 5, 10, 20, 50, 100)
"""Cycles; from 20 on a problem takes minutes."""
PRESSED, SHEARED = -4e-5, 2e-5
"""Displacements of the top of the block, m."""
TENSION = 600.0
"""Of a wire, N."""


@dataclass(frozen=True)
class CyclesProblem:
    """A problem of the table.

    Attributes
    ----------
    group
        By which it is asked for.
    label, scene, changes
        What it is called, and its settings, but for the load.
    load
        Gives the settings of so many cycles of a second each.
    most
        Cycles that the limits on settings allow.
    """

    group: str
    label: str
    scene: str
    changes: dict[str, Any]
    load: Callable[[int], dict[str, Any]]
    most: int = MANY[-1]

    def settings(self, cycles: int) -> dict[str, Any]:
        """Give the settings of so many cycles."""
        times = {"instants": INSTANTS * cycles + 1, "duration": float(cycles)}
        return {**self.changes, **times, **self.load(cycles)}


def _sheared(cycles: int) -> dict[str, Any]:
    """Press in the first quarter of the first cycle, and shear to and fro."""
    path = [[0.0, 0.0]]
    for cycle in range(cycles):
        path += [[cycle + 0.25, SHEARED], [cycle + 0.75, -SHEARED], [cycle + 1.0, 0.0]]
    pressed = [[0.0, 0.0], [0.25, PRESSED], [1.0, PRESSED]]
    return {"top_normal_load": pressed, "top_tangential_load": path}


def _pulled(cycles: int) -> dict[str, Any]:
    path = [[0.0, 0.0]]
    for cycle in range(cycles):
        path += [[cycle + 0.5, TENSION], [cycle + 1.0, 0.0]]
    return {"load": path}


def _block(elements: int, most: int = MANY[-1]) -> CyclesProblem:
    up = elements // 2
    sizes = {"elements": elements, "elements_up": up, "substructures": 2, "substructures_up": 1}
    return CyclesProblem(
        "block", f"block {elements} x {up} in 2 x 1", "block", sizes, _sheared, most
    )


PROBLEMS = (
    _block(96),
    _block(192, most=20),
    CyclesProblem("strand", "strand, 20 wires", "strand", {"wires": 20, "elements": 100}, _pulled),
)
GROUPS = tuple(dict.fromkeys(one.group for one in PROBLEMS))
