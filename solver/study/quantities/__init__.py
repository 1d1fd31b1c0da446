"""Quantities of a run, each defined once: lessons, sweeps and charts derive from these.

A quantity is asked for by its name, and with a parameter as `NAME@PARAMETER`:
`error_force@10` is the error of the contact force at iteration 10.
"""

from __future__ import annotations

import math
from dataclasses import replace

import solver.study.quantities.arch_measures as arches
import solver.study.quantities.belt_measures as belts
import solver.study.quantities.body_measures as bodies
import solver.study.quantities.contact_measures as contacts
import solver.study.quantities.cycle_measures as cyclic
import solver.study.quantities.holding_measures as holding
import solver.study.quantities.reduction_measures as reductions
import solver.study.quantities.run_measures as runs
from solver.settings.values import SettingError
from solver.study.quantities.quantity import Parameter, Quantity

_LISTED = (
    runs.iterations,
    runs.seconds,
    runs.converged,
    runs.indicator,
    runs.behaviour,
    runs.estimated_error,
    runs.error_displacement,
    runs.error_force,
    runs.iterations_to_displacement,
    runs.iterations_to_force,
    runs.seconds_to_displacement,
    runs.seconds_to_force,
    reductions.modes,
    reductions.svd_modes_displacement,
    reductions.svd_modes_force,
    reductions.svd_numbers,
    reductions.clip_numbers,
    reductions.clip_error,
    bodies.peak_displacement,
    bodies.displacement,
    bodies.force,
    bodies.axial_force,
    bodies.left_force,
    bodies.right_force,
    bodies.top_force,
    bodies.bottom_force,
    contacts.peak_slip,
    contacts.peak_friction,
    contacts.peak_pressing,
    contacts.peak_pressure,
    contacts.contact_width,
    bodies.peak_stress,
    bodies.peak_stress_x,
    bodies.peak_stress_y,
    contacts.spring_force,
    holding.holding_friction,
    holding.holding_force,
    arches.thrust,
    arches.thinnest,
    arches.least_friction,
    arches.hinges,
    arches.live_factor,
    belts.tension_ratio,
    belts.torque,
    belts.creep,
    bodies.end_displacement,
    bodies.residual_displacement,
    bodies.stiffness,
    contacts.dissipation,
    contacts.slipped_share,
    contacts.stuck_share,
    contacts.first_slip_time,
    contacts.first_slip_displacement,
    cyclic.cycle_energy_ratio,
    cyclic.ratchet,
    cyclic.sliding_share,
    cyclic.shakedown_factor,
    cyclic.stuck_bending,
    cyclic.slipping_bending,
    cyclic.bending_stiffness,
    cyclic.energy_per_metre,
    cyclic.stress_range,
    cyclic.wire_slip,
    cyclic.wire_work,
    cyclic.recovery_length,
)
QUANTITIES: dict[str, Quantity] = {each.name: each for each in _LISTED}
"""All quantities by name, in the order in which they are listed to people."""
FORMER = {"energy": "dissipation", "slipping": "slipped_share"}
"""Former names of quantities, and the names that have replaced them."""


def reading(text: object) -> Quantity:
    """Quantity named by a text `NAME` or `NAME@PARAMETER`; refuse other texts."""
    name = ""
    at_sign = ""
    number = ""
    if isinstance(text, str):
        name, at_sign, number = text.partition("@")
    if name in FORMER:
        new = FORMER[name]
        raise SettingError("quantity", text, new, f"{name} is called {new}")
    if name not in QUANTITIES:
        known = ", ".join(QUANTITIES)
        raise SettingError("quantity", text, known, "choose one of these")
    quantity = QUANTITIES[name]
    parameter = quantity.parameter
    if parameter is None and at_sign:
        raise SettingError("quantity", text, name, "it takes no parameter")
    if parameter is None or not (at_sign or parameter.needed):
        return quantity
    at = _number(text, name, number, parameter)
    title = quantity.title + parameter.words.format(at)
    return replace(quantity, name=f"{name}@{at!r}", title=title, at=at)


def _number(text: object, name: str, number: str, parameter: Parameter) -> float:
    """Value of a quantity's parameter; refuse a value out of range."""
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
    return at
