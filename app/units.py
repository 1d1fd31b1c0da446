"""Units that values are read in: each setting, axis and figure keeps one, chosen once."""

from __future__ import annotations

import math
from dataclasses import dataclass

import param

from solver.definitions import Parameter, about

PREFIXES = {"µ": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
PREFIXED = ("m", "N", "Pa", "J", "N/m", "N/m^3", "N·m", "N·m/m", "rad")
"""Units that take a prefix."""
TIMES = {"s": 1.0, "h": 3600.0, "d": 86400.0}
LATER = {"GPa": 10.0, "GN/m³": 10.0, "h": 3.0, "d": 3.0}
"""Where a unit begins that is not taken from 1 on: a stress of 3000 MPa is read as that."""
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Unit:
    """A unit and its size in SI."""

    name: str
    factor: float = 1.0

    def __call__(self, value: float, digits: int = 3) -> str:
        """A value in SI with this unit."""
        return f"{number(value / self.factor, digits)} {self.name}".strip()

    def titled(self, title: str) -> str:
        """A title with the unit behind it."""
        return f"{title}, {self.name}" if self.name else title


def unit_for(size: float, unit: str) -> Unit:
    """The unit in which values up to a size, in SI, are read."""
    name = unit.replace("^2", "²").replace("^3", "³")
    if unit == "s":
        steps = TIMES
    elif unit in PREFIXED:
        steps = {prefix + name: factor for prefix, factor in PREFIXES.items()}
    else:
        return Unit(name)
    if not (math.isfinite(size) and size > 0.0):
        size = 1.0
    rounded = float(f"{size:.3g}") * (1.0 + 1e-9)
    fitting = [Unit(n, f) for n, f in steps.items() if f * LATER.get(n, 1.0) <= rounded]
    return fitting[-1] if fitting else Unit(*next(iter(steps.items())))


def unit_of(definition: Parameter) -> Unit:
    """The unit of a setting, by its default or else its range."""
    unit = about(definition).unit
    if not isinstance(definition, param.Number):
        return Unit(unit)
    size = abs(definition.default) or max(map(abs, definition.softbounds))
    return unit_for(size, unit)


def number(value: float, digits: int = 3) -> str:
    """A number, with a power of ten where it is very large or small, and a printed minus."""
    near = float(f"{value:.{digits}g}")
    if near != 0.0 and math.isfinite(near) and not 1e-3 <= abs(near) < 1e6:
        digit, exponent = f"{value:.{digits - 1}e}".split("e")
        text = f"{float(digit):g}·10{str(int(exponent)).translate(RAISED)}"
    else:
        text = f"{near:.7g}"
    return text.replace("-", "−")


def percent(share: float) -> str:
    """A share in per cent."""
    if not math.isfinite(share):
        return "–"
    return f"{number(100.0 * share, 2 if share < 1.0 else 3)} %"
