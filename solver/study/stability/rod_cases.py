"""Stiff and extreme cases of bar, strand and rope, and what is expected of each."""

from __future__ import annotations

from solver.study.stability.case import (
    JUMP,
    MUST_REFUSE,
    PLATEAUS,
    RIGHT,
    UNSOLVED,
    Case,
    cases_with,
    graded,
    reversals,
)

SMALL_BAR = {"elements": 20, "substructures": 4, "instants": 41}
"""A quarter of the work of Table 1."""
QUICK = {"k_scale": (1e-6, 1e6), "young": (1.0, 1e18), "length": (1e-6, 1e4)}


def bar_cases() -> tuple[Case, ...]:
    """All cases of the bar."""
    return (
        Case("Table 1", "as it is", quick=True),
        *_ranges(),
        *_contact(),
        *_loads(),
        *_sizes(),
    )


def _ranges() -> list[Case]:
    steps = {
        "k_scale": (1e-6, 1e-4, 1e-2, 1e-1, 10.0, 1e2, 1e4, 1e6),
        "young": (1.0, 1e6, 1e14, 1e18),
        "length": (1e-6, 1e-3, 10.0, 1e4),
        "relaxation": (0.1, 0.3, 0.5, 1.0),
    }
    slow = {"k_scale": (0.0, 1e9), "relaxation": (0.0, 0.4)}
    cases = [
        Case(
            name,
            f"{value:g}",
            {name: value, **({"max_iterations": 600} if name == "k_scale" else {})},
            UNSOLVED
            if slow.get(name, (0.0, 0.0))[0] < value < slow.get(name, (0.0, 0.0))[1]
            else RIGHT,
            quick=value in QUICK.get(name, ()),
        )
        for name, values in steps.items()
        for value in values
    ]
    contrasts = (1e2, 1e4, 1e8, 1e-4, 1e-8)
    cases += [
        Case(
            "stiffness contrast",
            f"{value:g} towards the load",
            {**SMALL_BAR, "section_profile": graded(value, SMALL_BAR["elements"])},
            UNSOLVED if value in (1e4, 1e8, 1e-8) else RIGHT,
            quick=value == 1e8,
        )
        for value in contrasts
    ]
    return cases


def _contact() -> list[Case]:
    return [
        Case("friction", "0", {"friction": 0.0}, quick=True),
        Case("friction", "1e-12", {"friction": 1e-12}, UNSOLVED, quick=True),
        Case("friction", "1e6", {"friction": 1e6}, quick=True),
        Case("pressure", "0", {"pressure": 0.0}, quick=True),
        Case("pressure", "1e15 N/m", {"pressure": 1e15}),
        Case(
            "pressure",
            "1e6 times higher at the load",
            {"pressure_profile": [[0.0, 1e-3], [1.0, 1e3]]},
        ),
        Case(
            "pressure",
            "1e6 times higher at the clamp",
            {"pressure_profile": [[0.0, 1e3], [1.0, 1e-3]]},
            quick=True,
        ),
        Case("pressure", "gap in the middle", {"pressure_profile": "gap"}),
    ]


def _loads() -> list[Case]:
    return [
        Case("load", "zero", {"peak": 0.0}, quick=True),
        Case("load", "1e-9 N, nothing slides", {"peak": 1e-9}),
        Case("load", "4000 N, every point slides", {"peak": 4000.0}, quick=True),
        Case("load", "1e15 N", {"peak": 1e15}, UNSOLVED),
        Case("load", "turns at every instant", {"load": reversals(101, 900.0)}, quick=True),
        Case("load", "one jump", {"load": JUMP}, quick=True),
        Case("load", "plateaus", {"load": PLATEAUS}),
        Case("load", "moved support", {"support_displacement": 1e-3}),
        Case("load", "body force", {"body_force": 1000.0}),
    ]


def _sizes() -> list[Case]:
    parts = (1, 2, 5, 25, 50)
    cases = [
        Case("substructures", f"{number} of 50 elements", {"substructures": number}, UNSOLVED)
        for number in parts
    ]
    cases += [
        Case(
            "substructures", "as many as 20 elements", {**SMALL_BAR, "substructures": 20}, UNSOLVED
        ),
        Case("instants", "1", {"load": "ramp", "instants": 1}, quick=True),
        Case("instants", "2", {"load": "ramp", "instants": 2}),
        Case(
            "instants",
            "20 001, 4 elements",
            {"elements": 4, "substructures": 2, "instants": 20_001, "max_iterations": 120},
            UNSOLVED,
        ),
        Case("nodes", "2", {"elements": 1, "substructures": 1}, quick=True),
        Case("nodes", "3", {"elements": 2, "substructures": 2}),
        Case("nodes", "801", {"elements": 800, "instants": 11, "max_iterations": 600}, UNSOLVED),
        Case(
            "nodes",
            "20 001, 2 instants",
            {
                "elements": 20_000,
                "substructures": 50,
                "load": "ramp",
                "instants": 2,
                "max_iterations": 150,
            },
            UNSOLVED,
        ),
    ]
    return cases


STRAND = {"elements": 24, "substructures": 4, "instants": 31, "max_iterations": 1000}


def strand_cases() -> tuple[Case, ...]:
    """All cases of the strand."""
    case = cases_with("strand", STRAND)
    return (
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
        case("instants", "1", {"instants": 1, "load": "ramp"}),
    )


ROPE = {
    "layers": 1,
    "length": 0.3,
    "tension": 5e4,
    "elements": 32,
    "substructures": 8,
    "instants": 31,
    "max_iterations": 1000,
}
ALIKE = {"bending": "uniform"}


def rope_cases() -> tuple[Case, ...]:
    """All cases of the strand of helical wires."""
    case = cases_with("rope", ROPE)
    return (
        case("strand of helical wires", "as it is", {}, quick=True),
        case("strand of helical wires", "bent alike all along", ALIKE, quick=True),
        case("friction", "0", {"friction": 0.0}),
        case("friction", "1e-9", {"friction": 1e-9}, UNSOLVED),
        case("friction", "1e6", {"friction": 1e6}),
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
        case("construction", "91 wires", {"layers": 5, "instants": 11}),
        case("substructures", "1", {"substructures": 1}, UNSOLVED),
        case("substructures", "as many as elements", {"substructures": 32}),
        case("instants", "1", {"instants": 1, "load": "ramp"}),
    )
