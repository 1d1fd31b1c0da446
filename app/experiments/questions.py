"""What the tab What if asks: a quantity over one or two settings, and the fields of a setting."""

from __future__ import annotations

import contextlib
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.refusals import message_of
from app.state import SEARCH, answer
from app.units import typed, unit_of
from app.worker.references import has_reference
from solver.refusal import RefusedError
from solver.settings.definitions import (
    CurveParameter,
    Parameter,
    about,
    is_logarithmic,
    title_of,
)
from solver.settings.scene import Settings
from solver.study.quantities import QUANTITIES, reading
from solver.study.quantities.quantity import Quantity
from solver.study.sweep.plan import Plan, plan_of

FIELD: dict[str, Any] = {"size": "small", "margin": (5, 6)}
LOG = ":log"
GRAMMAR = (
    "FROM:TO:NUMBER are so many values in even steps, FROM:TO:NUMBER:log in even ratios; "
    "others stand between commas."
)
VALUES = 13
COARSE = 10
"""Values of a range, and along each side of a map."""
TENTH = 0.1
HUNDREDTH = 0.01
COURSES = (4, 6, 8, 10)
"""Courses of bricks that are compared: all runs take less than a minute."""


@dataclass(frozen=True)
class Question:
    """One or two settings over their values, and a quantity."""

    vary: tuple[str, ...]
    """`NAME=LOW:HIGH:COUNT`, the same with `:log`, or `NAME=VALUE,VALUE,...`; in SI."""
    of: str
    """A quantity, as `dissipation` or `iterations_to_force@0.01`."""

    def __str__(self) -> str:
        return " ".join((*self.vary, self.of))

    def plan(self, settings: Settings) -> Plan:
        """The runs that answer it, everything else as in some settings; they may be refused."""
        plan = plan_of(self.asked(settings), self.vary, [self.of])
        for name in plan.idle():
            can = "settings that do something here"
            raise RefusedError(name, "varied", can, "vary another setting")
        return plan

    def asked(self, settings: Settings) -> Settings:
        """Settings of the runs that answer it beside those of the page.

        At once, as nobody watches them; where LATIN's own iterations are counted, these
        go on until they are within what is asked.
        """
        if settings.finish == "none":
            return settings
        if not self.of.startswith("iterations"):
            return answer(settings)
        with contextlib.suppress(RefusedError):
            nearer = min(reading(self.of).at or settings.accuracy, settings.accuracy)
            return settings.replace(finish=SEARCH["finish"], accuracy=nearer)
        return settings

    def refusal(self, settings: Settings) -> str:
        """What of it cannot be run and why, or nothing."""
        try:
            self.plan(settings)
        except RefusedError as refusal:
            return message_of(refusal, settings)
        return ""


def question_of(text: str, settings: Settings) -> Question:
    """The question that a text asks; where settings do not have it, the first that is ready."""
    *vary, of = text.split() or [""]
    question = Question(tuple(vary), of)
    names = {setting.partition("=")[0] for setting in vary}
    is_known = names <= variable(settings).keys() and of.partition("@")[
        0
    ] in quantities(settings)
    if is_known and not question.refusal(settings):
        return question
    return next(
        ready for make in READY.values() if (ready := make(settings)) is not None
    )


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
        if quantity.applies(settings)
        and (has_reference(settings) or quantity.reads != "errors")
    }


def names_of(definition: Parameter) -> list[str]:
    """Values of a setting that are no numbers."""
    if isinstance(definition, param.Boolean):
        return ["false", "true"]
    if isinstance(definition, CurveParameter):
        return list(definition.presets)
    if isinstance(definition, param.Selector):
        return list(definition.objects)
    return []


def proposed(settings: Settings, name: str) -> str:
    """Values that are proposed for a setting: what its slider shows, or all its names."""
    definition = settings.definitions()[name]
    if not isinstance(definition, param.Number):
        return f"{name}={','.join(names_of(definition))}"
    low, high = definition.softbounds
    return f"{name}={low:g}:{high:g}:{VALUES}{LOG * is_logarithmic(definition)}"


def iterations_over_k(settings: Settings) -> Question:
    """Iterations over the search direction, with and without acceleration."""
    names = "k_scale", *["acceleration"] * ("acceleration" in variable(settings))
    return _iterations(settings, TENTH, *(proposed(settings, name) for name in names))


def _iterations(settings: Settings, within: float, *vary: str) -> Question:
    """Iterations until the force is within a share, or else all, over settings."""
    if has_reference(settings):
        of = f"iterations_to_force@{within}"
    else:
        of = "iterations"
    return Question(vary, of)


