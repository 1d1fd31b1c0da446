"""Stiff and extreme cases of the strand, and what is expected of each."""

from __future__ import annotations

from solver.study.audit.cases import JUMP, REFUSED, UNSOLVED, Case, cases_with

SMALL = {"elements": 24, "substructures": 4, "instants": 31, "max_iterations": 1000}


def strand_cases() -> tuple[Case, ...]:
    """Give all cases of the strand."""
    case = cases_with("strand", SMALL)
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
        case("refused", "pulled out", {"peak": 2000.0}, REFUSED, quick=True),
        case("young", "1", {"young": 1.0}),
        case("young", "1e18", {"young": 1e18}),
        case("k_scale", "0.001", {"k_scale": 1e-3}, UNSOLVED),
        case("k_scale", "1000", {"k_scale": 1e3}, UNSOLVED),
        case("substructures", "1", {"substructures": 1}, UNSOLVED),
        case("substructures", "as many as elements", {"substructures": 24}, UNSOLVED),
        case("instants", "1", {"instants": 1, "load": "ramp"}),
    )
