"""Settings of every scene with which a run takes next to no time."""

from __future__ import annotations

from typing import Any

from solver.scenes import CATALOGUE

SMALL: dict[str, dict[str, Any]] = {
    name: dict(kind.SMALL) for name, kind in CATALOGUE.items()
}
KINDS = ("bar", "block", "fault", "rope", "wall", "arch", "belt", "mesh")
"""Scenes of each kind of structure, and of stacks one with joints, too: what holds for
these holds for the other scenes of their code."""
