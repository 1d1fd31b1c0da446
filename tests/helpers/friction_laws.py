"""Friction laws by the settings of scenes."""

from __future__ import annotations

from typing import Any

LAWS: dict[str, dict[str, Any]] = {
    "coulomb": {},
    "compliant": {"friction_law": "compliant"},
    "hardening": {"friction_law": "slip-dependent", "friction_ratio": 1.4},
    "softening": {"friction_law": "slip-dependent", "friction_ratio": 0.9},
}
"""Beside the general law, whose units are those of a scene."""
GENERAL: dict[str, dict[str, Any]] = {
    "rod": {"tangential_stiffness": 1e7, "cohesion": 300.0, "friction_cap": 1700.0},
    "plane": {"tangential_stiffness": 1e13, "cohesion": 1e4, "friction_cap": 1e8},
}


def law_of(kind: str, name: str) -> dict[str, Any]:
    if name == "general":
        return {"friction_law": "general", **GENERAL[kind]}
    return LAWS[name]
