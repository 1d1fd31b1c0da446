"""What the tab What if asks: a quantity over one or two settings, as the command line takes it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from urllib.parse import parse_qsl

import param

from app.refusals import message_of
from app.state import ANSWER, SEARCH, answer
from app.worker.references import has_reference
from solver.definitions import CurveParameter, Parameter, SettingError, about
from solver.scenes import behind, kind_of, loads_of
from solver.settings import Settings
from solver.study.quantities.cycle_measures import has_a_limit, has_cycles
from solver.study.quantities.quantities import QUANTITIES, reading
from solver.study.quantities.quantity import Quantity
from solver.study.sweep import Plan, plan_of

VARY, OF = "vary", "of"
"""Names in an address: settings with their values, and the quantity."""
VALUES, COARSE = 13, 10
"""Values of a range, and along each side of a map."""
TENTH = 0.1
CUTS = (1, 2, 5, 10, 20)
"""Numbers of substructures that are compared."""
BESIDE = ("peak_friction", "end_displacement", "stiffness", "dissipation", "stuck_share")
"""Taken of every run for the table and other charts: together 1 to 6 % of its time (measured)."""


@dataclass(frozen=True)
class Question:
    """One or two settings over their values, and a quantity.

    Attributes
    ----------
    vary
        `NAME=LOW:HIGH:COUNT`, the same with `:log`, or `NAME=VALUE,VALUE,...`; in SI.
    of
        A quantity, as `dissipation` or `iterations_to_force@0.01`.
    """

    vary: tuple[str, ...]
    of: str

    @property
    def names(self) -> list[str]:
        """Names of the settings."""
        return [text.partition("=")[0] for text in self.vary]

    def pairs(self) -> list[tuple[str, str]]:
        """What an address has of it."""
        return [*((VARY, text) for text in self.vary), (OF, self.of)]

    def plan(self, settings: Settings) -> Plan:
        """The runs that answer it, everything else as in some settings.

        Raises
        ------
        SettingError
            For whatever of it cannot be run.
        """
        beside = [name for name in BESIDE if QUANTITIES[name].applies(settings)]
        plan = plan_of(self.asked(settings), self.vary, [self.of, *beside])
        for name in plan.idle():
            can = "settings that do something here"
            raise SettingError(name, "varied", can, "vary another setting")
        return plan

    def asked(self, settings: Settings) -> Settings:
        """Settings of the runs that answer it beside those of the page.

        At once, as nobody watches them; where LATIN's own iterations are counted, these go on until
        they are within what is asked.
        """
        if settings.finish == "none":
            return settings
        if not self.of.startswith("iterations"):
            return answer(settings)
        with contextlib.suppress(SettingError):
            nearer = min(reading(self.of).at or settings.accuracy, settings.accuracy)
            return settings.replace(finish=SEARCH["finish"], accuracy=nearer)
        return settings

    def refusal(self, settings: Settings) -> str:
        """What of it cannot be run and why, or nothing."""
        try:
            self.plan(settings)
        except SettingError as refusal:
            return message_of(refusal, settings)
        return ""


def question_from_query(query: str) -> Question | None:
    """What an address asks, if it does; nothing of it is refused yet."""
    pairs = parse_qsl(query.lstrip("?"))
    vary = tuple(text for name, text in pairs if name == VARY)[:2]
    of = dict(pairs).get(OF, "")
    return Question(vary, of) if vary and of else None


def as_watched(settings: Settings, page: Settings, varied: Sequence[str]) -> Settings:
    """Settings of a point as a page shows its run, which starts and ends as its own do."""
    ends = {"accuracy"} if settings.finish == "none" else {"accuracy", *ANSWER}
    return settings.replace(**{name: getattr(page, name) for name in ends - set(varied)})


def variable(settings: Settings) -> dict[str, Parameter]:
    """Settings that may vary: those that do something here and have several values."""
    return {
        name: definition
        for name, definition in settings.definitions().items()
        if settings.applies(name)
        and (isinstance(definition, param.Number) or len(names_of(definition)) > 1)
    }


def quantities(settings: Settings) -> dict[str, Quantity]:
    """Quantities that runs of these settings may have."""
    return {
        name: quantity
        for name, quantity in QUANTITIES.items()
        if quantity.applies(settings) and (has_reference(settings) or quantity.reads != "errors")
    }


def names_of(definition: Parameter) -> list[str]:
    """Values of a setting that are no numbers."""
    if isinstance(definition, param.Boolean):
        return ["false", "true"]
    if isinstance(definition, CurveParameter):
        return list(definition.presets)
    return list(definition.objects) if isinstance(definition, param.Selector) else []


def proposed(definition: Parameter, name: str) -> str:
    """Values that are proposed for a setting: what its slider shows, or all its names."""
    if not isinstance(definition, param.Number):
        return f"{name}={','.join(names_of(definition))}"
    low, high = definition.softbounds
    is_log = about(definition).logarithmic and low > 0
    return f"{name}={low:g}:{high:g}:{VALUES}{':log' if is_log else ''}"


def quantity_with(name: str, at: str) -> str:
    """A quantity with its number; one that needs one has a tenth."""
    parameter = QUANTITIES[name].parameter if name in QUANTITIES else None
    if parameter is None:
        return name
    at = at.strip() or (str(TENTH) if parameter.needed else "")
    return f"{name}@{at}" if at else name


def over_k(settings: Settings) -> Question:
    """Iterations until the force is as near as a page asks, over k."""
    k = proposed(settings.definitions()["k_scale"], "k_scale")
    return Question((k,), f"iterations_to_force@{settings.accuracy:g}")


def bathtub(settings: Settings) -> Question:
    """Iterations over the search direction, with and without acceleration."""
    return _iterations(settings, "acceleration")


def _iterations(settings: Settings, name: str) -> Question:
    vary = [proposed(settings.definitions()["k_scale"], "k_scale")]
    if name == "substructures":
        vary.append(f"{name}={','.join(_possible(settings, name))}")
    elif name in variable(settings):
        vary.append(proposed(settings.definitions()[name], name))
    of = quantity_with("iterations_to_force", "") if has_reference(settings) else "iterations"
    return Question(tuple(vary), of)


def _possible(settings: Settings, name: str) -> Iterator[str]:
    for value in CUTS:
        with contextlib.suppress(SettingError):
            yield str(getattr(settings.replace(**{name: value}), name))


def _design(settings: Settings) -> Question | None:
    return _map(settings, "friction", _load(settings), "dissipation")


def _fretting(settings: Settings) -> Question | None:
    if not has_cycles(settings):
        return None
    return _map(settings, _load(settings), behind(settings).get("top y"), "sliding_share")


def _shakedown(settings: Settings) -> Question | None:
    """Not of rods that stick rigidly: a load at their end has no limit, as the mesh is refined."""
    is_rigid_rod = kind_of(settings) != "plane" and not settings.applies("contact_stiffness")
    if not has_a_limit(settings) or is_rigid_rod:
        return None
    end = settings.definitions()["friction"].softbounds[1]
    return Question((f"friction={TENTH * end:g}:{end:g}:{COARSE}",), "shakedown_factor")


def _load(settings: Settings) -> str | None:
    """Name of the setting that says how large the load is, where a number does."""
    known = variable(settings)
    names = (name for name in loads_of(settings) if name in known)
    return next((name for name in names if isinstance(known[name], param.Number)), None)


def _map(settings: Settings, across: str | None, up: str | None, of: str) -> Question | None:
    """Ask over two settings, from a tenth of what their sliders reach on."""
    known, vary = variable(settings), []
    for name in (across, up):
        if name is None or not isinstance(known.get(name), param.Number):
            return None
        end = known[name].softbounds[getattr(settings, name) >= 0.0]
        low, high = sorted((TENTH * end, end))
        vary.append(f"{name}={low:g}:{high:g}:{COARSE}")
    return Question(tuple(vary), of)


READY: dict[str, tuple[str, Callable[[Settings], Question | None]]] = {
    "The bathtub": (
        "Iterations over the factor on k, with and without acceleration. It is steepest with the "
        "paper's method.",
        bathtub,
    ),
    "The bathtub over substructures": (
        "Iterations over the factor on k, for several numbers of substructures.",
        lambda settings: _iterations(settings, "substructures"),
    ),
    "The design chart": ("Energy dissipated over friction and load.", _design),
    "The fretting map": (
        "Share of the contact that slips at once in the last cycle, over the load and what "
        "presses: 0 is stick, 1 gross slip.",
        _fretting,
    ),
    "The shakedown limit": (
        "How many times as far the load may swing to and fro until slip goes on for ever, over "
        "friction. Below 1 it does so now. Pressed twice as hard, it is twice as much.",
        _shakedown,
    ),
}
"""Questions that are ready, by what their buttons say, with a word on each."""
