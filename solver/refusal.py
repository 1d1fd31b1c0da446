"""Refusals: messages with name, value, allowed values, and a remedy."""

from __future__ import annotations

import json
import re
from numbers import Real
from typing import Any, TypeGuard

NUMBER = float | Real
"""Types of numbers; floats first, as an abstract class is slow to ask."""
LONGEST = 60
LONGEST_WORDS = 240
"""Largest number of letters of a value that are shown, and of a description, whose end
may be what is wrong."""


class Words(str):
    """Description of a value too large to show; messages have it without quotes."""

    __slots__ = ()


class RefusedError(ValueError):
    """Refused value: a message with name, value, allowed values and a remedy."""

    def __init__(self, name: str, value: object, allowed: str, remedy: str) -> None:
        shown = _shown(value)
        longest = LONGEST
        if isinstance(value, Words):
            longest = LONGEST_WORDS
        if len(shown) > longest:
            shown = shown[: longest - 3] + "..."
        super().__init__(f"{name} = {shown} is refused; allowed: {allowed}; {remedy}")
        self.name = name
        self.value = value
        self.allowed = allowed
        self.remedy = remedy

    def __reduce__(self) -> tuple[type[RefusedError], tuple[Any, ...]]:
        """Arguments to make the error again in another process."""
        return type(self), (self.name, self.value, self.allowed, self.remedy)


def _shown(value: object) -> str:
    """Text of a value as a user types it."""
    if isinstance(value, Words):
        return value
    try:
        return json.dumps(value, default=str)
    except (TypeError, ValueError):  # names that are no text, and what contains itself
        return str(value)


def plain(value: float) -> str:
    """Text of a number as a user types it: 1e15, and not 1e+15."""
    if isinstance(value, int):
        text = str(value)
    else:
        text = f"{value:g}"
    return re.sub(r"e\+?(-?)0*", r"e\1", text)


def is_number(value: object) -> TypeGuard[float]:
    """Check whether a value is a number, and not a truth value."""
    return isinstance(value, NUMBER) and not isinstance(value, bool)
