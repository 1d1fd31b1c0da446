"""Stiff and extreme cases of the scenes in the plane, and what is expected of each."""

from __future__ import annotations

from solver.study.stability.case import (
    MUST_REFUSE,
    RIGHT,
    UNCLEAR,
    UNSOLVED,
    Case,
    cases_with,
    reversals,
)

BLOCK = {
    "elements": 16,
    "elements_up": 8,
    "substructures": 4,
    "substructures_up": 2,
    "instants": 21,
    "max_iterations": 600,
}
LAYERS = {
    "elements": 24,
    "elements_up": 2,
    "substructures": 3,
    "substructures_up": 1,
    "layers": 3,
    "instants": 17,
    "max_iterations": 600,
}
FORCE = {"bending": "force", "force": 1e4}
LEAVES = {**FORCE, "layer_lengths": "graduated"}
STEPPED = ((1.0, 0.04), (2.0, 1.0), (3.0, 0.5))
PRESSED = {
    "gap": "flat",
    "top": "traction",
    "top_normal_traction": -1e8,
    "top_tangential_traction": 2e7,
}
"""Held by contact alone: pressed from above, then sheared by two thirds of what friction holds."""
TILTED = {**PRESSED, "top_tangential_traction": 0.0, "top_normal_slope": 2.0}
GENERAL = {"friction_law": "general"}
SOFT = {**GENERAL, "tangential_stiffness": 1e9, "normal_stiffness": 1e10}
STIFF = {**GENERAL, "tangential_stiffness": 1e18, "normal_stiffness": 1e18}
COHESIVE = {**GENERAL, "friction": 0.0, "cohesion": 5e5}
SOFTENING = {
    **GENERAL,
    "tangential_stiffness": 1e13,
    "strength": ((0.0, 1.0), (1e-6, 1.2), (1e-5, 0.6)),
}
FAULT = {
    "elements": 24,
    "elements_up": 12,
    "substructures": 4,
    "substructures_up": 2,
    "instants": 31,
    "max_iterations": 1000,
}
INCLINE = {
    "elements": 16,
    "elements_up": 8,
    "instants": 41,
    "max_iterations": 1000,
}
WALL = {
    "bricks": 4,
    "courses": 4,
    "elements": 4,
    "elements_up": 2,
    "displacement": 5e-5,
    "instants": 21,
    "max_iterations": 1000,
}


