"""Settings of every scene with which a run takes next to no time."""

from __future__ import annotations

from typing import Any

from ropes import SMALL_ROPE

SMALL: dict[str, dict[str, Any]] = {
    "bar": {"elements": 20, "instants": 21, "substructures": 4},
    "strand": {"elements": 10, "instants": 11},
    "block": {"elements": 16, "elements_up": 6, "instants": 13},
    "layers": {"elements": 16, "layers": 2, "instants": 13},
    "fault": {"elements": 16, "elements_up": 8, "instants": 13},
    "incline": {"elements": 12, "elements_up": 6, "instants": 13},
    "wall": {
        **{"bricks": 3, "courses": 3, "elements": 4, "elements_up": 2, "instants": 13},
        "displacement": 5e-5,
    },
    "rope": {**SMALL_ROPE, "elements": 10, "instants": 13},
}
