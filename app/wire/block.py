"""Pictures as bytes: what models of the page are set to, with their numbers behind it.

    uint32 length of the header | header (JSON, padded to 8) | numbers

The header gives for the name of a model its attributes, or the columns of a data source; arrays
in it are objects that say where their numbers are:

    {"floats": [at, count]}                     a Float32Array
    {"lines": [[at, count], ...]}               one Float32Array a line
    {"image": [at, rows, columns, "uint8"]}     an image, row by row
    {"quads": [corners, count, places, count, corners of one]}  put together: {xs, ys}
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

ALIGNED = 8
Attributes = Mapping[str, Any]


class Quads:
    """Quadrilaterals, or other polygons, whose corners the browser puts together.

    Parameters
    ----------
    corners
        Nodes of each, shape (n_quads, 4), or as many as all of them have.
    places
        Of the nodes, at most 65 536, shape (n_nodes, 2).
    """

    def __init__(self, corners: np.ndarray, places: np.ndarray) -> None:
        self.corners = np.ascontiguousarray(corners, dtype=np.uint16)
        self.places = np.ascontiguousarray(places, dtype=np.float32)


class Packer:
    """Packs pictures, leaving out what the page has already."""

    def __init__(self) -> None:
        self._sent: dict[str, tuple[str, bytes]] = {}

    def forget(self) -> None:
        """Take it that the page has nothing."""
        self._sent.clear()

    def pack(self, models: Mapping[str, Attributes]) -> bytes:
        """Pack what has changed of the attributes of these models."""
        header, numbers = {}, bytearray()
        for name, attributes in models.items():
            found = _Part()
            with np.errstate(all="ignore"):
                described = {key: found.describe(value) for key, value in attributes.items()}
            known = (json.dumps(described), bytes(found.numbers))
            if self._sent.get(name) == known:
                continue
            self._sent[name] = known
            header[name] = {"at": len(numbers), "set": described}
            numbers += found.numbers
        text = json.dumps(header).encode()
        text += b" " * (-(len(text) + 4) % ALIGNED)
        return struct.pack("<I", len(text)) + text + bytes(numbers)


class _Part:
    """The numbers of one model."""

    def __init__(self) -> None:
        self.numbers = bytearray()

    def describe(self, value: Any) -> Any:
        if isinstance(value, Quads):
            corners, places = self._put(value.corners), self._put(value.places)
            sizes = value.corners.size, value.places.size
            return {"quads": [corners, sizes[0], places, sizes[1], value.corners.shape[1]]}
        if isinstance(value, np.ndarray) and value.ndim == 2:
            kind = "uint8" if value.dtype == np.uint8 else "float32"
            at = self._put(np.asarray(value, kind))
            return {"image": [at, *value.shape, kind]}
        if isinstance(value, np.ndarray):
            return {"floats": [self._put(np.asarray(value, np.float32)), value.size]}
        if isinstance(value, Sequence) and value and isinstance(value[0], np.ndarray):
            return {"lines": [[self._put(np.asarray(one, np.float32)), one.size] for one in value]}
        return value

    def _put(self, values: np.ndarray) -> int:
        at = len(self.numbers)
        self.numbers += values.tobytes()
        self.numbers += b"\0" * (-len(self.numbers) % ALIGNED)
        return at


def said(words: str) -> bytes:
    """Give a picture of words alone, in the status line."""
    return Packer().pack({"status": {"text": escape(f"<b>{escape(words)}</b>")}})
