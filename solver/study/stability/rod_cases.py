"""Stiff and extreme cases of bar, strand and rope, and what is expected of each."""

from __future__ import annotations

import numpy as np

from solver.definitions import Pairs
from solver.study.stability.stability_case import (
    GENERAL,
    MUST_REFUSE,
    RIGHT,
    UNSOLVED,
    StabilityCase,
    cases_with,
    reversals,
)

RAMP = {"load": "ramp"}
OWN_ROPE = (
    *((1.0, 2e-3, 0.0, 1e9), (3.0, 3e-3, 45.0, 2e11), (20.0, 1e-3, -10.0, 7e10)),
    (1.0, 4e-3, 60.0, 1e12),
)
"""A soft core, layers with room beside their wires, and a wire that is wound about them."""
FREE = {"left_end": "free", "right_end": "free"}
MOVED = {"left_end": "free", "right_end": "spring", "right_displacement": 0.01}
JUMP: Pairs = ((0.0, 0.0), (0.5, 0.0), (0.51, 900.0), (1.0, 900.0))
PLATEAUS: Pairs = (
    *((0.0, 0.0), (0.2, 800.0), (0.4, 800.0)),
    *((0.6, -400.0), (0.8, -400.0), (1.0, 700.0)),
)
SOFT = {**GENERAL, "tangential_stiffness": 1e4}
BOND = {
    **{**GENERAL, "tangential_stiffness": 1e8},
    "strength": ((0.0, 1.0), (1e-4, 1.3), (1e-3, 0.6)),
}
JUMP_WIDTH = 1e-9
"""Share of an element beside its ends, within which a section changes to that of the next."""


def rod_cases() -> list[StabilityCase]:
    """All of them."""
    return [*bar_cases(), *strand_cases(), *rope_cases()]


def bar_cases() -> list[StabilityCase]:
    """All cases of the bar."""
    case, unsolved = cases_with("bar", {}), cases_with("bar", {}, UNSOLVED)
    scales = (1e-6, 1e-4, 1e-2, 1e-1, 10.0, 1e2, 1e4, 1e6)
    small = {"elements": 20, "substructures": 4, "instants": 41}
    to_load, to_clamp = ((0.0, 1e-3), (1.0, 1e3)), ((0.0, 1e3), (1.0, 1e-3))
    few = {"substructures": 2, "max_iterations": 120}
    large = {"substructures": 50, "instants": 2, "max_iterations": 150}
    return [
        case("as it is", quick=True),
        *(unsolved(k_scale=k, max_iterations=600, quick=k in (1e-6, 1e6)) for k in scales),
        *(case(young=young, quick=young in (1.0, 1e18)) for young in (1.0, 1e6, 1e14, 1e18)),
        *(case(length=length, quick=length in (1e-6, 1e4)) for length in (1e-6, 1e-3, 10.0, 1e4)),
        *(unsolved(relaxation=part) for part in (0.1, 0.3)),
        *(case(relaxation=part) for part in (0.5, 1.0)),
        *(
            case(
                f"section {contrast:g} times larger at the load",
                expected=UNSOLVED if contrast in (1e4, 1e8, 1e-8) else RIGHT,
                quick=contrast == 1e8,
                section_profile=graded(contrast, small["elements"]),
                **small,
            )
            for contrast in (1e2, 1e4, 1e8, 1e-4, 1e-8)
        ),
        case(friction=0.0, quick=True),
        unsolved(friction=1e-12, quick=True),
        case(friction=1e6, quick=True),
        case(pressure=0.0, quick=True),
        case(pressure=1e15),
        case("pressure 1e6 times higher at the load", pressure_profile=to_load),
        case("pressure 1e6 times higher at the clamp", quick=True, pressure_profile=to_clamp),
        case("pressure gap in the middle", pressure_profile="gap"),
        case("load zero", quick=True, peak=0.0),
        case("load 1e-9 N, nothing slides", peak=1e-9),
        case("load 4000 N, every point slides", quick=True, peak=4000.0),
        unsolved("load 1e15 N", peak=1e15),
        case("load turns at every instant", quick=True, load=reversals(101, 900.0)),
        case("load one jump", quick=True, load=JUMP),
        case("load plateaus", load=PLATEAUS),
        case("load moved support", support_displacement=1e-3),
        case("load body force", body_force=1000.0),
        *end_cases(),
        *(unsolved(substructures=parts) for parts in (1, 2, 5, 25, 50)),
        unsolved("substructures as many as 20 elements", **{**small, "substructures": 20}),
        case("soft friction spring", quick=True, **SOFT),
        case("stiff friction spring", tangential_stiffness=1e14, **GENERAL),
        case("cohesion alone", friction=0.0, cohesion=1500.0, **GENERAL),
        case("cap on friction", friction_cap=1000.0, **GENERAL),
        case("peak and softening on a spring", quick=True, **BOND),
        case("instants 1", quick=True, instants=1, **RAMP),
        case("instants 2", instants=2, **RAMP),
        unsolved("instants 20 001", elements=4, instants=20_001, **few),
        case("nodes 2", quick=True, elements=1, substructures=1),
        case("nodes 3", elements=2, substructures=2),
        unsolved("nodes 801", elements=800, instants=11, max_iterations=600),
        unsolved("nodes 20 001, 2 instants", elements=20_000, **RAMP, **large),
    ]


