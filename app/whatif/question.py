"""What the tab *What if* asks: one or two settings over their values, and a quantity."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from urllib.parse import parse_qsl

import param

from app.components.form import item_of
from app.controls.refusals import refused, sentence
from app.picture.shown import has_reference
from app.picture.units import BY_SIZE
from app.picture.usual import WATCH, hurried
from solver.definitions import CurveParameter, Parameter, SettingError, about
from solver.settings import Settings
from solver.study.quantities.quantities import QUANTITIES, reading
from solver.study.quantities.quantity import Quantity
from solver.study.sweep import Plan, plan_of
from solver.study.sweep.plan import axis_of

EVEN, DECADES, LISTED = "even", "log", "list"
"""How values are given: in even steps, in even ratios, or one by one."""
VARY, OF = "vary", "of"
"""Names in an address: settings with their values, and the quantity."""
VALUES = 13
"""Values of a range."""
TENTH = 0.1
BESIDE = ("peak_friction", "end_displacement", "stiffness", "dissipation", "stuck_share")
"""Taken of every run for the table and its plots: together 1 to 6 % of its time (measured)."""


@dataclass(frozen=True)
class Span:
    """A setting and its values, as they are typed.

    Attributes
    ----------
    name
        Of the setting; empty for no setting.
    low, high, count
        Of a range.
    spacing
        Whether that is even, of decades, or the values are `listed`, commas between them.
    """

    name: str = ""
    low: str = ""
    high: str = ""
    count: str = str(VALUES)
    spacing: str = EVEN
    listed: str = ""

    @property
    def text(self) -> str:
        """What the command line takes for it."""
        if self.spacing == LISTED:
            return f"{self.name}={self.listed.replace(' ', '')}"
        end = ":log" if self.spacing == DECADES else ""
        return f"{self.name}={self.low}:{self.high}:{self.count}{end}".replace(" ", "")

    def refusal(self, settings: Settings, units: str) -> str:
        """Say what of its fields cannot be run, or nothing."""
        listed = self.spacing == LISTED
        boxes = {} if listed else {"from": self.low, "to": self.high, "values": self.count}
        for box, text in boxes.items():
            try:
                float(text)
            except ValueError:
                return f"“{text}” under “{box}” is no number." if text else f"Fill in “{box}”."
        if listed and not self.listed.strip():
            return "Choose at least one value."
        try:
            axis_of(settings, self.text)
        except SettingError as refusal:
            if refusal.value == self.text.partition("=")[2]:
                return sentence(refusal.remedy)
            return refused(refusal, settings, units=units)
        return ""


@dataclass(frozen=True)
class Question:
    """One or two settings, and what is asked of the runs, as the command line takes it."""

    spans: tuple[Span, ...]
    of: str

    @property
    def vary(self) -> list[str]:
        """The settings with their values, as the command line takes them."""
        return [span.text for span in self.spans]

    def plan(self, settings: Settings) -> Plan:
        """Make the plan of it, everything else as in some settings.

        Raises
        ------
        SettingError
            For whatever of it cannot be run.
        """
        beside = [name for name in BESIDE if QUANTITIES[name].applies(settings)]
        plan = plan_of(self.asked(settings), self.vary, [self.of, *beside])
        for name in plan.idle():
            remedy = "vary another setting"
            raise SettingError(name, "varied", "settings that do something here", remedy)
        return plan

    def asked(self, settings: Settings) -> Settings:
        """Give the settings of the runs that answer it beside those of the page.

        At once, as nobody watches them; where LATIN's own iterations are counted, these go on until
        they are within what is asked.
        """
        if settings.finish == "none":
            return settings
        name = self.of.partition("@")[0]
        if not name.startswith("iterations"):
            return hurried(settings)
        with contextlib.suppress(SettingError):
            asked = reading(self.of).at or settings.accuracy
            nearer = min(asked, settings.accuracy)
            return settings.replace(finish=WATCH, accuracy=nearer)
        return settings

    def refusals(self, settings: Settings, units: str = BY_SIZE) -> dict[str, str]:
        """Say what of it cannot be run, by the place of a setting, "of", or else "all"."""
        found = {
            str(place): words
            for place, span in enumerate(self.spans)
            if (words := span.refusal(settings, units))
        }
        try:
            reading(self.of)
        except SettingError as refusal:
            _, _, number = refusal.allowed.partition("@ and ")
            found[OF] = f"Beside it stands {number}." if number else sentence(refusal.remedy)
        if not found:
            try:
                self.plan(settings)
            except SettingError as refusal:
                known = refusal.name in settings.definitions()
                words = refused(refusal, settings, units=units)
                found["all"] = words if known else sentence(refusal.remedy)
        return found

    def pairs(self) -> list[tuple[str, str]]:
        """Give what an address has of it."""
        return [*((VARY, text) for text in self.vary), (OF, self.of)]


def question_from_query(query: str) -> Question | None:
    """Read from an address what is asked, if it asks anything; nothing of it is refused yet."""
    pairs = parse_qsl(query.lstrip("?"))
    spans = tuple(_read(text) for name, text in pairs if name == VARY)[:2]
    asked = dict(pairs).get(OF, "")
    return Question(spans, asked) if spans and asked else None


def _read(text: str) -> Span:
    name, _, values = text.partition("=")
    if ":" not in values:
        return Span(name, spacing=LISTED, listed=values)
    low, high, *rest = values.split(":")
    is_log = rest[-1:] == [DECADES]
    count = ":".join(rest[:-1] if is_log else rest)
    return Span(name, low, high, count, DECADES if is_log else EVEN)


def offered(settings: Settings) -> dict[str, Parameter]:
    """Give the settings that may vary: those that do something here and have several values."""
    return {
        name: definition
        for name, definition in settings.definitions().items()
        if settings.applies(name) and item_of(name, definition) is not None
    }


def askable(settings: Settings) -> dict[str, Quantity]:
    """Give the quantities that runs of these settings may have."""
    known = has_reference(settings)
    return {
        name: one
        for name, one in QUANTITIES.items()
        if one.applies(settings) and (known or one.reads != "errors")
    }


def usual_span(definition: Parameter, name: str) -> Span:
    """Give the values that are proposed for a setting: what its slider shows, or all its names."""
    if not isinstance(definition, param.Number):
        return Span(name, spacing=LISTED, listed=",".join(names_of(definition)))
    low, high = shown_range(definition)
    is_log = about(definition).logarithmic and low > 0
    return Span(name, f"{low:g}", f"{high:g}", str(VALUES), DECADES if is_log else EVEN)


def shown_range(definition: Parameter) -> tuple[float, float]:
    """Give the ends of a number's slider."""
    item = item_of("", definition)
    assert item is not None
    return item["start"], item["end"]


