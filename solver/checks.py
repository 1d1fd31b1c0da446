"""Checks of the parts of a problem and of a method: allowed values, flaws and remedies.

A part checks itself once, where it is made: `check(self, length=POSITIVE,
instants=INSTANTS)`.
"""

from __future__ import annotations

import dataclasses
import math
import operator
from collections.abc import Mapping, Sequence, Sized
from dataclasses import dataclass
from numbers import Integral
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeVar

import numpy as np

from solver.refusal import RefusedError, Words, is_number, plain

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Made = TypeVar("Made", bound="DataclassInstance")
WHOLE = int | Integral
"""Types of whole numbers, as a union that is not made at every check."""
ALIKE = 1e-9
"""Largest difference of two equal numbers by rounding, over the largest number."""


class Flaw(NamedTuple):
    """Flaw of a value: the value as shown, what is allowed, and a remedy."""

    shown: object
    allowed: str
    remedy: str


class Kind(Protocol):
    """Kind of the values that an attribute takes."""

    @property
    def allowed(self) -> str:
        """Description of the allowed values, for messages."""

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value; None if there is none."""


def check(part: object, **kinds: Kind) -> None:
    """Refuse attributes of a part that are not of their kind; a default None is fine.

    Messages name the part by its own words, where it has some, or by its type.

    Raises
    ------
    RefusedError
        For the first attribute that is refused.
    """
    owner = type(part)
    for name, kind in kinds.items():
        value = getattr(part, name)
        if value is None and getattr(owner, name, kind) is None:
            continue
        flaw = kind.flaw(value)
        # The name is written where it is needed: most parts have no flaw.
        if flaw is not None:
            words = owner.__name__
            if owner.__str__ is not object.__str__:
                words = str(part)
            raise _refusal(f"{words}.{name}", flaw)


def check_value(name: str, value: object, kind: Kind) -> None:
    """Refuse a value that is not of a kind; the message has its name."""
    flaw = kind.flaw(value)
    if flaw is not None:
        raise _refusal(name, flaw)


def checked_copies(part: Made, count: int, **fields: Sequence[object]) -> list[Made]:
    """Copies of a checked part, each with values of its own for some fields.

    To check hundreds of bodies one by one takes as long as the first iterations on
    them. So values of these fields, one for each new part, are checked before, together
    as one array.
    """
    same = {field.name: getattr(part, field.name) for field in dataclasses.fields(part)}
    parts = [object.__new__(type(part)) for _ in range(count)]
    for new in parts:
        vars(new).update(same)
    # Field by field, which takes a third of the time of part by part.
    for name, values in fields.items():
        for new, value in zip(parts, values, strict=True):
            vars(new)[name] = value
    return parts


def _refusal(name: str, flaw: Flaw) -> RefusedError:
    """Refusal of a value with a flaw."""
    shown = flaw.shown
    if shown is None:
        shown = Words(None)
    return RefusedError(name, shown, flaw.allowed, flaw.remedy)


@dataclass(slots=True)
class Number:
    """Finite numbers of a range.

    Attributes
    ----------
    low, high
        Ends of the range.
    above
        Whether the lower end is excluded.
    endless
        Whether infinity is allowed, too, whatever the upper end.
    """

    low: float = -math.inf
    high: float = math.inf
    above: bool = False
    endless: bool = False

    @property
    def allowed(self) -> str:
        """Description of the allowed values, for messages."""
        words = f"a number{_range(self.low, self.high, above=self.above)}"
        if self.endless:
            return f"{words}, or infinity"
        return words

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if is_number(value):
            if self.endless and value == math.inf:
                return None
            is_in = self.low <= value <= self.high
            is_excluded = self.above and value == self.low
            if is_in and not is_excluded and math.isfinite(value):
                return None
        return Flaw(value, self.allowed, "give a number in this range")


@dataclass(slots=True)
class Count:
    """Whole numbers of a range."""

    low: int
    high: float = math.inf

    @property
    def allowed(self) -> str:
        """Description of the allowed values, for messages."""
        return f"a whole number{_range(self.low, self.high)}"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        is_whole = isinstance(value, WHOLE) and not isinstance(value, bool)
        if is_whole and self.low <= int(value) <= self.high:
            return None
        return Flaw(value, self.allowed, "give a whole number in this range")


@dataclass(slots=True)
class Numbers:
    """Arrays of finite numbers.

    Attributes
    ----------
    shapes
        Allowed shapes, in which None is any size.
    low, high
        Ends of the range of the numbers.
    above
        Whether the lower end is excluded.
    whole
        Whether the numbers are whole ones, such as indices.
    """

    shapes: tuple[tuple[int | None, ...], ...]
    low: float = -math.inf
    high: float = math.inf
    above: bool = False
    whole: bool = False

    @property
    def allowed(self) -> str:
        """Description of the allowed values, for messages."""
        kind = "numbers"
        if self.whole:
            kind = "whole numbers"
        ends = _range(self.low, self.high, above=self.above)
        shapes = " or ".join(_written(shape) for shape in self.shapes)
        return f"an array of {kind}{ends}, shape {shapes}"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value: its type, its shape, or its first wrong number."""
        if not isinstance(value, np.ndarray):
            return Flaw(value, self.allowed, "make an array of it, as np.array does")
        if value.dtype.kind not in ("iu" if self.whole else "iuf"):
            return Flaw(
                Words(f"of {value.dtype}"), self.allowed, "give numbers of this kind"
            )
        # Most shapes are given in full, which is quick to see.
        fits = value.shape in self.shapes
        if not fits and not any(_fits(value.shape, shape) for shape in self.shapes):
            shown = Words(f"of shape {_written(value.shape)}")
            return Flaw(shown, self.allowed, "space comes first, then time")
        if not value.size or self._has_only_allowed(value):
            return None
        return self._first_flaw(value)

    def _has_only_allowed(self, value: Any) -> bool:
        """Check whether all numbers of an array are allowed."""
        if self.low == -math.inf and self.high == math.inf:
            # Whole numbers are finite.
            return self.whole or bool(np.isfinite(value).all())
        # Both are NaN if any number is.
        minimum = float(value.min())
        if self.whole and self.high == math.inf:
            maximum = minimum
        else:
            maximum = float(value.max())
        is_above = operator.gt if self.above else operator.ge
        is_finite = -math.inf < minimum and maximum < math.inf
        return is_above(minimum, self.low) and is_finite and maximum <= self.high

    def _first_flaw(self, value: Any) -> Flaw:
        """Find the flaw of the first wrong number of an array."""
        with np.errstate(invalid="ignore"):
            is_above = operator.gt if self.above else operator.ge
            is_in = is_above(value, self.low) & (value <= self.high)
            is_fine = is_in & np.isfinite(value)
        place = np.unravel_index(int(np.argmin(is_fine)), value.shape)
        number = float(value[place])
        entry = f"entry [{', '.join(str(int(index)) for index in place)}]"
        if number < 0.0 <= self.low:
            remedy = f"{entry} is below zero, raise it"
        elif math.isfinite(number):
            remedy = f"{entry} is out of range, change it"
        else:
            remedy = f"{entry} is no finite number, replace it"
        return Flaw(number, self.allowed, remedy)


