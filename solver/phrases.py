"""Texts that know what they were made of: a page may say them in other words and units."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any


def plain(value: float) -> str:
    """Write a number as one types it: 1e15, and not 1e+15."""
    text = str(value) if isinstance(value, int) else f"{value:g}"
    return re.sub(r"e\+?(-?)0*", r"e\1", text)


class Amount(str):
    """A value with its SI unit, if it has one."""

    __slots__ = ("unit", "value")
    value: float
    unit: str

    def __new__(cls, value: float, unit: str = "") -> Amount:
        """Write it."""
        made = super().__new__(cls, f"{plain(value)} {unit}".strip())
        made.value, made.unit = value, unit
        return made

    def __getnewargs__(self) -> tuple[Any, ...]:
        """Give what a copy is made of."""
        return self.value, self.unit


class Phrase(str):
    """A text with what it was made of: a template, as of `str.format`, and what stands in it."""

    __slots__ = ("parts", "template")
    template: str
    parts: tuple[Any, ...]

    def __new__(cls, template: str, *parts: Any) -> Phrase:
        """Put the parts in their places."""
        made = super().__new__(cls, cls.written(template, parts))
        made.template, made.parts = template, parts
        return made

    def __getnewargs__(self) -> tuple[Any, ...]:
        """Give what a copy is made of."""
        return self.template, *self.parts

    @staticmethod
    def written(template: str, parts: Iterable[Any]) -> str:
        """Write a template with these parts."""
        return template.format(*parts)

    def anew(self, say: Callable[[str], str]) -> str:
        """Say it with another template and other parts."""
        parts = [say(part) if isinstance(part, str) else part for part in self.parts]
        return self.written(say(self.template), parts)


class Sentence(Phrase):
    """What begins with a capital, and ends with a full stop."""

    __slots__ = ()

    @staticmethod
    def written(template: str, parts: Iterable[Any]) -> str:
        """Write a template with these parts."""
        text = template.format(*parts)
        return f"{text[0].upper()}{text[1:]}."


def joined(between: str, parts: Sequence[str]) -> Phrase:
    """Put texts behind each other."""
    return Phrase(between.join(["{}"] * len(parts)), *parts)
