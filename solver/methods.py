"""What the setting `method` sets at once."""

from __future__ import annotations

from collections.abc import Mapping

METHODS: Mapping[str, Mapping[str, object]] = {
    "fast": {
        "search_direction": "auto",
        "acceleration": "anderson",
        "start": "nested",
        "relaxation": 0.8,
        "finish": "at-once",
        "tolerance": 1e-3,
    },
    "paper": {
        "search_direction": "paper",
        "acceleration": "none",
        "start": "zero",
        "relaxation": 0.8,
        "finish": "none",
        "tolerance": 1e-10,
    },
}
