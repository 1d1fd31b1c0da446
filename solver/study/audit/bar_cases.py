"""Stiff and extreme cases of the friction bar, and what is expected of each."""

from __future__ import annotations

from solver.study.audit.cases import JUMP, PLATEAUS, RIGHT, UNSOLVED, Case, graded, reversals

SMALL = {"elements": 20, "substructures": 4, "instants": 41}
"""A quarter of the work of Table 1."""
QUICK = {"k_scale": (1e-6, 1e6), "young": (1.0, 1e18), "length": (1e-6, 1e4)}


def bar_cases() -> tuple[Case, ...]:
    """Give all cases of the bar."""
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
    found = [
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
    found += [
        Case(
            "stiffness contrast",
            f"{value:g} towards the load",
            {**SMALL, "section_profile": graded(value, SMALL["elements"])},
            UNSOLVED if value in (1e4, 1e8, 1e-8) else RIGHT,
            quick=value == 1e8,
        )
        for value in contrasts
    ]
    return found


def _contact() -> list[Case]:
    def falling(first: float, last: float) -> dict[str, object]:
        return {"pressure_profile": [[0.0, first], [1.0, last]]}

    return [
        Case("friction", "0", {"friction": 0.0}, quick=True),
        Case("friction", "1e-12", {"friction": 1e-12}, UNSOLVED, quick=True),
        Case("friction", "1e6", {"friction": 1e6}, quick=True),
        Case("pressure", "0", {"pressure": 0.0}, quick=True),
        Case("pressure", "1e15 N/m", {"pressure": 1e15}),
        Case("pressure", "1e6 times higher at the load", falling(1e-3, 1e3)),
        Case("pressure", "1e6 times higher at the clamp", falling(1e3, 1e-3), quick=True),
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
    found = [
        Case("substructures", f"{number} of 50 elements", {"substructures": number}, UNSOLVED)
        for number in parts
    ]
    found += [
        Case("substructures", "as many as 20 elements", {**SMALL, "substructures": 20}, UNSOLVED),
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
    return found
