"""Strands of helical wires for tests, by their settings."""

from __future__ import annotations

from typing import Any

from solver.arrays import Array
from solver.discrete import discretise
from solver.discrete.rope.rope import Rope
from solver.reference.closed_forms.bent_strand import BentStrand
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes.rope import RopeSettings

SMALL_ROPE: dict[str, Any] = {
    "layers": 1,
    "length": 0.15,
    "tension": 4e4,
    "substructures": 2,
}
STRAND: dict[str, Any] = {"bending": "uniform", "elements": 40, "substructures": 4}


def settings_of(**changes: Any) -> RopeSettings:
    return RopeSettings.checked(STRAND | changes)


def solved(settings: RopeSettings) -> tuple[Rope, Reference]:
    scene = settings.structure()
    return scene, reference_of(discretise(scene))


def moment_of(scene: Rope, found: Reference) -> Array:
    return scene.moment()(found.displacement)


def exact_of(settings: RopeSettings) -> BentStrand:
    found = settings.bent_strand()
    assert found is not None
    return found
