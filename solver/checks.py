"""Checks of the parts of a problem and of a method: which values they allow, and what to do.

A part checks itself once, where it is made: `check(self, length=POSITIVE,
instants=INSTANTS)`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Sized
from dataclasses import dataclass
from numbers import Integral
from typing import Any, NamedTuple, Protocol

import numpy as np

from solver.refusal import RefusedError, Words, is_number, plain

ALIKE = 1e-9
"""Share of the largest of some numbers up to which two of them differ by rounding."""


class Flaw(NamedTuple):
    """Flaw of a value: what is shown of it, what is allowed, and what to do."""

    shown: object
    allowed: str
    remedy: str


class Kind(Protocol):
    """The values that an attribute takes."""

    @property
    def allowed(self) -> str:
        """Words on these values."""

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value; None if there is none."""


def check(part: object, **kinds: Kind) -> None:
    """Refuse attributes of a part that are none of a kind; None is fine where it is the default.

    Raises
    ------
    RefusedError
        For the first that is refused.
    """
    owner = type(part)
    for name, kind in kinds.items():
        value = getattr(part, name)
        if value is not None or getattr(owner, name, kind) is not None:
            check_value(f"{owner.__name__}.{name}", value, kind)


def check_value(name: str, value: object, kind: Kind) -> None:
    """Refuse a value of a name that is none of a kind."""
    flaw = kind.flaw(value)
    if flaw is not None:
        shown: object = Words(value)
        if flaw.shown is not None:
            shown = flaw.shown
        raise RefusedError(name, shown, flaw.allowed, flaw.remedy)


@dataclass(slots=True)
class Number:
    """A finite number of a range; the lower end is left out if it is to be `above`.

    `endless` ones may be infinite, too, whatever the upper end.
    """

    low: float = -math.inf
    high: float = math.inf
    above: bool = False
    endless: bool = False

    @property
    def allowed(self) -> str:
        """Words on these values."""
        words = f"a number{_range(self.low, self.high, above=self.above)}"
        if self.endless:
            return f"{words}, or infinity"
        return words

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if is_number(value):
            is_in = self.low <= value <= self.high and not (
                self.above and value == self.low
            )
            if (is_in and math.isfinite(value)) or (self.endless and value == math.inf):
                return None
        return Flaw(value, self.allowed, "give a number in this range")


@dataclass(slots=True)
class Count:
    """A whole number of a range."""

    low: int
    high: float = math.inf

    @property
    def allowed(self) -> str:
        """Words on these values."""
        return f"a whole number{_range(self.low, self.high)}"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        is_whole = isinstance(value, Integral) and not isinstance(value, bool)
        if is_whole and self.low <= int(value) <= self.high:
            return None
        return Flaw(value, self.allowed, "give a whole number in this range")


