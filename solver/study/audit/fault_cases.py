"""Stiff and extreme cases of the fault driven by a fluid, and what is expected of each."""

from __future__ import annotations

from solver.study.audit.cases import Case, cases_with

SMALL = {
    "elements": 24,
    "elements_up": 12,
    "substructures": 4,
    "substructures_up": 2,
    "instants": 31,
    "max_iterations": 1000,
}


def fault_cases() -> tuple[Case, ...]:
    """Give all cases of the fault."""
    case = cases_with("fault", SMALL)
    return (
        case("fault and fluid", "as it is", {}, quick=True),
        case("fault and fluid", "stopped", {"injection_load": "stopped"}, quick=True),
        case("fault and fluid", "pulses", {"injection_load": "pulses"}),
        case("fault and fluid", "all of the normal stress", {"overpressure": 1e7}),
        case("fault and fluid", "none", {"overpressure": 0.0}),
        case("diffusivity", "1e-15 m^2/s", {"diffusivity": 1e-15}),
        case("diffusivity", "1e9 m^2/s", {"diffusivity": 1e9}),
        case("shear stress", "0.999 of the strength", {"shear_stress": 5.994e6}),
        case("shear stress", "twice the strength", {"shear_stress": 1.2e7}),
        case("shear stress", "backward", {"shear_stress": -3.6e6}),
        case("friction", "0", {"friction": 0.0}),
        case("friction", "10", {"friction": 10.0, "shear_stress": 9e7}),
        case("normal stress", "barriers", {"normal_profile": "barrier", "shear_stress": 5.9e6}),
        case("Young's modulus", "1 Pa", {"young": 1.0, "overpressure": 0.0}),
        case("instants", "1", {"instants": 1}),
    )