def _bricks(settings: Settings) -> Question | None:
    """Over the courses, which the load passes one after the other; more bricks a course help."""
    if "courses" not in variable(settings):
        return None
    courses = ",".join(map(str, COURSES))
    return _iterations(
        settings, HUNDREDTH, f"courses={courses}", "multiscale=true,false"
    )


def _energy(settings: Settings, count: int, *others: str) -> Question | None:
    """Energy over other settings and the load, from a tenth of what their sliders reach on.

    None where no number says how large the load is, or one of the others does nothing.
    The values of a load alone that is positive have even ratios.
    """
    known = variable(settings)
    vary = []
    numbers = [name for name in known if isinstance(known[name], param.Number)]
    loads = [
        n for n in (*settings.CHIEF, *numbers) if n in numbers and about(known[n]).path
    ]
    if not loads or not {*others} <= {*numbers}:
        return None
    for name in (*others, loads[0]):
        end = known[name].softbounds[getattr(settings, name) >= 0.0]
        low, high = sorted((TENTH * end, end))
        is_log = not others and end > 0.0
        vary.append(f"{name}={low:g}:{high:g}:{count}{LOG * is_log}")
    return Question(tuple(vary), "dissipation")


TEXTS = tomllib.loads(
    (Path(__file__).parent / "texts.toml").read_text(encoding="utf-8")
)
"""A word on each question and report, by what its button says."""
READY: dict[str, Callable[[Settings], Question | None]] = {
    # Small ones take its third power along rods (Masing).
    "Energy over amplitude": lambda given: _energy(given, VALUES),
    "Iterations over k": iterations_over_k,
    "Iterations over bricks": _bricks,
    "Energy over friction and load": lambda given: _energy(given, COARSE, "friction"),
}
"""Questions that are ready, by what their buttons say."""


class Span:
    """The fields of one setting, if there is one, and its values.

    `changed` is called when somebody has changed a field.
    """

    def __init__(
        self, label: str, changed: Callable[[], object], *, is_optional: bool
    ) -> None:
        if is_optional:
            self._nothing = {"–": ""}
        else:
            self._nothing = {}
        self._changed = changed
        self._is_updating = False
        self.name = pmui.Select(
            label=label, options={"–": ""}, value="", width=260, **FIELD
        )
        self.values = pmui.TextInput(
            label="Values", description=GRAMMAR, width=330, **FIELD
        )
        self.view = pn.FlexBox(self.name, self.values)
        for field in self.view:
            field.param.watch(self._on_field, "value")

    def show(self, settings: Settings, text: str) -> None:
        """Show a setting and its values, in the unit of its control; "" is none."""
        self._settings = settings
        self._is_updating = True
        name, _, values = text.partition("=")
        titles = {
            _titled(known, settings): key for key, known in variable(settings).items()
        }
        self.name.param.update(options={**self._nothing, **titles}, value=name)
        definition = settings.definitions().get(name)
        label = "Values"
        if isinstance(definition, param.Number):
            unit = unit_of(definition)
            label = unit.titled(label)
            values = _converted(
                values, lambda text: f"{float(text) / unit.factor:.10g}"
            )
        elif definition is not None:
            label = f"Values: {', '.join(names_of(definition))}"
        self.values.param.update(label=label, value=values, visible=bool(name))
        self._is_updating = False

    def text(self) -> str:
        """The setting and its values in SI, "" for none; a ValueError for what is no number."""
        name = self.name.value
        if not name:
            return ""
        definition = self._settings.definitions()[name]
        values = self.values.value
        if isinstance(definition, param.Number):
            unit = unit_of(definition)
            si = about(definition).unit
            values = _converted(values, lambda text: f"{typed(text, unit, si):.12g}")
        return f"{name}={values.replace(' ', '')}"

    def _on_field(self, event: param.parameterized.Event) -> None:
        """Have the question changed; another setting brings its own values."""
        if self._is_updating:
            return
        if event.obj is self.name:
            self.show(
                self._settings, proposed(self._settings, event.new) if event.new else ""
            )
        self._changed()


def _converted(values: str, convert: Callable[[str], str]) -> str:
    """The ends of a range, or all numbers of a list, each as a function gives it."""
    sign = ":" if ":" in values else ","
    parts = values.split(sign)
    if sign == ":":
        ends = 2
    else:
        ends = len(parts)
    return sign.join([*map(convert, parts[:ends]), *parts[ends:]])


def _titled(definition: Parameter, settings: Settings) -> str:
    """Title of a setting, with its group where another has the same."""
    titles = [title_of(other) for other in settings.definitions().values()]
    title = title_of(definition)
    if titles.count(title) > 1:
        return f"{title} ({about(definition).group})"
    return title
