"""Stiff and extreme cases of the strand of helical wires, and what is expected of each."""

from __future__ import annotations

from solver.study.audit.cases import JUMP, UNSOLVED, Case, cases_with

SMALL = {
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
    """Give all cases of the strand of helical wires."""
    case = cases_with("rope", SMALL)
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
