"""Pictures as bytes: what models of the page are set to, with their numbers behind it.

    uint32 length of the header | header (JSON, padded to 8) | numbers

The header gives for the name of a model where its numbers begin, how many bytes they are, and what
is set: its attributes, or the columns of a data source. Arrays in it are objects that say where
among these numbers theirs are:

    {"floats": [at, count]}                     a Float32Array
    {"lines": [[at, count], ...]}               one Float32Array a line
    {"image": [at, rows, columns, "uint8"]}     an image, row by row
    {"places": [first, step, [[at, count], ...]]}   as lines, of steps of two bytes
    {"quads": [[at, count, corners of one], x, y]}  put together of places: {xs, ys}

With "since" a model is as the page had it last, but for the attributes that are set, and for those
words of four bytes of its numbers that a mask, a bit each, says are new; they stand behind it.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

ALIGNED = 8
STEPS, NOWHERE = 65_534, 65_535
"""Steps across all places, and what stands for one that is no number."""
Attributes = Mapping[str, Any]


class Places:
    """Places along one axis, of one line after the other, as steps between two ends.

    Parameters
    ----------
    lines
        Of each line, shape (n,); what is no number stays so.
    low, high
        What is seen; where places lie beyond, the steps go as far.
    """

    def __init__(self, lines: Sequence[ArrayLike], low: float, high: float) -> None:
        every = [np.asarray(one, dtype=np.float64) for one in lines]
        known = np.concatenate([np.array([low, high]), *every])
        known = known[np.isfinite(known)]
        self.first = float(known.min())
        self.step = float(np.ptp(known)) / STEPS or 1.0
        self.lines = [
            np.where(np.isfinite(one), np.rint((one - self.first) / self.step), NOWHERE).astype(
                np.uint16
            )
            for one in every
        ]


class Quads:
    """Quadrilaterals, or other polygons, whose corners the browser puts together.

    Parameters
    ----------
    corners
        Nodes of each, shape (n_quads, 4), or as many as all of them have.
    x, y
        Places of the nodes, at most 65 536, one line each.
    """

    def __init__(self, corners: np.ndarray, x: Places, y: Places) -> None:
        self.corners = np.ascontiguousarray(corners, dtype=np.uint16)
        self.x, self.y = x, y


class Packer:
    """Packs pictures, leaving out what the page has already."""

    def __init__(self) -> None:
        self._sent: dict[str, _Part] = {}

    def forget(self) -> None:
        """Take it that the page has nothing."""
        self._sent.clear()

    def pack(self, models: Mapping[str, Attributes]) -> bytes:
        """Pack what has changed of the attributes of these models, and of their numbers."""
        header, numbers = {}, bytearray()
        for name, attributes in models.items():
            part, before = _Part(attributes), self._sent.get(name)
            if before is not None and part.is_like(before):
                continue
            self._sent[name] = part
            header[name] = {"at": len(numbers), "size": len(part.numbers), "set": part.described}
            if before is None or before.described.keys() != part.described.keys():
                numbers += part.numbers
            else:
                header[name] |= {"set": part.news(before), "since": True}
                numbers += part.new_numbers(before)
        text = json.dumps(header, separators=(",", ":")).encode()
        text += b" " * (-(len(text) + 4) % ALIGNED)
        return struct.pack("<I", len(text)) + text + bytes(numbers)


class _Part:
    """The attributes of one model, and their numbers."""

    def __init__(self, attributes: Attributes) -> None:
        self.numbers = bytearray()
        with np.errstate(all="ignore"):
            self.described = {key: self._describe(value) for key, value in attributes.items()}

    def is_like(self, before: _Part) -> bool:
        """Tell whether this is what was before."""
        return self.described == before.described and self.numbers == before.numbers

    def news(self, before: _Part) -> dict[str, Any]:
        """Give the attributes that are said otherwise than before."""
        found = self.described.items()
        return {key: value for key, value in found if value != before.described[key]}

    def new_numbers(self, before: _Part) -> bytes:
        """Give which words of four bytes are others than before, a bit each, and these."""
        words, old = (np.frombuffer(one.numbers, np.uint32) for one in (self, before))
        if len(old) < len(words):
            old = np.pad(old, (0, len(words) - len(old)))
        is_new = words != old[: len(words)]
        mask = _aligned(np.packbits(is_new, bitorder="little").tobytes())
        return _aligned(mask + words[is_new].tobytes())

    def _describe(self, value: Any) -> Any:
        if isinstance(value, Places):
            lines = [[self._put(one), one.size] for one in value.lines]
            return {"places": [value.first, value.step, lines]}
        if isinstance(value, Quads):
            corners = [self._put(value.corners), *value.corners.shape]
            return {"quads": [corners, self._describe(value.x), self._describe(value.y)]}
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
        self.numbers += _aligned(values.tobytes())
        return at


def _aligned(numbers: bytes) -> bytes:
    return numbers + b"\0" * (-len(numbers) % ALIGNED)


def said(words: str) -> bytes:
    """Give a picture of words alone, in the status line."""
    return Packer().pack({"status": {"text": escape(f"<b>{escape(words)}</b>")}})
