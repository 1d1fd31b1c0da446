"""Questions of the tab What if: a quantity over one or two settings."""

from __future__ import annotations

import contextlib
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
import param

from app.refusals import message_of
from app.state import SEARCH, answer
from app.worker.references import has_reference
from solver.refusal import RefusedError
from solver.settings.definitions import (
    Parameter,
    is_logarithmic,
    names_of,
    properties_of,
)
from solver.settings.scene import Settings
from solver.study.quantities import QUANTITIES, reading
from solver.study.quantities.quantity import Quantity
from solver.study.sweep.plan import Plan, plan_of

LOG = ":log"
VALUES = 13
COARSE = 10
"""Numbers of values of a range, and along each side of a map."""
TENTH = 0.1
HUNDREDTH = 0.01
SHARES = (
    1.0,
    0.9,
    0.8,
    0.7,
    0.6,
    0.5,
    0.4,
    0.3,
    0.2,
    0.1,
    0.07,
    0.05,
    0.03,
    0.02,
    0.01,
)
"""Shares of a slider that the values of a load may end at, from the largest on: a belt
or a wire carries less than its slider has."""
COURSES = (4, 6, 8, 10)
"""Numbers of courses of bricks that are compared: all runs take less than a minute."""


@dataclass(frozen=True)
class Question:
    """A quantity over the values of one or two settings."""

    vary: tuple[str, ...]
    """`NAME=LOW:HIGH:COUNT`, the same with `:log`, or `NAME=VALUE,VALUE,...`; in SI."""
    of: str
    """A quantity, as `dissipation` or `iterations_to_force@0.01`."""

    def __str__(self) -> str:
        return " ".join((*self.vary, self.of))

    def plan(self, settings: Settings) -> Plan:
        """Plan of the runs that answer the question, with other settings as given.

        Raises
        ------
        RefusedError
            If the runs cannot be done, or a setting does nothing in them.
        """
        plan = plan_of(self.asked(settings), self.vary, [self.of])
        for name in plan.idle():
            can = "settings that do something here"
            raise RefusedError(name, "varied", can, "vary another setting")
        return plan

    def asked(self, settings: Settings) -> Settings:
        """Settings of the runs that answer the question, from those of the page.

        Runs finish at once, as nobody watches them; where LATIN's own iterations are
        counted, they continue to the accuracy of the question.
        """
        if settings.finish == "none":
            return settings
        if not self.of.startswith("iterations"):
            return answer(settings)
        # A quantity that does not exist is refused by `plan`.
        with contextlib.suppress(RefusedError):
            accuracy = settings.accuracy
            threshold = reading(self.of).at
            if threshold:
                accuracy = min(threshold, accuracy)
            return settings.replace(finish=SEARCH["finish"], accuracy=accuracy)
        return settings

    def refusal(self, settings: Settings) -> str:
        """Reason why the question cannot be run, or ""."""
        try:
            self.plan(settings)
        except RefusedError as refusal:
            return message_of(refusal, settings)
        return ""


def question_of(text: str, settings: Settings) -> Question:
    """Question from a text; the first ready question if settings lack its terms."""
    *vary, of = text.split() or [""]
    question = Question(tuple(vary), of)
    # The text may come from an address, or from a scene that has other settings.
    names = {setting.partition("=")[0] for setting in vary}
    quantity = QUANTITIES.get(of.partition("@")[0])
    if quantity is not None and can_be_read(quantity, settings):
        if names <= variable(settings).keys() and not question.refusal(settings):
            return question
    ready = [make(settings) for make in READY.values()]
    return next(question for question in ready if question is not None)


def variable(settings: Settings) -> dict[str, Parameter]:
    """Settings that may vary: those with an effect and several values."""
    known = {}
    for name, definition in settings.definitions().items():
        is_number = isinstance(definition, param.Number)
        has_several = is_number or len(names_of(definition)) > 1
        if has_several and settings.applies(name):
            known[name] = definition
    return known


def quantities(settings: Settings) -> dict[str, Quantity]:
    """Quantities that runs of these settings may have."""
    known = {}
    for name, quantity in QUANTITIES.items():
        if can_be_read(quantity, settings):
            known[name] = quantity
    return known