@dataclass(frozen=True)
class IncreasingInstants:
    """Arrays of one or more increasing instants, shape (n_instants,), s."""

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
        before = plain(float(value[number]))
        after = plain(float(value[number + 1]))
        remedy = f"{after} comes after {before}: sort them, and give each once"
        return Flaw(Words(f"[..., {before}, {after}, ...]"), self.allowed, remedy)


class InstanceOf:
    """Instances of some types."""

    def __init__(self, *types: type) -> None:
        self._types = types

    @property
    def allowed(self) -> str:
        """Description of the allowed values, for messages."""
        names = [kind.__name__ for kind in self._types]
        return " or ".join(names).replace("NoneType", "None")

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
    """Names from a given list."""

    names: tuple[str, ...]

    @property
    def allowed(self) -> str:
        """Description of the allowed values, for messages."""
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
    """Functions, and other objects that can be called."""

    allowed = "a function"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if callable(value):
            return None
        return Flaw(value, self.allowed, "give a function")


class AnyOf:
    """Values of one of several kinds.

    The flaw of any other value is that which the last kind finds; of a number that
    which the kind of numbers finds.
    """

    def __init__(self, *kinds: Kind) -> None:
        self._kinds = kinds

    @property
    def allowed(self) -> str:
        """Description of the allowed values, for messages."""
        return ", or ".join(kind.allowed for kind in self._kinds)

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        described: Flaw | None = None
        is_of_numbers = False
        for kind in self._kinds:
            flaw = kind.flaw(value)
            if flaw is None:
                return None
            if not is_of_numbers:
                described = flaw
            is_of_numbers = isinstance(kind, Number) and is_number(value)
        if described is None:
            return None
        return Flaw(described.shown, self.allowed, described.remedy)


