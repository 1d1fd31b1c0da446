"""Settings of every scene with which a run takes next to no time."""

from __future__ import annotations

from typing import Any

from solver.scenes import CATALOGUE

SMALL: dict[str, dict[str, Any]] = {
    name: dict(kind.SMALL) for name, kind in CATALOGUE.items()
}