def block_cases() -> list[Case]:
    """All cases of the scene `block`."""
    case = cases_with("block", BLOCK)
    jump = [[0.0, 0.0], [0.5, 0.0], [0.55, -4e-5], [1.0, -4e-5]]
    return [
        case("block", "as it is", {}, quick=True),
        case("poisson", "0.4999", {"poisson": 0.4999}, UNSOLVED),
        case(
            "poisson",
            "0.4999, biquadratic",
            {"poisson": 0.4999, "interpolation": "biquadratic", "elements": 12, "elements_up": 6},
            UNSOLVED,
        ),
        *(
            case("friction", f"{mu:g}", {"friction": mu}, UNCLEAR if mu >= 3.0 else RIGHT, mu == 10)
            for mu in (0.0, 1.0, 3.0, 10.0)
        ),
        case("friction", "10, held by contact alone", {**PRESSED, "friction": 10.0}, UNCLEAR),
        case("height / length", "0.001", {"height": 1e-4, "elements_up": 2}, UNSOLVED),
        case("height / length", "100", {"height": 10.0, "elements_up": 32}, UNSOLVED),
        case("young", "1", {"young": 1.0}),
        case("young", "1e18", {"young": 1e18}),
        *(
            case("k_scale", f"{scale:g}", {"k_scale": scale}, UNSOLVED, scale == 1e-3)
            for scale in (1e-3, 1e-1, 10.0, 1e3)
        ),
        case("instants", "1", {"instants": 1}),
        case("instants", "2", {"instants": 2}),
        case("substructures", "1 x 1", {"substructures": 1, "substructures_up": 1}),
        case("substructures", "as many as elements", {"substructures": 16, "substructures_up": 8}),
        case("gap", "flat", {"gap": "flat"}),
        case("gap", "never closes", {"gap": [[0.0, 1.0]]}, quick=True),
        case("load", "zero", {"top_normal_displacement": 0.0, "top_tangential_displacement": 0.0}),
        case("load", "held by contact alone", PRESSED, UNSOLVED, quick=True),
        case("load", "tilts until it lifts off", TILTED, UNSOLVED),
        case(
            "load",
            "turns at every instant",
            {"top_tangential_load": reversals(21, 2e-5)},
        ),
        case("load", "one jump", {"top_normal_load": jump}),
        case("friction law", "soft springs", SOFT),
        case("friction law", "stiff springs", STIFF, UNSOLVED),
        case("friction law", "cohesion alone", {**COHESIVE, "gap": "flat"}, quick=True),
        case("friction law", "cap", {**GENERAL, "friction_cap": 2e7}),
        case("friction law", "softening on a spring", {**SOFTENING, "gap": "flat"}, quick=True),
        case("friction law", "held by cohesion alone", {**PRESSED, **COHESIVE, "cohesion": 3e7}),
        case("friction along it", "rising", {"friction_profile": "rising"}),
        case("friction along it", "none in the middle", {"friction_profile": "gap"}),
        case("refused", "pushed beyond friction", {**PRESSED, "friction": 0.1}, MUST_REFUSE, True),
        case("refused", "lifted", {**PRESSED, "top_normal_traction": 1e8}, MUST_REFUSE),
        case("refused", "tipped over", {**PRESSED, "top_normal_slope": 4.0}, MUST_REFUSE),
    ]


def layers_cases() -> list[Case]:
    """All cases of the scene `layers`."""
    case = cases_with("layers", LAYERS)
    moment = {"bending": "moment", "moment": 1e3}
    return [
        case("layers", "as it is", {}, UNSOLVED, quick=True),
        case("contrast", "1e6", {"contrast": 1e6}, UNSOLVED, quick=True),
        case("contrast", "1e-6", {"contrast": 1e-6}, UNSOLVED),
        case("friction", "0", {"friction": 0.0}, UNSOLVED),
        case("friction", "10", {"friction": 10.0}, UNCLEAR),
        case("friction", "none above 10", {"friction_factors": ((1.0, 33.0), (2.0, 0.0))}, UNCLEAR),
        case("thickness / length", "0.001", {"thickness": 5e-4}, UNSOLVED),
        case("number", "2", {"layers": 2}),
        case("number", "20", {"layers": 20, "elements": 12, "instants": 9}, UNSOLVED),
        case("load", "moment", moment, UNSOLVED),
        case("load", "force at the end", FORCE, UNSOLVED),
        case("lengths", "leaves that are pressed", LEAVES, UNSOLVED, quick=True),
        case("lengths", "leaves that come apart", {**LEAVES, "pressure": 0.0}, UNSOLVED),
        case("lengths", "one element beside all", {**FORCE, "layer_lengths": STEPPED}, UNSOLVED),
        case("load", "no pressure", {"pressure": 0.0}, UNSOLVED),
        case("young", "1", {"young": 1.0, "pressure": 1e-5}, UNSOLVED),
        case("young", "1e18", {"young": 1e18, "pressure": 1e13}, UNSOLVED),
        case("substructures", "1", {"substructures": 1}, UNSOLVED),
        case("friction law", "soft springs", SOFT, UNSOLVED),
        case("friction law", "stiff springs", STIFF, UNSOLVED),
        case("friction law", "cohesion alone", COHESIVE, UNSOLVED),
        case("friction law", "cap", {**GENERAL, "friction_cap": 3e5}, UNSOLVED),
        case("friction law", "softening on a spring", SOFTENING, UNSOLVED),
        case("instants", "1", {"instants": 1, "bend_load": "ramp"}, UNSOLVED),
    ]