def names_of(definition: Parameter) -> list[str]:
    """Give the names among which a setting chooses; none for a number."""
    if isinstance(definition, param.Boolean):
        return ["false", "true"]
    if isinstance(definition, CurveParameter):
        return list(definition.presets)
    return list(definition.objects) if isinstance(definition, param.Selector) else []


def changed_span(settings: Settings, before: Span, wanted: Mapping[str, str]) -> Span:
    """Follow what somebody has typed; another setting brings its own values, a list begins full."""
    after = replace(before, **{name: str(value) for name, value in wanted.items()})
    definition = settings.definitions().get(after.name)
    if definition is None:
        return after
    usual = usual_span(definition, after.name)
    if after.name != before.name or (after.spacing != LISTED and not after.low):
        return usual
    if after.spacing == LISTED and before.spacing != LISTED:
        with contextlib.suppress(SettingError):
            values = axis_of(settings, before.text).values
            return replace(after, listed=",".join(map(json.dumps, values)))
    return after


def changed_quantity(name: str, at: str) -> str:
    """Name a quantity with its parameter; one that needs one has a tenth."""
    quantity = QUANTITIES.get(name)
    parameter = quantity.parameter if quantity else None
    if parameter is None:
        return name
    at = at.strip() or (str(TENTH) if parameter.needed else "")
    return f"{name}@{at}" if at else name
