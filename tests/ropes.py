"""Strands of helical wires for tests, by their settings."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.arrays import Array
from solver.discrete.rope import Rope
from solver.reference.bent_wire import BentWire
from solver.reference.incremental import incremental
from solver.reference.solution import Reference
from solver.scenes.rope import RopeSettings, rope

STRAND: dict[str, Any] = {"bending": "uniform", "elements": 40, "substructures": 4}


def settings_of(**changes: Any) -> RopeSettings:
    return RopeSettings.checked({**STRAND, **changes})


def solved(settings: RopeSettings) -> tuple[Rope, Reference]:
    scene = rope(settings)
    return scene, incremental(scene.discretise())


def moment_of(scene: Rope, found: Reference) -> Array:
    return scene.moment()(found.displacement)


def layers_of(settings: RopeSettings) -> list[tuple[int, BentWire]]:
    """Give how many wires each layer has, and the closed form of one."""
    section = settings.section
    below, above = section.line_pressures(np.array([settings.tension]))
    bounds = settings.friction * (below + above)[:, 0]
    return [
        (layer.wires, BentWire(section.helix(number), float(bounds[number])))
        for number, layer in enumerate(section.layers)
    ]


def exact_moment(settings: RopeSettings, curvature: Array) -> Array:
    """Give the moment of the strand as it is first bent, by the closed form, N m."""
    own = settings.section.slipping_bending * curvature
    return own + sum(wires * bent.moment(curvature) for wires, bent in layers_of(settings))
