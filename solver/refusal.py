"""What is refused: one message that names it, its value, what is allowed, and what to do."""

from __future__ import annotations

import json
import math
import re
from numbers import Real
from typing import Any, TypeGuard


class RefusedError(ValueError):
    """A refused value: the message names it, its value, the allowed range and the remedy."""

    def __init__(self, name: str, value: object, allowed: str, remedy: str) -> None:
        shown = json.dumps(value, default=str)
        shown = shown if len(shown) <= 60 else shown[:57] + "..."
        super().__init__(f"{name} = {shown} is refused; allowed: {allowed}; {remedy}")
        self.name, self.value = name, value
        self.allowed, self.remedy = allowed, remedy

    def __reduce__(self) -> tuple[type[RefusedError], tuple[Any, ...]]:
        """What another process makes it of again."""
        return type(self), (self.name, self.value, self.allowed, self.remedy)


def plain(value: float) -> str:
    """A number as one types it: 1e15, and not 1e+15."""
    text = str(value) if isinstance(value, int) else f"{value:g}"
    return re.sub(r"e\+?(-?)0*", r"e\1", text)


def is_number(value: object) -> TypeGuard[float]:
    """Whether it is a number, and no truth value."""
    return isinstance(value, Real) and not isinstance(value, bool)


def check_range(part: object, name: str, low: float, high: float, *, above: bool = False) -> None:
    """Refuse a number of a part of the method that is no number, or out of range.

    With `above` the lower end itself is refused, too.
    """
    value = getattr(part, name)
    if is_number(value) and low <= value <= high and not (above and value == low):
        return
    bounds = f"a number {'above' if above else 'from'} {plain(low)}"
    allowed = bounds + (f" to {plain(high)}" if math.isfinite(high) else "")
    raise RefusedError(
        f"{type(part).__name__}.{name}", value, allowed, "give a number in this range"
    )