def end_cases() -> list[StabilityCase]:
    """Cases of the bar's ends, of heat, and of a support that moves."""
    case, unsolved = cases_with("bar", {}), cases_with("bar", {}, UNSOLVED)
    return [
        *(
            unsolved(left_spring=stiffness, left_end="spring", peak=2000.0)
            for stiffness in (1e-3, 1e3, 1e9, 5e14)
        ),
        case("left spring 1e18 N/m", MUST_REFUSE, left_end="spring", left_spring=1e18),
        case("left end free", quick=True, left_end="free"),
        case("left end free, almost pulled out", left_end="free", peak=1499.0),
        case("right end on a spring that is moved", quick=True, **MOVED),
        case("heat alone, between clamps", right_end="held", temperature=40.0),
        case("heat alone, both ends free", quick=True, temperature=40.0, **FREE),
        case("settlement alone, both ends free", quick=True, settlement=1e-3, **FREE),
        unsolved("settlement 1e6 m", settlement=1e6),
    ]


def strand_cases() -> list[StabilityCase]:
    """All cases of the strand."""
    common = {"elements": 24, "substructures": 4, "instants": 31, "max_iterations": 1000}
    case, unsolved = cases_with("strand", common), cases_with("strand", common, UNSOLVED)
    return [
        case("as it is", quick=True),
        case("friction 0, given displacement", friction=0.0, grip="displacement"),
        unsolved(friction=1e6),
        unsolved("wires 2", wires=2, broken=1),
        unsolved("wires 40", wires=40, broken=20, elements=12, instants=11),
        case("no break", quick=True, broken=0),
        unsolved("break at the clamp", break_position=0.0),
        case("break at the grip", break_position=1.0, grip="displacement"),
        unsolved("break of an outer wire", broken=1),
        case(grip="displacement"),
        unsolved("friction on one side", friction_factors=((1.0, 2.0), (2.0, 0.0))),
        case("load zero", peak=0.0),
        unsolved("load one jump", load=JUMP, peak=900.0, pressure=9000.0),
        case("pulled out", MUST_REFUSE, quick=True, peak=2000.0),
        case(young=1.0),
        case(young=1e18),
        unsolved(k_scale=1e-3),
        unsolved(k_scale=1e3),
        unsolved(substructures=1),
        unsolved("substructures as many as elements", substructures=24),
        unsolved("cohesion alone, soft", friction=0.0, cohesion=2e3, **SOFT),
        case("instants 1", instants=1, **RAMP),
    ]


def rope_cases() -> list[StabilityCase]:
    """All cases of the strand of helical wires."""
    common = {
        **{"layers": 1, "length": 0.3, "tension": 5e4, "elements": 32, "substructures": 8},
        **{"instants": 31, "max_iterations": 1000},
    }
    case, unsolved = cases_with("rope", common), cases_with("rope", common, UNSOLVED)
    return [
        case("as it is", quick=True),
        case("bent alike all along", quick=True, bending="uniform"),
        case(friction=0.0),
        unsolved(friction=1e-9),
        case(friction=1e6),
        unsolved("none on the core", layers=2, friction_factors=((1.0, 0.0), (2.0, 1.0))),
        case(tension=0.0, fall_off=0.2),
        case(tension=1e12, fall_off=0.2),
        case("tension shaken", tension_load="shaken"),
        case("load zero", curvature=0.0),
        case("load one jump", load=JUMP),
        case(curvature=1e3),
        case("bent within 1e-4 of the length", fall_off=6e-5),
        case("bent within a thousand lengths", fall_off=600.0),
        unsolved("aluminium on steel", construction="conductor", bending="uniform"),
        unsolved("a rope of one's own", quick=True, construction=OWN_ROPE),
        case("91 wires", layers=5, instants=11),
        unsolved(substructures=1),
        case("substructures as many as elements", substructures=32),
        case("instants 1", instants=1, **RAMP),
    ]


def graded(contrast: float, elements: int) -> Pairs:
    """A section that grows by equal factors from element to element of a bar of 1 m.

    The contrast is last over first section; their geometric mean stays what it was.
    """
    factors = contrast ** np.linspace(-0.5, 0.5, elements)
    return tuple(
        ((i + end) / elements, float(factor))
        for i, factor in enumerate(factors)
        for end in (JUMP_WIDTH, 1.0 - JUMP_WIDTH)
    )
