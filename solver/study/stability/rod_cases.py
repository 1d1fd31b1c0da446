"""Stiff and extreme cases of bar, strand and rope, and what is expected of each."""

from __future__ import annotations

import numpy as np

from solver.definitions import Pairs
from solver.study.stability.case import MUST_REFUSE, RIGHT, UNSOLVED, Case, cases_with, reversals

SMALL_BAR = {"elements": 20, "substructures": 4, "instants": 41}
"""A quarter of the work of Table 1."""
STRAND = {"elements": 24, "substructures": 4, "instants": 31, "max_iterations": 1000}
ROPE = {
    **{"layers": 1, "length": 0.3, "tension": 5e4, "elements": 32, "substructures": 8},
    **{"instants": 31, "max_iterations": 1000},
}
OWN_ROPE = (
    *((1.0, 2e-3, 0.0, 1e9), (3.0, 3e-3, 45.0, 2e11), (20.0, 1e-3, -10.0, 7e10)),
    (1.0, 4e-3, 60.0, 1e12),
)
"""A soft core, layers with room beside their wires, and a wire that is wound about them."""
ALIKE = {"bending": "uniform"}
RAMP = {"load": "ramp"}
GENERAL = {"friction_law": "general"}
SOFT = {**GENERAL, "tangential_stiffness": 1e4}
BOND = {
    **GENERAL,
    "tangential_stiffness": 1e8,
    "strength": ((0.0, 1.0), (1e-4, 1.3), (1e-3, 0.6)),
}
FREE = {"left_end": "free", "right_end": "free"}
MOVED = {"left_end": "free", "right_end": "spring", "right_displacement": 0.01}
JUMP: Pairs = ((0.0, 0.0), (0.5, 0.0), (0.51, 900.0), (1.0, 900.0))
PLATEAUS: Pairs = (
    *((0.0, 0.0), (0.2, 800.0), (0.4, 800.0)),
    *((0.6, -400.0), (0.8, -400.0), (1.0, 700.0)),
)
JUMP_WIDTH = 1e-9
"""Share of an element beside its ends, within which a section changes to that of the next."""


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


def bar_cases() -> list[Case]:
    """All cases of the bar."""
    case = cases_with("bar", {})
    k_scales = (1e-6, 1e-4, 1e-2, 1e-1, 10.0, 1e2, 1e4, 1e6)
    profiles = {"load": ((0.0, 1e-3), (1.0, 1e3)), "clamp": ((0.0, 1e3), (1.0, 1e-3))}
    large = {"substructures": 50, "instants": 2, "max_iterations": 150}
    many = {"elements": 4, "substructures": 2, "instants": 20_001, "max_iterations": 120}
    return [
        case("Table 1", "as it is", {}, quick=True),
        *(
            case(
                "k_scale",
                f"{scale:g}",
                {"k_scale": scale, "max_iterations": 600},
                UNSOLVED,
                quick=scale in (1e-6, 1e6),
            )
            for scale in k_scales
        ),
        *(
            case("young", f"{young:g}", {"young": young}, quick=young in (1.0, 1e18))
            for young in (1.0, 1e6, 1e14, 1e18)
        ),
        *(
            case("length", f"{length:g}", {"length": length}, quick=length in (1e-6, 1e4))
            for length in (1e-6, 1e-3, 10.0, 1e4)
        ),
        *(
            case("relaxation", f"{part:g}", {"relaxation": part}, UNSOLVED if part < 0.4 else RIGHT)
            for part in (0.1, 0.3, 0.5, 1.0)
        ),
        *(
            case(
                "stiffness contrast",
                f"{contrast:g} towards the load",
                {**SMALL_BAR, "section_profile": graded(contrast, SMALL_BAR["elements"])},
                UNSOLVED if contrast in (1e4, 1e8, 1e-8) else RIGHT,
                quick=contrast == 1e8,
            )
            for contrast in (1e2, 1e4, 1e8, 1e-4, 1e-8)
        ),
        case("friction", "0", {"friction": 0.0}, quick=True),
        case("friction", "1e-12", {"friction": 1e-12}, UNSOLVED, quick=True),
        case("friction", "1e6", {"friction": 1e6}, quick=True),
        case("pressure", "0", {"pressure": 0.0}, quick=True),
        case("pressure", "1e15 N/m", {"pressure": 1e15}),
        *(
            case(
                "pressure",
                f"1e6 times higher at the {end}",
                {"pressure_profile": profile},
                quick=end == "clamp",
            )
            for end, profile in profiles.items()
        ),
        case("pressure", "gap in the middle", {"pressure_profile": "gap"}),
        case("load", "zero", {"peak": 0.0}, quick=True),
        case("load", "1e-9 N, nothing slides", {"peak": 1e-9}),
        case("load", "4000 N, every point slides", {"peak": 4000.0}, quick=True),
        case("load", "1e15 N", {"peak": 1e15}, UNSOLVED),
        case("load", "turns at every instant", {"load": reversals(101, 900.0)}, quick=True),
        case("load", "one jump", {"load": JUMP}, quick=True),
        case("load", "plateaus", {"load": PLATEAUS}),
        case("load", "moved support", {"support_displacement": 1e-3}),
        case("load", "body force", {"body_force": 1000.0}),
        *(
            case(
                "ends",
                f"{stiffness:g} N/m on the left",
                {"left_end": "spring", "left_spring": stiffness, "peak": 2000.0},
                UNSOLVED,
                quick=stiffness == 1e-3,
            )
            for stiffness in (1e-3, 1e3, 1e9, 5e14)
        ),
        case("ends", "1e18 N/m", {"left_end": "spring", "left_spring": 1e18}, MUST_REFUSE),
        case("ends", "left one free", {"left_end": "free"}, quick=True),
        case("ends", "left one free, almost pulled out", {"left_end": "free", "peak": 1499.0}),
        case("ends", "right one on a spring that is moved", MOVED, quick=True),
        case("heat", "alone, between clamps", {"right_end": "held", "temperature": 40.0}),
        case("heat", "alone, both ends free", {**FREE, "temperature": 40.0}, quick=True),
        case("settlement", "alone, both ends free", {**FREE, "settlement": 1e-3}, quick=True),
        case("settlement", "1e6 m", {"settlement": 1e6}, UNSOLVED),
        *(
            case("substructures", f"{parts} of 50 elements", {"substructures": parts}, UNSOLVED)
            for parts in (1, 2, 5, 25, 50)
        ),
        case(
            *("substructures", "as many as 20 elements"),
            {**SMALL_BAR, "substructures": 20},
            UNSOLVED,
        ),
        case("friction law", "soft spring", SOFT, quick=True),
        case("friction law", "stiff spring", {**GENERAL, "tangential_stiffness": 1e14}),
        case("friction law", "cohesion alone", {**GENERAL, "friction": 0.0, "cohesion": 1500.0}),
        case("friction law", "cap", {**GENERAL, "friction_cap": 1000.0}),
        case("friction law", "peak and softening on a spring", BOND, quick=True),
        case("instants", "1", {**RAMP, "instants": 1}, quick=True),
        case("instants", "2", {**RAMP, "instants": 2}),
        case("instants", "20 001, 4 elements", many, UNSOLVED),
        case("nodes", "2", {"elements": 1, "substructures": 1}, quick=True),
        case("nodes", "3", {"elements": 2, "substructures": 2}),
        case("nodes", "801", {"elements": 800, "instants": 11, "max_iterations": 600}, UNSOLVED),
        case("nodes", "20 001, 2 instants", {"elements": 20_000, **RAMP, **large}, UNSOLVED),
    ]


