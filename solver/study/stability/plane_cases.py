"""Stiff and extreme cases of the scenes in the plane, and what is expected of each."""

from __future__ import annotations

from solver.study.stability.stability_case import (
    GENERAL,
    MUST_REFUSE,
    UNCLEAR,
    UNSOLVED,
    StabilityCase,
    cases_with,
    reversals,
)

SOFT = {**GENERAL, "tangential_stiffness": 1e9, "normal_stiffness": 1e10}
STIFF = {**GENERAL, "tangential_stiffness": 1e18, "normal_stiffness": 1e18}
COHESIVE = {**GENERAL, "friction": 0.0, "cohesion": 5e5}
SOFTENING = {
    **{**GENERAL, "tangential_stiffness": 1e13},
    "strength": ((0.0, 1.0), (1e-6, 1.2), (1e-5, 0.6)),
}
PRESSED = {
    **{"gap": "flat", "top": "traction"},
    **{"top_normal_traction": -1e8, "top_tangential_traction": 2e7},
}
"""Held by contact alone: pressed from above, then sheared by two thirds of what friction holds."""


def plane_cases() -> list[StabilityCase]:
    """All of them."""
    return [*fault_cases(), *block_cases(), *layers_cases(), *incline_cases(), *wall_cases()]


def block_cases() -> list[StabilityCase]:
    """All cases of the scene `block`."""
    common = {
        **{"elements": 16, "elements_up": 8, "substructures": 4, "substructures_up": 2},
        **{"instants": 21, "max_iterations": 600},
    }
    case, unsolved = cases_with("block", common), cases_with("block", common, UNSOLVED)
    fine = {"interpolation": "biquadratic", "elements": 12, "elements_up": 6}
    at_rest = {"top_normal_displacement": 0.0, "top_tangential_displacement": 0.0}
    jump = [[0.0, 0.0], [0.5, 0.0], [0.55, -4e-5], [1.0, -4e-5]]
    tilted = {**PRESSED, "top_tangential_traction": 0.0, "top_normal_slope": 2.0}
    return [
        case("as it is", quick=True),
        unsolved(poisson=0.4999),
        unsolved("poisson=0.4999, biquadratic", poisson=0.4999, **fine),
        case(friction=0.0),
        case(friction=1.0),
        case(friction=3.0, expected=UNCLEAR),
        case(friction=10.0, expected=UNCLEAR, quick=True),
        case("friction 10, held by contact alone", UNCLEAR, friction=10.0, **PRESSED),
        unsolved("height / length 0.001", height=1e-4, elements_up=2),
        unsolved("height / length 100", height=10.0, elements_up=32),
        case(young=1.0),
        case(young=1e18),
        *(unsolved(k_scale=scale, quick=scale == 1e-3) for scale in (1e-3, 1e-1, 10.0, 1e3)),
        case(instants=1),
        case(instants=2),
        case("one substructure", substructures=1, substructures_up=1),
        case("substructures as many as elements", substructures=16, substructures_up=8),
        case(gap="flat"),
        case("gap never closes", quick=True, gap=[[0.0, 1.0]]),
        case("load zero", **at_rest),
        unsolved("held by contact alone", quick=True, **PRESSED),
        unsolved("load tilts until it lifts off", **tilted),
        case("load turns at every instant", top_tangential_load=reversals(21, 2e-5)),
        case("load one jump", top_normal_load=jump),
        case("soft springs", **SOFT),
        unsolved("stiff springs", **STIFF),
        case("cohesion alone", quick=True, gap="flat", **COHESIVE),
        case("cap on friction", friction_cap=2e7, **GENERAL),
        case("softening on a spring", quick=True, gap="flat", **SOFTENING),
        case("held by cohesion alone", **{**PRESSED, **COHESIVE, "cohesion": 3e7}),
        case(friction_profile="rising"),
        case("no friction in the middle", friction_profile="gap"),
        case("pushed beyond friction", MUST_REFUSE, quick=True, friction=0.1, **PRESSED),
        case("lifted", MUST_REFUSE, **{**PRESSED, "top_normal_traction": 1e8}),
        case("tipped over", MUST_REFUSE, **{**PRESSED, "top_normal_slope": 4.0}),
    ]