def can_be_read(quantity: Quantity, settings: Settings) -> bool:
    """Check whether runs of these settings may have a quantity."""
    if quantity.reads == "errors" and not has_reference(settings):
        return False
    return quantity.applies(settings)


def proposed(settings: Settings, name: str) -> str:
    """Proposed values of a setting: the range of its slider, or all its names."""
    definition = settings.definitions()[name]
    if not isinstance(definition, param.Number):
        return f"{name}={','.join(names_of(definition))}"
    low, high = definition.softbounds
    return _range(name, low, high, VALUES, is_log=is_logarithmic(definition))


def _range(name: str, low: float, high: float, count: int, *, is_log: bool) -> str:
    """Text of a range of values between two ends, in equal steps or ratios."""
    text = f"{name}={low:g}:{high:g}:{count}"
    if is_log:
        text += LOG
    return text


def iterations_over_k(settings: Settings) -> Question:
    """Iterations over the search direction, with and without acceleration."""
    vary = [proposed(settings, "k_scale")]
    if "acceleration" in variable(settings):
        vary.append(proposed(settings, "acceleration"))
    return _iterations(settings, TENTH, *vary)


def _iterations(settings: Settings, accuracy: float, *vary: str) -> Question:
    """Question of iterations to an accuracy; of all iterations without a reference."""
    of = "iterations"
    if has_reference(settings):
        of = f"iterations_to_force@{accuracy}"
    return Question(vary, of)


def _bricks(settings: Settings) -> Question | None:
    """Question of iterations over the courses, with and without the macro problem.

    The load passes from course to course. Without courses there is no question (None).
    """
    if "courses" not in variable(settings):
        return None
    courses = ",".join(str(count) for count in COURSES)
    return _iterations(
        settings, HUNDREDTH, f"courses={courses}", "multiscale=true,false"
    )


def _energy(settings: Settings, count: int, *others: str) -> Question | None:
    """Question of energy over load and other settings, over a decade of sliders.

    The decade ends where the scene takes all its values. There is no question (None)
    where no number sets the size of the load, another setting does nothing, or no
    decade is taken. A positive load that varies alone has values of even ratios.
    """
    known = variable(settings)
    numbers = [name for name in known if isinstance(known[name], param.Number)]
    load = _load_of(settings, numbers)
    if load is None or not set(others) <= set(numbers):
        return None
    fixed = [_decade(settings, name, 1.0, count, is_log=False) for name in others]
    for share in SHARES:
        varied = _decade(settings, load, share, count, is_log=not others)
        question = Question((*fixed, varied), "dissipation")
        if _is_taken(question, settings):
            return question
    return None


def _decade(
    settings: Settings, name: str, share: float, count: int, *, is_log: bool
) -> str:
    """Text of a decade of values, up to a share of an end of the slider.

    It is the end that has the sign of the present value.
    """
    low, high = settings.definitions()[name].softbounds
    if getattr(settings, name) >= 0.0:
        end = share * high
    else:
        end = share * low
    low, high = sorted((TENTH * end, end))
    return _range(name, low, high, count, is_log=is_log and end > 0.0)


def _is_taken(question: Question, settings: Settings) -> bool:
    """Check whether the scene takes the values at all ends of a question's ranges."""
    try:
        plan = plan_of(settings, question.vary, [question.of])
        ends = [(0, count - 1) for count in plan.shape]
        for levels in product(*ends):
            plan.settings_at(int(np.ravel_multi_index(levels, plan.shape)))
    except RefusedError:
        return False
    return True


def _load_of(settings: Settings, numbers: list[str]) -> str | None:
    """The setting of the main load: the first number that scales a load path."""
    definitions = settings.definitions()
    for name in (*settings.CHIEF, *numbers):
        if name in numbers and properties_of(definitions[name]).path:
            return name
    return None


TEXTS = tomllib.loads(
    (Path(__file__).parent / "texts.toml").read_text(encoding="utf-8")
)
"""Sentences on each question and report, by the label of its button."""
READY: dict[str, Callable[[Settings], Question | None]] = {
    # For small amplitudes the energy in rods grows with their third power (Masing).
    "Energy over amplitude": lambda given: _energy(given, VALUES),
    "Iterations over k": iterations_over_k,
    "Iterations over bricks": _bricks,
    "Energy over friction and load": lambda given: _energy(given, COARSE, "friction"),
}
"""Ready questions, by the labels of their buttons."""
