"""Quantities of a run, each defined once: lessons, sweeps and charts derive from these.

A quantity is asked for by its name, and with a parameter as `NAME@PARAMETER`: `error_force@10` is
the error of the contact force at iteration 10.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from solver.definitions import SettingError
from solver.reduction.svd import InterfaceField
from solver.scenes import kind_of
from solver.settings import Settings
from solver.study.quantities import contact_measures, measures
from solver.study.quantities.clip_measures import OF_CLIPS
from solver.study.quantities.contact_measures import OF_STRESS
from solver.study.quantities.cycle_measures import OF_CYCLES
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import CYCLE, WITHIN, Parameter, Quantity
from solver.study.quantities.rope_measures import OF_ROPES

ITERATION = Parameter(" at iteration {:g}", (1, 1_000_000), whole=True)
SHARE = Parameter(" of a share {:g} of the points", (0.0, 1.0))


def _with_bases(settings: Settings) -> bool:
    return settings.applies("pgd_modes")


def _on_rods(settings: Settings) -> bool:
    return kind_of(settings) != "plane"


def _may_open(settings: Settings) -> bool:
    """Tell where the pressing force is an unknown."""
    return settings.opens


def _over_a_displacement(settings: Settings) -> bool:
    return settings.loop_is_over_displacement


def _with_a_spring(settings: Settings) -> bool:
    return settings.has_spring


def _with_a_broken_wire(settings: Settings) -> bool:
    return settings.has_break


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
        """Take it of a finished run, in the quantity's unit."""
        return self.quantity.of(run, self.at)


def _recorded(
    column: str, title: str, reads: Literal["errors", "indicators"], *, is_share: bool = False
) -> Quantity:
    read = measures.recorded(column)
    return Quantity(column, title, "", read, ITERATION, reads, is_share, is_of_course=True)


def _error(column: str, title: str) -> Quantity:
    return _recorded(column, title, "errors", is_share=True)


def _until(name: str, title: str, column: str, error: str, unit: str = "") -> Quantity:
    read = measures.until(column, error)
    return Quantity(name, title, unit, read, WITHIN, "errors", is_of_course=True)


_ALL = (
    Quantity(
        "iterations", "Iterations", "", lambda run, at: run.iterate.iterations, is_of_course=True
    ),
    Quantity("seconds", "Run time", "s", measures.recorded("seconds"), is_of_course=True),
    Quantity(
        "seconds_per_iteration",
        "Run time of an iteration",
        "s",
        measures.seconds_per_iteration,
        is_of_course=True,
    ),
    Quantity("memory", "Memory at its peak", "B", measures.memory, is_of_course=True),
    _recorded("indicator", "LATIN indicator", "indicators"),
    _recorded("behaviour", "k-free indicator", "indicators"),
    _recorded(
        "estimated_error", "Estimated error of the contact force", "indicators", is_share=True
    ),
    _error("error_displacement", "Error of the displacement"),
    _error("error_force", "Error of the contact force"),
    _until(
        "iterations_to_displacement",
        "Iterations to an error of the displacement of",
        "iteration",
        "error_displacement",
    ),
    _until(
        "iterations_to_force",
        "Iterations to an error of the contact force of",
        "iteration",
        "error_force",
    ),
    _until(
        "seconds_to_displacement",
        "Run time to an error of the displacement of",
        "seconds",
        "error_displacement",
        "s",
    ),
    _until(
        "seconds_to_force",
        "Run time to an error of the contact force of",
        "seconds",
        "error_force",
        "s",
    ),
    Quantity(
        "modes",
        "Modes of the largest separated basis",
        "",
        measures.modes,
        is_of_course=True,
        applies=_with_bases,
    ),
    Quantity(
        "svd_modes_displacement",
        "Singular vectors of the displacement for an error of",
        "",
        measures.singular(InterfaceField.DISPLACEMENT),
        WITHIN,
        applies=_on_rods,
    ),
    Quantity(
        "svd_modes_force",
        "Singular vectors of the friction force for an error of",
        "",
        measures.singular(InterfaceField.FRICTION_FORCE),
        WITHIN,
        applies=_on_rods,
    ),
    *OF_CLIPS,
    Quantity("peak_displacement", "Largest displacement", "m", measures.peak_displacement),
    Quantity("peak_slip", "Largest slip", "m", measures.peak_slip),
    Quantity("peak_friction", "Largest friction, all points", "N", measures.peak_friction),
    Quantity(
        "peak_pressing",
        "Largest pressing force, all points",
        "N",
        measures.peak_pressing,
        applies=_may_open,
    ),
    Quantity(
        "peak_pressure",
        "Largest pressure",
        "Pa",
        contact_measures.peak_pressure,
        applies=_may_open,
    ),
    Quantity(
        "contact_width",
        "Largest length in contact",
        "m",
        contact_measures.contact_width,
        applies=_may_open,
    ),
    *OF_STRESS,
    Quantity(
        "spring_force",
        "Largest force in the spring",
        "N",
        contact_measures.spring_force,
        applies=_with_a_spring,
    ),
    Quantity("holding_friction", "Smallest friction that holds", "", measures.holding_friction),
    Quantity(
        "end_displacement",
        "Displacement at the largest load",
        "m",
        measures.end_displacement,
        applies=_over_a_displacement,
        at_instant=measures.displacement_at,
    ),
    Quantity(
        "residual_displacement",
        "Displacement left without load",
        "m",
        measures.residual_displacement,
        applies=_over_a_displacement,
    ),
    Quantity(
        "stiffness",
        "Largest load over its displacement",
        "N/m",
        measures.stiffness,
        applies=_over_a_displacement,
    ),
    Quantity("dissipation", "Energy dissipated", "J", measures.dissipation, CYCLE),
    *OF_CYCLES,
    *OF_ROPES,
    Quantity(
        "slipped_share", "Share of the points that slip", "", measures.slipped_share, is_share=True
    ),
    Quantity(
        "stuck_share",
        "Share of the contact that sticks at the largest load",
        "",
        contact_measures.stuck_share,
        is_share=True,
        at_instant=contact_measures.stuck_share_at,
    ),
    Quantity("first_slip_time", "Time of the first slip", "s", measures.first_slip_time, SHARE),
    Quantity(
        "first_slip_displacement",
        "Displacement at the first slip",
        "m",
        measures.first_slip_displacement,
        SHARE,
        applies=_over_a_displacement,
    ),
    Quantity(
        "recovery_length",
        "Length over which a broken wire regains its force",
        "m",
        measures.recovery_length,
        applies=_with_a_broken_wire,
        at_instant=measures.recovery_length_at,
    ),
)
QUANTITIES = {one.name: one for one in _ALL}
"""All quantities by name."""


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
    if parameter is None:
        if at_sign:
            raise SettingError("quantity", text, name, "it takes no parameter")
        return Reading(quantity, None)
    if not at_sign and not parameter.needed:
        return Reading(quantity, None)
    return Reading(quantity, _number(parameter, quantity.name, text, number))


def _number(parameter: Parameter, name: str, text: object, number: str) -> float:
    low, high = parameter.bounds
    kind = "a whole number" if parameter.whole else "a number"
    allowed = f"{name}@ and {kind} from {low:g} to {high:g}"
    try:
        found = float(number)
    except ValueError:
        raise SettingError("quantity", text, allowed, "write the parameter") from None
    if not low <= found <= high or (parameter.whole and found != int(found)):
        raise SettingError("quantity", text, allowed, "mend the parameter")
    return found