@dataclass(frozen=True)
class SequenceOf:
    """Sequences of values of one kind: of a given length, or of any except zero."""

    kind: Kind
    length: int | None = None

    @property
    def allowed(self) -> str:
        """Description of the allowed values, for messages."""
        count = "one or more"
        if self.length is not None:
            count = str(self.length)
        return f"a sequence of {count}, each {self.kind.allowed}"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if not isinstance(value, Sequence) or isinstance(value, str):
            return Flaw(_described(value), self.allowed, "give a tuple")
        if len(value) == 0 or self.length not in (None, len(value)):
            return Flaw(Words(f"{len(value)} of them"), self.allowed, "give as many")
        for number, entry in enumerate(value):
            flaw = self.kind.flaw(entry)
            if flaw is not None:
                return Flaw(flaw.shown, self.allowed, f"number {number}: {flaw.remedy}")
        return None


@dataclass(frozen=True)
class MappingOf:
    """Mappings from names to values of one kind; any names if `names` is empty."""

    kind: Kind
    names: tuple[str, ...] = ()

    @property
    def allowed(self) -> str:
        """Description of the allowed values, for messages."""
        names = ""
        if self.names:
            names = f" of {', '.join(self.names)}"
        return f"a mapping of names{names} to {self.kind.allowed}"

    def flaw(self, value: Any) -> Flaw | None:
        """Find the flaw of a value."""
        if not isinstance(value, Mapping):
            return Flaw(_described(value), self.allowed, "give a dictionary")
        for name, entry in value.items():
            is_unknown = bool(self.names) and name not in self.names
            if not isinstance(name, str) or is_unknown:
                return Flaw(name, self.allowed, "correct the name")
            flaw = self.kind.flaw(entry)
            if flaw is not None:
                return Flaw(flaw.shown, self.allowed, f'"{name}": {flaw.remedy}')
        return None


POSITIVE = Number(0.0, above=True)
NON_NEGATIVE = Number(0.0)
ANY_NUMBER = Number()
COUNT = Count(1)
INSTANTS = IncreasingInstants()
ROWS = Numbers(((None,),), low=0, whole=True)
FLAG = Flag()
FUNCTION = Function()


def _range(low: float, high: float, *, above: bool = False) -> str:
    """Description of a range of numbers."""
    if low == -math.inf:
        if high < math.inf:
            return f" up to {plain(high)}"
        return ""
    words = f" {'above' if above else 'from'} {plain(low)}"
    if high < math.inf:
        words = f"{words} to {plain(high)}"
    return words


def _written(shape: Sequence[int | None]) -> str:
    """Text of a shape, with n for any size."""
    sizes = ["n" if size is None else str(size) for size in shape]
    return f"[{', '.join(sizes)}]"


def _fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    """Check whether a shape is the expected one, in which None is any size."""
    if len(shape) != len(wanted):
        return False
    for size, allowed in zip(shape, wanted, strict=True):
        if allowed is not None and allowed != size:
            return False
    return True


def _described(value: object) -> object:
    """Value as messages show it; of an object its type and its length."""
    if value is None or isinstance(value, str | int | float):
        return value
    name = type(value).__name__
    if isinstance(value, Sized):
        return Words(f"a {name} of {len(value)}")
    return Words(f"a {name}")
