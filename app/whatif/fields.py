"""What the fields of a question offer and say, in the units of the page; questions are in SI."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from app.controls.refusals import field_of
from app.picture.labels import label_of
from app.picture.units import BY_SIZE, SYSTEMS, steps
from app.picture.usual import changed
from app.whatif.question import Question, Span, askable, names_of, offered
from app.whatif.ready import READY
from solver.definitions import about
from solver.settings import Settings
from solver.study.quantities.quantities import QUANTITIES

NO_SECOND = Span()
VALUES = "low", "high", "listed"
"""What of a span has the unit of its setting."""


def watched(settings: Settings, wanted: Settings, varied: Collection[str]) -> Settings:
    """Give the settings of a point as a page watches its run: to the end that it wants to see."""
    ends = {"accuracy"} if settings.finish == "none" else {"accuracy", "finish"}
    return settings.replace(**{name: getattr(wanted, name) for name in ends - set(varied)})


def in_si(settings: Settings, span: Mapping[str, str]) -> dict[str, str]:
    """Turn what is typed of a span into SI; `unit` names the unit that stood beside it."""
    definition = settings.definitions().get(span.get("name", ""))
    unit = about(definition).unit if definition is not None else ""
    known = {one.name: one.factor for system in SYSTEMS for one in steps(unit, system)}
    factor = known.get(span.get("unit", ""), 1.0)
    texts = {name: text for name, text in span.items() if name != "unit"}
    return texts | {name: _times(texts[name], factor) for name in VALUES if name in texts}


def _shown(span: Span, settings: Settings, units: str) -> dict[str, Any]:
    """Give a span as its fields show it: in the unit of the sidebar, whatever is typed."""
    definition = settings.definitions().get(span.name)
    if definition is None:
        return {**vars(span), "unit": ""}
    factor, unit = field_of(settings, span.name, units)
    texts = {name: _times(getattr(span, name), 1.0 / factor) for name in VALUES}
    return {**vars(span), **texts, "unit": unit}


def _times(text: str, factor: float) -> str:
    """Multiply the numbers of a text, commas between them; what is none stays as it is."""
    if factor == 1.0:
        return text
    parts = []
    for one in text.split(","):
        try:
            parts.append(f"{float(one) * factor:.12g}")
        except ValueError:
            parts.append(one)
    return ",".join(parts)


def form_of(question: Question, settings: Settings, units: str = BY_SIZE) -> dict[str, Any]:
    """Say what the fields offer, what they say, and what of it is refused."""
    definitions = settings.definitions()
    names = offered(settings)
    names |= {one.name: definitions[one.name] for one in question.spans if one.name in definitions}
    quantity, _, at = question.of.partition("@")
    quantities = askable(settings)
    quantities |= {quantity: QUANTITIES[quantity]} if quantity in QUANTITIES else {}
    varied = {one.name for one in question.spans}
    rest = {name: value for name, value in changed(settings).items() if name not in varied}
    title = label_of(settings, rest, units, most=len(rest))
    return {
        "settings": [
            {"name": name, "title": about(one).title, "of": names_of(one)}
            for name, one in names.items()
        ],
        "spans": [_shown(one, settings, units) for one in (*question.spans, NO_SECOND)[:2]],
        "quantities": [
            {"name": name, "title": one.title, "at": one.parameter.words if one.parameter else ""}
            for name, one in quantities.items()
        ],
        "quantity": quantity,
        "at": at,
        "refusals": question.refusals(settings, units),
        "ready": [[title, help] for title, (help, make) in READY.items() if make(settings)],
        "rest": title or "defaults",
    }
