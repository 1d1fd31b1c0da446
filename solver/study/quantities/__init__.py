"""Quantities of a run, each defined once: lessons, sweeps and charts derive from these.

A quantity is asked for by its name, and with a parameter as `NAME@PARAMETER`:
`error_force@10` is the error of the contact force at iteration 10.
"""

from __future__ import annotations

import math
from dataclasses import replace

import solver.study.quantities.contact_measures as contacts
import solver.study.quantities.cycle_measures as cyclic
import solver.study.quantities.reduction_measures as reductions
import solver.study.quantities.run_measures as runs
from solver.settings.definitions import SettingError
from solver.study.quantities.quantity import Quantity

QUANTITIES = {
    found.name: found
    for module in (runs, reductions, contacts, cyclic)
    for found in vars(module).values()
    if isinstance(found, Quantity)
}
"""All quantities by name, as their modules define them."""
FORMER = {"energy": "dissipation", "slipping": "slipped_share"}
"""Names that quantities had elsewhere before, and those that they have."""


def reading(text: object) -> Quantity:
    """Quantity that is asked for, as `NAME` or `NAME@PARAMETER`; others are refused."""
    if isinstance(text, str):
        name, at_sign, number = text.partition("@")
    else:
        name = ""
        at_sign = ""
        number = ""
    quantity = QUANTITIES.get(name)
    if name in FORMER:
        new = FORMER[name]
        raise SettingError("quantity", text, new, f"{name} is called {new}")
    if quantity is None:
        raise SettingError(
            "quantity", text, ", ".join(QUANTITIES), "choose one of these"
        )
    parameter = quantity.parameter
    if parameter is None and at_sign:
        raise SettingError("quantity", text, name, "it takes no parameter")
    if parameter is None or not (at_sign or parameter.needed):
        return quantity
    low, high = parameter.bounds
    is_counted = isinstance(low, int)
    if is_counted:
        kind = "a whole number"
    else:
        kind = "a number"
    allowed = f"{name}@ and {kind} from {low:g} to {high:g}"
    try:
        at = float(number)
    except ValueError:
        at = math.nan
    if not low <= at <= high or (is_counted and at != int(at)):
        raise SettingError("quantity", text, allowed, "mend the parameter")
    title = quantity.title + parameter.words.format(at)
    return replace(quantity, name=f"{name}@{at!r}", title=title, at=at)