def strand_cases() -> list[Case]:
    """All cases of the strand."""
    case = cases_with("strand", STRAND)
    return [
        case("strand", "as it is", {}, quick=True),
        case("friction", "0, given displacement", {"friction": 0.0, "grip": "displacement"}),
        case("friction", "1e6", {"friction": 1e6}, UNSOLVED),
        case("wires", "2", {"wires": 2, "broken": 1}, UNSOLVED),
        case("wires", "40", {"wires": 40, "broken": 20, "elements": 12, "instants": 11}, UNSOLVED),
        case("break", "none", {"broken": 0}, quick=True),
        case("break", "at the clamp", {"break_position": 0.0}, UNSOLVED),
        case("break", "at the grip", {"break_position": 1.0, "grip": "displacement"}),
        case("break", "an outer wire", {"broken": 1}, UNSOLVED),
        case("grip", "given displacement", {"grip": "displacement"}),
        case("load", "zero", {"peak": 0.0}),
        case("load", "one jump", {"load": JUMP, "peak": 900.0, "pressure": 9000.0}, UNSOLVED),
        case("refused", "pulled out", {"peak": 2000.0}, MUST_REFUSE, quick=True),
        case("young", "1", {"young": 1.0}),
        case("young", "1e18", {"young": 1e18}),
        case("k_scale", "0.001", {"k_scale": 1e-3}, UNSOLVED),
        case("k_scale", "1000", {"k_scale": 1e3}, UNSOLVED),
        case("substructures", "1", {"substructures": 1}, UNSOLVED),
        case("substructures", "as many as elements", {"substructures": 24}, UNSOLVED),
        case(
            "friction law",
            "cohesion alone, soft",
            {**SOFT, "friction": 0.0, "cohesion": 2e3},
            UNSOLVED,
        ),
        case("instants", "1", {"instants": 1, **RAMP}),
    ]


def rope_cases() -> list[Case]:
    """All cases of the strand of helical wires."""
    case = cases_with("rope", ROPE)
    return [
        case("strand of helical wires", "as it is", {}, quick=True),
        case("strand of helical wires", "bent alike all along", ALIKE, quick=True),
        case("friction", "0", {"friction": 0.0}),
        case("friction", "1e-9", {"friction": 1e-9}, UNSOLVED),
        case("friction", "1e6", {"friction": 1e6}),
        case(
            "friction",
            "none on the core",
            {"layers": 2, "friction_factors": ((1.0, 0.0), (2.0, 1.0))},
            UNSOLVED,
        ),
        case("tension", "0", {"tension": 0.0, "fall_off": 0.2}),
        case("tension", "1e12 N", {"tension": 1e12, "fall_off": 0.2}),
        case("tension", "shaken", {"tension_load": "shaken"}),
        case("load", "zero", {"curvature": 0.0}),
        case("load", "one jump", {"load": JUMP}),
        case("load", "1000 1/m", {"curvature": 1e3}),
        case("fall-off", "1e-4 of the length", {"fall_off": 6e-5}),
        case("fall-off", "a thousand lengths", {"fall_off": 600.0}),
        case(
            "construction", "aluminium on steel", {"construction": "conductor", **ALIKE}, UNSOLVED
        ),
        case("construction", "of one's own", {"construction": OWN_ROPE}, UNSOLVED, quick=True),
        case("construction", "91 wires", {"layers": 5, "instants": 11}),
        case("substructures", "1", {"substructures": 1}, UNSOLVED),
        case("substructures", "as many as elements", {"substructures": 32}),
        case("instants", "1", {"instants": 1, **RAMP}),
    ]
