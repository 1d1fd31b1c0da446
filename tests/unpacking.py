"""Pictures as the browser takes them apart."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

from app.wire.block import NOWHERE


class Unpacker:
    """What a page remembers of the pictures that it has had."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[dict[str, Any], bytes]] = {}

    def __call__(self, block: bytes) -> dict[str, dict[str, Any]]:
        """Give models and attributes of a picture as the browser has them."""
        (length,) = struct.unpack_from("<I", block)
        header = json.loads(block[4 : 4 + length])
        numbers = block[4 + length :]
        for name, part in header.items():
            at, size, attributes = part["at"], part["size"], part["set"]
            own = numbers[at : at + size]
            if part.get("since"):
                before, kept = self._known[name]
                attributes, own = {**before, **attributes}, _renewed(numbers[at:], size, kept)
            self._known[name] = attributes, own
        return {name: self._read(name) for name in header}

    def _read(self, name: str) -> dict[str, Any]:
        attributes, numbers = self._known[name]
        return {key: _read(value, numbers) for key, value in attributes.items()}


def unpack(block: bytes) -> dict[str, dict[str, Any]]:
    """Take a picture apart that a page has first."""
    return Unpacker()(block)


def _renewed(packed: bytes, size: int, before: bytes) -> bytes:
    """Give a model's numbers, of which only some are new."""
    count = size // 4
    aligned = -(-count // 64) * 8
    mask = np.unpackbits(np.frombuffer(packed, np.uint8, aligned), bitorder="little")
    is_new = mask[:count].astype(bool)
    found = np.frombuffer(before.ljust(size, b"\0")[:size], np.uint32).copy()
    found[is_new] = np.frombuffer(packed, np.uint32, int(is_new.sum()), aligned)
    return found.tobytes()


def _read(value: Any, numbers: bytes) -> Any:
    if not isinstance(value, dict):
        return value
    ((kind, where),) = value.items()
    if kind == "floats":
        return np.frombuffer(numbers, np.float32, where[1], where[0])
    if kind == "lines":
        return [np.frombuffer(numbers, np.float32, n, at) for at, n in where]
    if kind == "image":
        at, rows, columns, dtype = where
        return np.frombuffer(numbers, dtype, rows * columns, at).reshape(rows, columns)
    if kind == "places":
        first, step, lines = where
        steps = [np.frombuffer(numbers, np.uint16, n, at) for at, n in lines]
        return [np.where(one == NOWHERE, np.nan, first + step * one) for one in steps]
    (at, count, each), x, y = where
    corners = np.frombuffer(numbers, np.uint16, count * each, at).reshape(count, each)
    return corners, np.stack([*_read(x, numbers), *_read(y, numbers)], axis=1)
