"""Problems on which LATIN is set beside the incremental solver: sizes that grow, and the scenes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from solver.scenes import CATALOGUE

CELL = 24
"""Elements along a substructure of a block, and up it."""


@dataclass(frozen=True)
class AheadProblem:
    """A problem of the table.

    Attributes
    ----------
    group
        By which a part of the table is asked for.
    is_large
        Whether all of its runs take minutes.
    """

    group: str
    label: str
    scene: str
    changes: dict[str, Any]
    is_large: bool = False


def _strand(wires: int, *, is_large: bool = False) -> AheadProblem:
    changes = {"wires": wires, "elements": 100, "instants": 101}
    return AheadProblem("strand", f"strand, {wires} wires", "strand", changes, is_large)


def _block(elements: int, *, is_large: bool = False) -> AheadProblem:
    up = elements // 2
    changes = {
        "elements": elements,
        "elements_up": up,
        "substructures": elements // CELL,
        "substructures_up": up // CELL,
        "instants": 51,
    }
    return AheadProblem("block", f"block {elements} x {up}", "block", changes, is_large)


def _layers(layers: int, *, is_large: bool = False, **more: int) -> AheadProblem:
    label = " x ".join([f"{layers} layers", *(f"{more[name]} elements" for name in more)])
    return AheadProblem("layers", label, "layers", {"layers": layers, **more}, is_large)


def _thin(ratio: int) -> AheadProblem:
    label = f"layers, length {ratio} x thickness"
    return AheadProblem("thin", label, "layers", {"length": 0.01 * ratio, "thickness": 0.01})


PROBLEMS = (
    *(AheadProblem("scenes", f"{scene}, defaults", scene, {}) for scene in CATALOGUE),
    *(_strand(wires) for wires in (3, 10, 20)),
    *(_block(elements) for elements in (48, 96, 192, 384)),
    *(_layers(layers) for layers in (4, 10, 20)),
    *(_thin(ratio) for ratio in (200, 500, 1000)),
    AheadProblem("bar", "bar 1600 x 1600", "bar", {"elements": 1600, "instants": 1600}, True),
    _strand(40, is_large=True),
    _block(768, is_large=True),
    _layers(40, is_large=True),
    _layers(20, is_large=True, elements=96),
)
GROUPS = tuple(dict.fromkeys(one.group for one in PROBLEMS))


def chosen_problems(group: str | None, *, with_large: bool) -> list[AheadProblem]:
    """Give the problems of a group, or all; those of minutes only if they are asked for."""
    own = [one for one in PROBLEMS if group in (None, one.group)]
    return [one for one in own if with_large or not one.is_large]