def layers_cases() -> list[StabilityCase]:
    """All cases of the scene `layers`."""
    common = {
        **{"elements": 24, "elements_up": 2, "substructures": 3, "substructures_up": 1},
        **{"layers": 3, "instants": 17, "max_iterations": 600},
    }
    case, unsolved = cases_with("layers", common), cases_with("layers", common, UNSOLVED)
    force = {"bending": "force", "force": 1e4}
    leaves = {**force, "layer_lengths": "graduated"}
    one_element = {**force, "layer_lengths": ((1.0, 0.04), (2.0, 1.0), (3.0, 0.5))}
    greased = ((1.0, 33.0), (2.0, 0.0))
    return [
        unsolved("as it is", quick=True),
        unsolved(contrast=1e6, quick=True),
        unsolved(contrast=1e-6),
        unsolved(friction=0.0),
        case(friction=10.0, expected=UNCLEAR),
        case("friction 10, and none above", UNCLEAR, friction_factors=greased),
        unsolved("thickness / length 0.001", thickness=5e-4),
        case(layers=2),
        unsolved(layers=20, elements=12, instants=9),
        unsolved(bending="moment", moment=1e3),
        unsolved(**force),
        unsolved("leaves that are pressed", quick=True, **leaves),
        unsolved("leaves that come apart", pressure=0.0, **leaves),
        unsolved("a leaf of one element", **one_element),
        unsolved(pressure=0.0),
        unsolved(young=1.0, pressure=1e-5),
        unsolved(young=1e18, pressure=1e13),
        unsolved(substructures=1),
        unsolved("soft springs", **SOFT),
        unsolved("stiff springs", **STIFF),
        unsolved("cohesion alone", **COHESIVE),
        unsolved("cap on friction", friction_cap=3e5, **GENERAL),
        unsolved("softening on a spring", **SOFTENING),
        unsolved(instants=1, bend_load="ramp"),
    ]


def incline_cases() -> list[StabilityCase]:
    """All cases of the scene `incline`."""
    common = {"elements": 16, "elements_up": 8, "instants": 41, "max_iterations": 1000}
    case, unsolved = cases_with("incline", common), cases_with("incline", common, UNSOLVED)
    return [
        case("as it is", quick=True),
        case("never slides", slope=10.0),
        case(friction=0.0),
        case(slack=0.0),
        case("slack of a tenth of its length", slack=1e-2),
        unsolved("spring a thousand times softer", spring=2e3),
        case("spring a million times stiffer", spring=2e12),
        unsolved("steel", young=210e9),
        case("rises and falls twice", slope_load="sine"),
        case(instants=1, slope_load="ramp"),
        case(weight=0.0),
        case("tips over", MUST_REFUSE, quick=True, height=0.15),
    ]


def fault_cases() -> list[StabilityCase]:
    """All cases of the scene `fault`."""
    common = {
        **{"elements": 24, "elements_up": 12, "substructures": 4, "substructures_up": 2},
        **{"instants": 31, "max_iterations": 1000},
    }
    case = cases_with("fault", common)
    return [
        case("as it is", quick=True),
        case(injection_load="stopped", quick=True),
        case(injection_load="pulses"),
        case("overpressure all of the normal stress", overpressure=1e7),
        case(overpressure=0.0),
        case(diffusivity=1e-15),
        case(diffusivity=1e9),
        case("shear stress 0.999 of the strength", shear_stress=5.994e6),
        case("shear stress twice the strength", shear_stress=1.2e7),
        case("shear stress backward", shear_stress=-3.6e6),
        case(friction=0.0),
        case(friction=10.0, shear_stress=9e7),
        case("barriers of normal stress", normal_profile="barrier", shear_stress=5.9e6),
        case(young=1.0, overpressure=0.0),
        case(instants=1),
    ]


def wall_cases() -> list[StabilityCase]:
    """All cases of the scene `wall`: what is pressed and moved scales with E, as what gives way."""
    common = {
        **{"bricks": 4, "courses": 4, "elements": 4, "elements_up": 2, "displacement": 5e-5},
        **{"instants": 21, "max_iterations": 1000},
    }
    case, unsolved = cases_with("wall", common), cases_with("wall", common, UNSOLVED)
    loose = {"top": "pulled", "traction": 0.0, "pressure": 0.0}
    return [
        case("as it is", quick=True),
        case("one brick", bricks=1, courses=1),
        case("one course", courses=1),
        case("one column", bricks=1, bond="stack"),
        case("an opening", bricks=6, opening=2, opening_height=2),
        case(bond="stack"),
        unsolved("12 x 12 bricks", bricks=12, courses=12, instants=11),
        case("young=1", young=1.0, pressure=1e-4, unit_weight=2e-6),
        case("young=1e17", young=1e17, pressure=1e13, unit_weight=2e11),
        case("young=1e12, pressed as before", young=1e12, displacement=5e-7),
        case("young=1e8, pressed as before", young=1e8, displacement=5e-3),
        case(unit_weight=0.0),
        case(unit_weight=2e6),
        unsolved("weight alone", pressure=0.0, displacement=5e-7),
        unsolved(friction=0.0),
        case(friction=3.0, expected=UNCLEAR),
        case(friction=10.0, expected=UNCLEAR),
        case("ground tilted by 20 degrees", slope=20.0),
        unsolved("height / length 0.01", height=2.5e-3),
        unsolved("height / length 4", height=1.0),
        unsolved(k_scale=1e-2),
        unsolved(k_scale=1e2),
        unsolved(multiscale=False),
        case("pulled by half of what friction holds", quick=True, top="pulled", traction=3e5),
        unsolved("moved by 0.1 mm, a tenth is open", displacement=1e-4),
        case("moved by 0.3 mm, bricks hang", UNCLEAR, displacement=3e-4),
        case(instants=1, top_load="ramp"),
        unsolved("pulled beyond friction", top="pulled", traction=7e5),
        unsolved("ground tilted beyond friction", slope=45.0, **loose),
    ]