@dataclass(slots=True)
class Numbers:
    """An array of finite numbers of a shape, of which None is any size.

    `whole` ones are indices. The lower end is left out if they are to be `above`.
    """

    shapes: tuple[tuple[int | None, ...], ...]
    low: float = -math.inf
    high: float = math.inf
    above: bool = False
    whole: bool = False

    @property
    def allowed(self) -> str:
        """Words on these values."""
        shapes = " or ".join(_written(shape) for shape in self.shapes)
        if self.whole:
            kind = "whole numbers"
        else:
            kind = "numbers"
        return f"an array of {kind}{_range(self.low, self.high, above=self.above)}, shape {shapes}"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value: its kind, its shape, or the first number that is refused."""
        if not isinstance(value, np.ndarray):
            return Flaw(value, self.allowed, "make an array of it, as np.array does")
        if value.dtype.kind not in ("iu" if self.whole else "iuf"):
            return Flaw(
                Words(f"of {value.dtype}"), self.allowed, "give numbers of this kind"
            )
        # Most have a shape that is given in full.
        fits = value.shape in self.shapes
        if not fits and not any(_fits(value.shape, shape) for shape in self.shapes):
            shown = Words(f"of shape {_written(value.shape)}")
            return Flaw(shown, self.allowed, "space comes first, then time")
        if not value.size:
            return None
        # Both are NaN if anything is.
        least = float(value.min())
        most = float(value.max())
        if self.above:
            is_above = least > self.low
        else:
            is_above = least >= self.low
        if is_above and -math.inf < least and most < math.inf and most <= self.high:
            return None
        return self._first(value)

    def _first(self, value: Any) -> Flaw:
        """The first number that is refused."""
        with np.errstate(invalid="ignore"):
            if self.above:
                is_above = value > self.low
            else:
                is_above = value >= self.low
            is_fine = is_above & (value <= self.high) & np.isfinite(value)
        place = np.unravel_index(int(np.argmin(is_fine)), value.shape)
        entry = float(value[place])
        where = ", ".join(str(int(index)) for index in place)
        if entry < 0.0 <= self.low:
            remedy = f"entry [{where}] is below zero, raise it"
        elif math.isfinite(entry):
            remedy = f"entry [{where}] is out of range, change it"
        else:
            remedy = f"entry [{where}] is no finite number, replace it"
        return Flaw(entry, self.allowed, remedy)


@dataclass(frozen=True)
class Instants:
    """Instants, shape (n_instants,), s, one or more, that increase."""

    allowed = "an array of instants that increase, s, shape [n_instants], one or more"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        flaw = Numbers(((None,),)).flaw(value)
        if flaw is not None:
            return Flaw(flaw.shown, self.allowed, flaw.remedy)
        if not value.size:
            return Flaw(Words("no instant"), self.allowed, "give one instant at least")
        steps = np.diff(value)
        if np.all(steps > 0.0):
            return None
        number = int(np.argmax(steps <= 0.0))
        before, after = (plain(float(one)) for one in value[number : number + 2])
        remedy = f"{after} comes after {before}: sort them, and give each once"
        return Flaw(Words(f"[..., {before}, {after}, ...]"), self.allowed, remedy)


class Part:
    """A value of one of some types."""

    def __init__(self, *types: type) -> None:
        self._types = types

    @property
    def allowed(self) -> str:
        """Words on these values."""
        return " or ".join(
            "None" if one is type(None) else one.__name__ for one in self._types
        )

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if isinstance(value, self._types):
            return None
        return Flaw(
            _described(value),
            self.allowed,
            f"make one, as {self._types[0].__name__}(...)",
        )


@dataclass(frozen=True)
class Choice:
    """One of some names."""

    names: tuple[str, ...]

    @property
    def allowed(self) -> str:
        """Words on these values."""
        return ", ".join(self.names)

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if isinstance(value, str) and value in self.names:
            return None
        return Flaw(value, self.allowed, "correct the name")


class Flag:
    """True or False."""

    allowed = "True or False"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if isinstance(value, bool | np.bool_):
            return None
        return Flaw(value, self.allowed, "give one of both")


class Function:
    """A function, or anything else that can be called."""

    allowed = "a function"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if callable(value):
            return None
        return Flaw(value, self.allowed, "give what makes it")


class Either:
    """A value of one kind or of another; the last one says what is wrong with a value of none."""

    def __init__(self, *kinds: Kind) -> None:
        self._kinds = kinds

    @property
    def allowed(self) -> str:
        """Words on these values."""
        return ", or ".join(kind.allowed for kind in self._kinds)

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        flaw = None
        for kind in self._kinds:
            flaw = kind.flaw(value)
            if flaw is None:
                return None
        if flaw is None:
            return None
        return Flaw(flaw.shown, self.allowed, flaw.remedy)


@dataclass(frozen=True)
class Each:
    """A sequence, of which each is of one kind; of a length, or of any but none."""

    kind: Kind
    length: int | None = None

    @property
    def allowed(self) -> str:
        """Words on these values."""
        if self.length is None:
            count = "one or more"
        else:
            count = str(self.length)
        return f"a sequence of {count}, each {self.kind.allowed}"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if not isinstance(value, Sequence) or isinstance(value, str):
            return Flaw(_described(value), self.allowed, "give a tuple")
        if len(value) == 0 or self.length not in (None, len(value)):
            return Flaw(Words(f"{len(value)} of them"), self.allowed, "give as many")
        for number, one in enumerate(value):
            flaw = self.kind.flaw(one)
            if flaw is not None:
                return Flaw(flaw.shown, self.allowed, f"number {number}: {flaw.remedy}")
        return None


@dataclass(frozen=True)
class Named:
    """A mapping from names to values of one kind; the names are any, or some of these."""

    kind: Kind
    names: tuple[str, ...] = ()

    @property
    def allowed(self) -> str:
        """Words on these values."""
        if self.names:
            names = f" of {', '.join(self.names)}"
        else:
            names = ""
        return f"a mapping of names{names} to {self.kind.allowed}"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if not isinstance(value, Mapping):
            return Flaw(_described(value), self.allowed, "give a dictionary")
        for name, one in value.items():
            if not isinstance(name, str) or (self.names and name not in self.names):
                return Flaw(name, self.allowed, "correct the name")
            flaw = self.kind.flaw(one)
            if flaw is not None:
                return Flaw(flaw.shown, self.allowed, f'"{name}": {flaw.remedy}')
        return None


POSITIVE = Number(0.0, above=True)
NON_NEGATIVE = Number(0.0)
ANY_NUMBER = Number()
COUNT = Count(1)
INSTANTS = Instants()
ROWS = Numbers(((None,),), low=0, whole=True)
FLAG = Flag()
FUNCTION = Function()


def _range(low: float, high: float, *, above: bool = False) -> str:
    """Words on a range of numbers."""
    if low == -math.inf:
        if high < math.inf:
            return f" up to {plain(high)}"
        return ""
    start = f" {'above' if above else 'from'} {plain(low)}"
    return start + (f" to {plain(high)}" if high < math.inf else "")


def _written(shape: Sequence[int | None]) -> str:
    """A shape as one writes it."""
    return "[" + ", ".join("n" if size is None else str(size) for size in shape) + "]"


def _fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    """Return whether an array has a shape."""
    if len(shape) != len(wanted):
        return False
    return all(size in (None, own) for own, size in zip(shape, wanted, strict=True))


def _described(value: object) -> object:
    """A value in short, where it may be an object of any size."""
    if value is None or isinstance(value, str | int | float):
        return value
    name = type(value).__name__
    if isinstance(value, Sized):
        size = f" of {len(value)}"
    else:
        size = ""
    return Words(f"a {name}{size}")
