"""A page's address: its settings, and what of the run is looked at."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from textwrap import shorten
from typing import Any
from urllib.parse import parse_qsl, quote

from app.controls.refusals import refused_by_name, title_and_name
from app.languages.language import LANGUAGES, SOURCE
from app.lessons.lesson import LESSONS
from app.picture.labels import changes_of
from app.picture.shown import Look
from app.picture.units import BY_SIZE, SYSTEMS
from app.picture.usual import usual_settings
from app.session.classroom import ROOMS, Room
from app.session.state import DEFAULT_PACE, PACES, TABS, VIEWS
from app.views.catalogue import VIEWS as CATALOGUE
from app.whatif.question import OF, VARY, Question
from solver.definitions import SettingError, checked_value, choice, count, parse, quantity
from solver.files import scene_settings
from solver.lessons.lesson import Lesson
from solver.scenes import CATALOGUE as SCENES
from solver.settings import Settings

DEFAULT_SCENE = next(iter(SCENES))
TAB_OF = {tab.lower(): tab for tab in TABS}
"""Who writes an address by hand need not mind their case."""
CLASS = "class"
"""Names in an address the class that a page follows."""
MOST_STEPS = 100_000
MOST_TOLD = 3
LONGEST_NAME = 40


@dataclass(frozen=True)
class Sight:
    """What is looked at.

    Attributes
    ----------
    instant
        As a share of the interval.
    iteration
        At which the run waits; 0 has it go on.
    theme
        "light" or "dark"; the browser writes it where it is not the system's.
    view
        "page" has controls, "present" is for a projector, "embed" for a frame in a course page.
    units
        One of `app.picture.units.SYSTEMS`.
    plots
        Names of the views that are drawn, separated by commas; empty has one on each card.
    lang
        Language of all words; empty leaves it to the browser.
    is_still
        Whether it names an instant, or an iteration.
    """

    tab: str = TABS[0]
    instant: float = Look().phase
    pace: str = DEFAULT_PACE
    lesson: str = ""
    iteration: int = 0
    theme: str = "light"
    view: str = VIEWS[0]
    units: str = BY_SIZE
    plots: str = ""
    lang: str = ""
    is_still: bool = field(default=False, compare=False)


SIGHT: dict[str, Any] = {
    "tab": choice(Sight.tab, TABS, "", group="", title=""),
    "instant": quantity(Sight.instant, (0.0, 1.0), (0.0, 1.0), "", group="", title=""),
    "pace": choice(Sight.pace, PACES, "", group="", title="", aliases={"100": "fastest"}),
    "lesson": choice(next(iter(LESSONS)), LESSONS, "", group="", title=""),
    "iteration": count(0, (0, MOST_STEPS), (0, MOST_STEPS), "", group="", title=""),
    "theme": choice(Sight.theme, ("light", "dark"), "", group="", title=""),
    "view": choice(Sight.view, VIEWS, "", group="", title=""),
    "lang": choice(SOURCE, LANGUAGES, "", group="", title=""),
    "units": choice(Sight.units, SYSTEMS, "", group="", title=""),
}
NUMBERS = ("instant", "iteration")
PLOTS = "plots"
PLOT = choice(CATALOGUE[0].name, [view.name for view in CATALOGUE], "", group="", title="")
LEFT_OUT = "file"
"""Names in an address a setting that has no room there: its table is too long."""
LONGEST_VALUE = 1500
"""Characters of a value in an address; mail, chat and proxies cut what is much longer."""
COMPARED = "compare"
"""Name in an address of what run A has other than the run at work, B, as a JSON object."""


def sight_from_query(query: str, units: str = BY_SIZE) -> tuple[Sight, str]:
    """Read from an address what is looked at; with what was refused and why, or nothing.

    Where it says nothing of units, it is in those that the browser keeps, if there are such.
    """
    found: dict[str, Any] = {}
    refused = []
    for name, text in parse_qsl(query.lstrip("?")):
        try:
            if name == PLOTS:
                found[name] = _plots(text)
            elif name in SIGHT:
                value = parse(text) if name in NUMBERS else TAB_OF.get(text.lower(), text)
                found[name] = checked_value(SIGHT[name], name, value)
        except SettingError as refusal:
            refused.append(str(refusal))
    kept = units if units in SYSTEMS else BY_SIZE
    first = replace(_first_sight(found.get("lesson", "")), units=kept)
    is_still = any(name in found for name in NUMBERS)
    return replace(first, **found, is_still=is_still), complaint_of(refused)


def _first_sight(lesson: str) -> Sight:
    """Say what is looked at where an address names nothing: a lesson has an instant of its own."""
    return Sight(lesson=lesson, instant=LESSONS[lesson].instant) if lesson else Sight()


def _plots(text: str) -> str:
    """Check names of views, separated by commas."""
    return ",".join(checked_value(PLOT, PLOTS, name.strip()) for name in text.split(","))


def settings_from_query(query: str) -> tuple[Settings, str]:
    """Read settings from a page's address.

    Returns
    -------
    settings
        Those of the address that are valid together; the others as its lesson has them, or their
        defaults.
    complaint
        What was refused and why, or empty.
    """
    pairs = dict(parse_qsl(query.lstrip("?")))
    lesson, scene = LESSONS.get(pairs.get("lesson", "")), pairs.pop("scene", "")
    try:
        base = _base(lesson, scene)
    except SettingError as refusal:
        return _base(lesson, ""), complaint_of([str(refusal)])
    definitions = base.definitions()
    values, refused = {}, []
    for name, text in pairs.items():
        if name in SIGHT or name in (CLASS, COMPARED, PLOTS, VARY, OF):
            continue
        if name == LEFT_OUT:
            refused.append(f"{shorten(text, LONGEST_NAME)} is too long for it: open its file")
            continue
        if name not in definitions and name not in base.RETIRED:
            refused.append(f"there is no setting {shorten(name, LONGEST_NAME)}")
            continue
        try:
            if name in base.RETIRED:
                base.RETIRED[name].check(name, parse(text))
            else:
                values[name] = checked_value(definitions[name], name, parse(text))
        except SettingError as refusal:
            refused.append(refused_by_name(refusal, base))
    settings, apart = _together(base, values)
    return settings, complaint_of([*refused, *apart])


def _base(lesson: Lesson | None, scene: str) -> Settings:
    """Give the settings from which an address says what differs."""
    if lesson is None:
        return usual_settings(scene_settings(scene or DEFAULT_SCENE))
    if scene not in ("", lesson.settings.scene):
        raise SettingError("scene", scene, lesson.settings.scene, "the lesson has its own")
    return lesson.settings


def twin_from_query(query: str, settings: Settings) -> tuple[Settings | None, str]:
    """Read from an address the settings of run A, if there is one; with what was refused and why.

    Parameters
    ----------
    query
        Of the address.
    settings
        Those of it, which hold for run A too where it says nothing else.
    """
    text = dict(parse_qsl(query.lstrip("?"))).get(COMPARED)
    if text is None:
        return None, ""
    try:
        return type(settings).checked({**settings.values(), **_object(text)}), ""
    except SettingError as refusal:
        return None, complaint_of([refused_by_name(refusal, settings)])


def _object(text: str) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise SettingError(COMPARED, text, "a JSON object of settings", 'write {"seed":2}')
    return found


def _together(base: Settings, values: dict[str, Any]) -> tuple[Settings, list[str]]:
    """Take as many values as are valid together; give the refusals of the others."""
    try:
        return base.replace(**values), []
    except SettingError:
        pass
    definitions = base.definitions()
    taken: dict[str, Any] = {}
    left = values
    refused: dict[str, str] = {}
    while left:
        # One that was refused may be valid beside one that came later.
        refused = {}
        for name, value in left.items():
            try:
                base.replace(**{**taken, name: value})
                taken[name] = value
            except SettingError as refusal:
                said, title = (
                    refused_by_name(refusal, base),
                    title_and_name(name, definitions[name]),
                )
                refused[name] = said if refusal.name == name else f"{title} is left out: {said}"
        if len(refused) == len(left):
            break
        left = {name: left[name] for name in refused}
    return base.replace(**taken), list(refused.values())


def complaint_of(refused: list[str]) -> str:
    """Say what an address has that is refused, at length for the first few."""
    if not refused:
        return ""
    more = len(refused) - MOST_TOLD
    rest = f"; and {more} more" if more > 0 else ""
    said = "; ".join(one.rstrip(".") for one in refused[:MOST_TOLD])
    return f"From the address: {said}{rest}."


def class_from_query(query: str) -> tuple[Room | None, str]:
    """Find the class that an address names; with its code if there is none at present."""
    code = dict(parse_qsl(query.lstrip("?"))).get(CLASS, "").strip()
    room = ROOMS.find(code)
    return room, code if room is None else ""


def query_of(
    settings: Settings,
    sight: Sight | None = None,
    room: Room | None = None,
    twin: Settings | None = None,
    question: Question | None = None,
) -> str:
    """Write what differs from the defaults, or from a lesson's settings, as a page's address."""
    sight = sight or Sight()
    lesson = LESSONS.get(sight.lesson)
    pairs = [(CLASS, room.code)] if room else [] if lesson else [("scene", settings.scene)]
    if room is None:
        long = left_out(settings, twin)
        changed = settings.changed(lesson.settings if lesson else usual_settings(type(settings)))
        pairs += [(name, json.dumps(value)) for name, value in changed.items() if name not in long]
        apart = changes_of(twin, settings) if twin else {}
        apart = {name: value for name, value in apart.items() if name not in long}
        pairs += [(COMPARED, json.dumps(apart, separators=(",", ":")))] if twin else []
        pairs += [(LEFT_OUT, ", ".join(long))] if long else []
    usual = {**asdict(_first_sight(sight.lesson)), "lesson": ""}
    looked_at = asdict(sight).items()
    pairs += [(name, str(value)) for name, value in looked_at if value != usual[name]]
    pairs += question.pairs() if question else []
    return "?" + "&".join(f"{name}={quote(text)}" for name, text in pairs)


def left_out(settings: Settings, twin: Settings | None = None) -> list[str]:
    """Name the settings whose values are too long for an address."""
    runs = [one.values() for one in (settings, twin) if one is not None]
    return [name for name in settings.values() if any(_is_long(values[name]) for values in runs)]


def _is_long(value: object) -> bool:
    return isinstance(value, tuple) and len(json.dumps(value[:LONGEST_VALUE])) > LONGEST_VALUE