def incline_cases() -> list[Case]:
    """All cases of the scene `incline`."""
    case = cases_with("incline", INCLINE)
    return [
        case("incline", "as it is", {}, quick=True),
        case("incline", "never slides", {"slope": 10.0}),
        case("incline", "friction 0", {"friction": 0.0}),
        case("incline", "no slack", {"slack": 0.0}),
        case("incline", "slack of a tenth of its length", {"slack": 1e-2}),
        case("incline", "spring a thousand times softer", {"spring": 2e3}, UNSOLVED),
        case("incline", "spring a million times stiffer", {"spring": 2e12}),
        case("incline", "steel", {"young": 210e9}, UNSOLVED),
        case("incline", "rises and falls twice", {"slope_load": "sine"}),
        case("incline", "instants 1", {"instants": 1, "slope_load": "ramp"}),
        case("incline", "weight 0", {"weight": 0.0}),
        case("incline", "tips over", {"height": 0.15}, MUST_REFUSE, quick=True),
    ]


def fault_cases() -> list[Case]:
    """All cases of the scene `fault`."""
    case = cases_with("fault", FAULT)
    return [
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
    ]


def wall_cases() -> list[Case]:
    """All cases of the scene `wall`: what is pressed and moved scales with E, as what gives way."""
    case = cases_with("wall", WALL)
    pulled = {"top": "pulled", "traction": 3e5}
    loose = {"top": "pulled", "traction": 0.0, "pressure": 0.0}
    return [
        case("wall", "as it is", {}, quick=True),
        case("bricks", "1", {"bricks": 1, "courses": 1}),
        case("bricks", "one course", {"courses": 1}),
        case("bricks", "one column", {"bricks": 1, "bond": "stack"}),
        case("bricks", "stack bond", {"bond": "stack"}),
        case("bricks", "12 x 12", {"bricks": 12, "courses": 12, "instants": 11}, UNSOLVED),
        case("young", "1", {"young": 1.0, "pressure": 1e-4, "unit_weight": 2e-6}),
        case("young", "1e17", {"young": 1e17, "pressure": 1e13, "unit_weight": 2e11}),
        case("young", "1e12, pressed as before", {"young": 1e12, "displacement": 5e-7}),
        case("young", "1e8, pressed as before", {"young": 1e8, "displacement": 5e-3}),
        case("weight", "none", {"unit_weight": 0.0}),
        case("weight", "a hundred times", {"unit_weight": 2e6}),
        case("weight", "alone", {"pressure": 0.0, "displacement": 5e-7}, UNSOLVED),
        case("friction", "0", {"friction": 0.0}, UNSOLVED),
        case("friction", "3", {"friction": 3.0}, UNCLEAR),
        case("friction", "10", {"friction": 10.0}, UNCLEAR),
        case("ground", "tilted by 20 degrees", {"slope": 20.0}),
        case("height / length", "0.01", {"height": 2.5e-3}, UNSOLVED),
        case("height / length", "4", {"height": 1.0}, UNSOLVED),
        case("k_scale", "0.01", {"k_scale": 1e-2}, UNSOLVED),
        case("k_scale", "100", {"k_scale": 1e2}, UNSOLVED),
        case("coarse problem", "none", {"multiscale": False}, UNSOLVED),
        case("top", "pulled by half of what friction holds", pulled, quick=True),
        case("top", "moved by 0.1 mm, a tenth is open", {"displacement": 1e-4}, UNSOLVED),
        case("top", "moved by 0.3 mm, bricks hang", {"displacement": 3e-4}, UNCLEAR),
        case("instants", "1", {"instants": 1, "top_load": "ramp"}),
        case("top", "pulled beyond friction", {**pulled, "traction": 7e5}, UNSOLVED),
        case("ground", "tilted beyond friction", {**loose, "slope": 45.0}, UNSOLVED),
    ]
