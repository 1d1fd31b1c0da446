"""A picture as the browser takes it apart."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np


def unpack(block: bytes) -> dict[str, dict[str, Any]]:
    """Give models and attributes of a picture as the browser has them."""
    (length,) = struct.unpack_from("<I", block)
    header = json.loads(block[4 : 4 + length])
    numbers = block[4 + length :]
    return {
        name: {key: _read(value, numbers, part["at"]) for key, value in part["set"].items()}
        for name, part in header.items()
    }


def _read(value: Any, numbers: bytes, start: int) -> Any:
    if not isinstance(value, dict):
        return value
    ((kind, where),) = value.items()
    if kind == "floats":
        return np.frombuffer(numbers, np.float32, where[1], start + where[0])
    if kind == "lines":
        return [np.frombuffer(numbers, np.float32, n, start + at) for at, n in where]
    if kind == "image":
        at, rows, columns, dtype = where
        return np.frombuffer(numbers, dtype, rows * columns, start + at).reshape(rows, columns)
    corners = np.frombuffer(numbers, np.uint16, where[1], start + where[0]).reshape(-1, where[4])
    return corners, np.frombuffer(numbers, np.float32, where[3], start + where[2]).reshape(-1, 2)
