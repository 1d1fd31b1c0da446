"""A strand of helical wires, stretched and bent (solver/README.md, 6)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.loops import LoopFields
from solver.discrete.problem import Problem
from solver.discrete.rope.data import RopeWire
from solver.discrete.rope.rope import Rope
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.bent_strand import BentStrand
from solver.scenes.entry import Emblem, Entry
from solver.scenes.rope_settings import RopeSettings
from solver.scenes.words import acting, counted


def rope(settings: RopeSettings) -> Rope:
    """Make the strand that the settings describe.

    Wires of a layer pass every fibre, one after the other: under a uniform curvature half a turn of
    one of them, from the outermost fibre to the innermost, which do not slip, is all there is.
    """
    section = settings.section
    curvature, tension = settings.path("load"), settings.path("tension_load")
    below, above = section.line_pressures(tension)
    bounds = settings.friction * (below + above)
    if settings.tension_load == "steady":
        bounds = bounds[:, :1]
    wires = [
        _wire(settings, layer, number, bounds[layer], curvature, tension)
        for layer, own in enumerate(section.layers)
        for number in range(own.wires if settings.is_clamped else 1)
    ]
    return Rope(
        wires=wires,
        substructures=settings.substructures,
        tension=tension,
        curvature=curvature,
        is_clamped=settings.is_clamped,
        section=section,
        instants=settings.times(),
        duration=settings.duration,
        friction_law=settings.law(),
    )


def _wire(
    settings: RopeSettings,
    layer: int,
    number: int,
    bound: Array,
    curvature: Array,
    tension: Array,
) -> RopeWire:
    section, helix = settings.section, settings.section.helix(layer, number)
    own, share = section.layers[layer], np.ones(settings.elements + 1)
    length = helix.half_pitch
    if settings.is_clamped:
        length = settings.length / float(np.cos(helix.lay))
        share = np.exp(-np.linspace(0.0, settings.length, len(share)) / settings.falls_off())
    return RopeWire(
        layer=layer,
        number=number,
        helix=helix,
        diameter=own.diameter,
        length=length,
        bound=bound,
        curvature=np.outer(share, curvature),
        tension=section.wire_tension(layer, tension),
        stands_for=1 if settings.is_clamped else own.wires,
    )


def bent_strand(settings: RopeSettings) -> BentStrand | None:
    """Solve it without a mesh: bent alike all along, under a tension that stays."""
    tension = settings.path("tension_load")
    is_known = not settings.is_clamped and settings.friction_law == "coulomb"
    if not is_known or np.ptp(tension) or not tension[0] or not settings.friction:
        return None
    return BentStrand(settings.section, settings.friction, float(tension[0]))


def _exact(
    settings: RopeSettings, _problem: Problem, _found: LoopFields | None
) -> Iterator[ExactCurve]:
    """Give the moment over the curvature."""
    strand = bent_strand(settings)
    if strand is not None:
        curvature = settings.path("load")
        yield ExactCurve("loop", curvature, strand.along(curvature))


def _words(settings: RopeSettings) -> str:
    bent = acting(settings.path("load"), "bent up", "bent down", "bent up and down")
    where = "near a clamp" if settings.is_clamped else "alike all along"
    tension = "" if settings.tension_load == "steady" else "; its tension changes"
    wires = counted(settings.section.wires)
    return f"A strand of {wires} wires, under tension, is {bent} {where}{tension}."


def _coarser(settings: RopeSettings) -> Iterator[Problem]:
    scene = rope(settings).coarser()
    while scene is not None:
        yield scene.discretise()
        scene = scene.coarser()


ROPE = Entry(
    title="Spiral strand, bent",
    source="closed form: slip spreads from the neutral axis (Papailiou 1997)",
    emblem=Emblem(
        ground="M5 3V29",
        body="M5 8C18 8 28 9 42 14L40 24C28 19 18 18 5 18ZM11 8L15 18M18 8L22 19M25 9L29 20"
        "M32 11L35 22",
        load="M44 28C46 24 46 20 45 16M41 19L45 15L48 19",
    ),
    settings=RopeSettings,
    kind="helices",
    structure=rope,
    words=_words,
    sizes={**shared.ROD_SIZES, "layers": (1, 2, 3, 4, 5)},
    grows=("layers",),
    coarser=_coarser,
    exact=_exact,
)
