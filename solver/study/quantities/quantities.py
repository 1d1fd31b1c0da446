"""Quantities of a run, each defined once: lessons, sweeps and charts derive from these.

A quantity is asked for by its name, and with a parameter as `NAME@PARAMETER`: `error_force@10` is
the error of the contact force at iteration 10.
"""

from __future__ import annotations

from dataclasses import dataclass

from solver.definitions import SettingError
from solver.study.quantities import (
    contact_measures,
    cycle_measures,
    reduction_measures,
    run_measures,
)
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import Quantity

_MODULES = run_measures, reduction_measures, contact_measures, cycle_measures
QUANTITIES = {
    found.name: found
    for module in _MODULES
    for found in vars(module).values()
    if isinstance(found, Quantity)
}
"""All quantities by name, as their modules define them."""


@dataclass(frozen=True)
class Reading:
    """A quantity with its parameter, ready to be taken of a run."""

    quantity: Quantity
    at: float | None

    @property
    def name(self) -> str:
        """What it is asked for by."""
        return self.quantity.name if self.at is None else f"{self.quantity.name}@{self.at!r}"

    @property
    def title(self) -> str:
        """What it is called, in words."""
        if self.quantity.parameter is None or self.at is None:
            return self.quantity.title
        return self.quantity.title + self.quantity.parameter.words.format(self.at)

    def __call__(self, run: FinishedRun) -> float:
        """Value of a finished run, in the quantity's unit."""
        return self.quantity(run, self.at)


def reading(text: object) -> Reading:
    """Read what is asked for, `NAME` or `NAME@PARAMETER`.

    Raises
    ------
    SettingError
        For a quantity that there is not, or a parameter that it does not take.
    """
    name, at_sign, number = text.partition("@") if isinstance(text, str) else ("", "", "")
    quantity = QUANTITIES.get(name)
    if quantity is None:
        raise SettingError("quantity", text, ", ".join(QUANTITIES), "choose one of these")
    parameter = quantity.parameter
    if parameter is None and at_sign:
        raise SettingError("quantity", text, name, "it takes no parameter")
    if parameter is None or not (at_sign or parameter.needed):
        return Reading(quantity, None)
    low, high = parameter.bounds
    kind = "a whole number" if parameter.whole else "a number"
    allowed = f"{name}@ and {kind} from {low:g} to {high:g}"
    try:
        at = float(number)
    except ValueError:
        raise SettingError("quantity", text, allowed, "write the parameter") from None
    if not low <= at <= high or (parameter.whole and at != int(at)):
        raise SettingError("quantity", text, allowed, "mend the parameter")
    return Reading(quantity, at)
