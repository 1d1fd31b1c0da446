"""Case of the trade: a question, the run that answers it, and a known number."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from solver.files.saved import head_of
from solver.files.toml_files import (
    check_controls,
    check_keys,
    fields_in,
    placed,
    read_toml,
    require,
)
from solver.settings.definitions import properties_of
from solver.settings.scene import Icon, Settings
from solver.settings.values import SettingError
from solver.study.quantities import reading
from solver.study.quantities.quantity import Quantity

ANSWERS_STAY = "Decomposition", "Method", "Stop"
"""Groups of settings on which the known value does not depend."""
PLACES = "below", "around"
ORIENTATIONS = "level", "upright"
Part = TypeVar("Part")


@dataclass(frozen=True)
class PlotFlag:
    """Mark of the known value on a plot, which the name of its tab identifies.

    It is at `x` and `y` on the axes of the plot, SI, or at any `x` without one.
    """

    plot: str
    y: float
    text: str
    x: float = math.nan


@dataclass(frozen=True)
class Surroundings:
    """Ground drawn below or around the bodies, and orientation of the bodies.

    Upright ones have their left end on top.
    """

    ground: str
    place: str = "below"
    orientation: str = "level"

    @property
    def is_upright(self) -> bool:
        """Check whether the bodies stand upright."""
        return self.orientation == "upright"


@dataclass(frozen=True, eq=False)
class Case:
    """A case by its file, whose name it has (`cases/README.md` explains the keys)."""

    name: str
    order: int
    title: str
    question: str
    source: str
    settings: Settings
    quantity: Quantity
    known: float
    tolerance: float
    formula: str
    how: str
    change: str
    controls: tuple[str, ...]
    picture: Icon
    typeset: str = ""
    """The formula in TeX, as a page has it."""
    views: tuple[str, ...] = ()
    sentence: str = ""
    instant: float = 1.0
    flag: PlotFlag | None = None
    surroundings: Surroundings | None = None

    def knows(self, settings: Settings) -> bool:
        """Check whether settings differ from the case's in mesh and method only."""
        definitions = settings.definitions()
        # They change what is found, and not what is known.
        mesh = {*settings.MESH, "instants"}
        return all(
            name in mesh or properties_of(definitions[name]).group in ANSWERS_STAY
            for name in settings.changed(self.settings)
        )

    def sentence_on(self, sentence: str) -> str:
        """The case's sentence on a run, from the scene's sentence.

        It ends with what the scene says of the run and not of the case.
        """
        if not self.sentence:
            return sentence
        known = clauses_in(self.settings.sentence())
        new = [each for each in clauses_in(sentence)[1:] if each not in known]
        if not new:
            return self.sentence
        return f"{self.sentence} Now: {', '.join(new)}."


def clauses_in(sentence: str) -> list[str]:
    """Clauses of a sentence of a scene."""
    return re.split(r"[;,] (?:and )?", sentence.rstrip("."))


def case_from_file(path: Path) -> Case:
    """Read a case: a file of settings with a table `case`.

    The message of a refusal begins with the name of the file.
    """
    with placed(path.name):
        values = read_toml(path, "case")
        entries = values.pop("case", None)
        kind, _ = head_of(values)
        if not isinstance(entries, dict):
            raise SettingError(
                "case", entries, "a table", "write [case] below the settings"
            )
        settings = kind.checked(values)
        with placed("case"):
            # A case without a picture of its own has that of its scene.
            entries = {"picture": settings.icon._asdict(), **entries}
            tables = dict.fromkeys(("picture", "flag", "surroundings"), dict)
            fields = fields_in(Case, entries, quantity=str, **tables)
            _check_numbers(fields)
            check_controls(fields["controls"], settings)
            check_keys(fields["picture"], dict.fromkeys(Icon._fields, str))
            for name, kind_of_part in (
                ("flag", PlotFlag),
                ("surroundings", Surroundings),
            ):
                if name in fields:
                    fields[name] = _part(kind_of_part, fields[name], name)
            fields["quantity"] = reading(fields["quantity"])
            fields["picture"] = Icon(**fields["picture"])
        return Case(name=path.stem, settings=settings, **fields)


def _check_numbers(fields: Mapping[str, Any]) -> None:
    """Refuse zero as the known number, and a tolerance or instant that is no share."""
    known = fields["known"]
    is_divisor = math.isfinite(known) and known != 0.0
    can = "a finite number other than zero"
    require(is_divisor, "known", known, can, "deviations are shares of it")
    tolerance = fields["tolerance"]
    is_share = 0.0 < tolerance < 1.0
    can = "a share above 0 and below 1"
    require(is_share, "tolerance", tolerance, can, "say what the mesh leaves")
    instant = fields.get("instant", 1.0)
    remedy = "give it as a share of the interval"
    require(0.0 <= instant <= 1.0, "instant", instant, "0 to 1", remedy)


def _part(kind: type[Part], values: dict[str, Any], name: str) -> Part:
    """A part of a case from its table; refuse unknown positions and orientations."""
    with placed(name):
        part = kind(**fields_in(kind, values))
        for key, allowed in (("place", PLACES), ("orientation", ORIENTATIONS)):
            value = getattr(part, key, allowed[0])
            listed = ", ".join(allowed)
            require(value in allowed, key, value, listed, "choose one of these")
    return part


@cache
def cases_by_name() -> dict[str, Case]:
    """Cases of the folder `cases` by name, in their order."""
    files = Path(__file__).with_name("cases").glob("*.toml")
    cases = [case_from_file(file) for file in files]
    cases.sort(key=lambda case: case.order)
    return {case.name: case for case in cases}
