"""The address of a page: read to show a state, and written from the shown state."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any
from urllib.parse import parse_qsl, quote

import panel as pn
import param

from app.browser import Browser
from app.experiments.questions import question_of
from app.frame import Selection
from app.lessons.catalogue import (
    CASES,
    KINDS,
    KNOWN,
    LESSONS,
    plots_of,
    settings_of,
)
from app.refusals import message_of
from app.state import WHAT_IF, PageState, default_settings
from solver.files.saved import dump
from solver.files.typed import typed_value
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.settings.definitions import SettingGroup, title_of
from solver.settings.scene import Settings
from solver.settings.values import checked_value

ALIKE = 0.6
"""Likeness of a name to the one that it is taken for, at least."""
MOST = 10
"""Largest number of refusals that are told in full, and of unknown names for which ones
that are alike are searched."""
OF_OTHERS = re.compile(r"theme|utm_\w+|fbclid|gclid")
"""Names that others read: Panel begins a page in the theme, and mail and networks count
those who follow a link."""
SHARED = "lesson", "case", "tab", "question", "pace", "plots", "view", "room"
"""Parts of a page's state in its address, beside settings."""
BESIDE = (
    "tab",
    "question",
    "instant",
    "interface",
    "iteration",
    "pace",
    "plots",
    "view",
)
"""Parts of an address beside settings, lesson, case and class."""
DEFAULTS = {name: PageState.param[name].default for name in SHARED}
LONGEST = 1500
"""Largest number of characters of a value in an address: mail, chat and proxies cut
much longer addresses."""

Shown = dict[str, Any]
"""The state that an address shows, by the names of `PageState`: always `settings`; the
room is "class" in the address. It may also have the `instant` as a share of the
interval, the `interface` that is selected, and the `iteration` at which the run
waits."""
_CHECKED: dict[str, Any] = {
    "instant": SettingGroup("").quantity(0.0, (0.0, 1.0), (0.0, 1.0), ""),
    "iteration": SettingGroup("").count(0, (0, 100_000), (0, 100_000), ""),
    **{name: PageState.param[name] for name in ("tab", "pace", "view")},
}
"""Definitions of what may be refused beside settings, scene, lesson, case and plots."""


class Link:
    """The address of a page, kept up to date; going back shows an earlier state.

    Each change is an entry of the browser's history, so that Back undoes it. Only moves
    of a dragged slider, instants and iterations are no entries. `query` is the address
    from the question mark on.
    """

    def __init__(self, state: PageState, browser: Browser) -> None:
        self._state = state
        self._browser = browser
        self._location = pn.state.location
        self.query = query_of(shown_by(state))
        browser.on_change("search", lambda name, old, new: self.go(new))
        state.param.watch(
            lambda *events: self._write(), ["settings", "is_dragged", *SHARED]
        )

    def _write(self) -> None:
        """Write the shown state into the address."""
        query = query_of(shown_by(self._state))
        if self._state.is_dragged or query == self.query:
            return
        self.query = query
        # After going back the location has not heard where the browser is.
        if self._location.search == query:
            self._location.search = f"{query}&"
        else:
            self._location.search = query

    def copy(self) -> str:
        """Copy the whole link in the browser, and return a message."""
        link, message = link_of(self._state)
        # The same link may be copied again.
        self._browser.tell(copied="")
        self._browser.tell(copied=link)
        return f"The link to what is shown is copied. {message}".rstrip()

    def join(self, code: str) -> None:
        """Open the page of a class."""
        self._visit(query_of({"room": code}))

    def _visit(self, query: str) -> None:
        """Open an address in the browser."""
        self._browser.tell(destination="")
        self._browser.tell(destination=query)

    def go(self, query: str) -> None:
        """Show the state of an address, or open the page of a class.

        The browser tells an empty one before each (`LISTEN`, `browser.py`).
        """
        if not query:
            return
        shown, refusal = read(query, self._state.settings)
        if room := shown["room"]:
            if room != self._state.room:
                self._visit(query)
            return
        self.query = query_of(shown)
        show(self._state, shown)
        self._state.refusal = refusal


def show(state: PageState, shown: Shown) -> None:
    """Show a state that was read from an address."""
    values = {name: shown.get(name, DEFAULTS[name]) for name in SHARED}
    # In one step: each change alone would write an address of its own.
    with param.parameterized.batch_call_watchers(state):
        state.param.update(**values)
        if "instant" in shown:
            state.select(phase=shown["instant"])
        if "interface" in shown:
            state.select(interface=shown["interface"])
        if dump(shown["settings"]) != dump(state.settings):
            state.adopt(shown["settings"])
    if shown.get("iteration"):
        state.reset(shown["iteration"])


def shown_by(state: PageState) -> Shown:
    """The shown state of a page, without instant, interface and iteration."""
    return {name: getattr(state, name) for name in ("settings", *SHARED)}


def link_of(state: PageState) -> tuple[str, str]:
    """The whole link, including selections, and a message on omitted values."""
    frame = state.frame
    is_held = not state.running or state.frame is not state.newest
    is_waiting = frame is not None and not frame.is_answer and is_held
    shown = shown_by(state)
    # The leader of a class has its key there, too, which is not handed on.
    shown["room"] = state.room.partition(".")[0]
    shown["interface"] = state.selection.interface
    shown["instant"] = round(state.selection.phase, 4)
    shown["iteration"] = 0
    if is_waiting:
        shown["iteration"] = frame.iteration
    root = pn.state.location.href.partition("?")[0]
    definitions = state.settings.definitions()
    titles = [title_of(definitions[name]) for name in too_long(state.settings)]
    message = ""
    if titles:
        listed = ", ".join(titles)
        message = f"Too long for a link, so that a saved file has it alone: {listed}."
    return root + query_of(shown), message


def query_of(shown: Shown) -> str:
    """Query of an address: differences from defaults, or from a lesson or case."""
    if shown.get("room"):
        return f"?class={quote(shown['room'])}"
    settings = shown["settings"]
    base = default_settings(settings.scene)
    pairs = {"scene": settings.scene}
    for kind, known in KNOWN.items():
        if (name := shown.get(kind)) in known:
            base = settings_of(known[name])
            pairs = {kind: name}
    long = too_long(settings)
    for name, value in settings.changed(base).items():
        if name not in long:
            pairs[name] = json.dumps(value, separators=(",", ":"))
    if long:
        pairs["file"] = ",".join(long)
    pairs |= _beside_settings(shown)
    # Brackets and commas stay, so that people can read paths.
    texts = [f"{name}={quote(text, safe=',:[]')}" for name, text in pairs.items()]
    return "?" + "&".join(texts)


def _beside_settings(shown: Shown) -> dict[str, str]:
    """Parts of an address besides settings, where they differ from a new page's."""
    selection = Selection()
    lesson = LESSONS.get(shown.get("lesson", ""))
    if lesson:
        selection = Selection(lesson.instant, lesson.interface)
    case = CASES.get(shown.get("case", ""))
    if case:
        selection = Selection(case.instant)
    first = DEFAULTS | {
        "plots": plots_of(shown.get("case", "")),
        "iteration": 0,
        "instant": selection.phase,
        "interface": selection.interface,
    }
    pairs = {}
    for name in BESIDE:
        value = shown.get(name, first[name])
        if value == first[name]:
            continue
        if name == "plots":
            pairs[name] = ",".join(value)
        else:
            pairs[name] = str(value)
    return pairs


def read(query: str, present: Settings | None = None) -> tuple[Shown, str]:
    """State in the query of an address, and a sentence on refused parts.

    The page's `present` settings have the values that are too long for an address. The
    sentence is "" where nothing is refused.
    """
    refused: list[str] = []
    pairs = _pairs(query, refused)
    # Each step takes its own parts out of the pairs: the settings are what is left.
    shown: Shown = {"room": pairs.pop("class", "")}
    question = pairs.pop("question", "")
    base, opened = _base(pairs, refused)
    shown |= opened
    for kind, name in opened.items():
        shown["instant"] = KNOWN[kind][name].instant
    shown["plots"] = _plots(pairs, opened.get("case", ""), refused)
    shown |= _checked(pairs, refused)
    if "interface" in pairs:
        shown["interface"] = pairs.pop("interface")
    values = _of_present(base, pairs, present, refused)
    dropped = _without_unknown(pairs, base)
    values |= _typed(base, pairs, refused)
    shown["settings"] = _together(base, values, refused)
    refused += [f"{name[:40]}: there is no such setting" for name in dropped]
    shown["question"] = question
    # Beside another tab the question may be that of a scene before.
    if shown.get("tab") == WHAT_IF:
        shown["question"] = _question(question, shown["settings"], refused)
    if not refused:
        return shown, ""
    told = refused[:MOST]
    if len(refused) > MOST:
        told.append(f"and {len(refused) - MOST} more")
    reasons = "; ".join(text.rstrip(".") for text in told)
    end = "" if reasons.endswith("?") else "."
    return shown, f"From the address: {reasons}{end}"


def _pairs(query: str, refused: list[str]) -> dict[str, str]:
    """Names and their last values in a query; refuse values without a name."""
    found = []
    for name, text in parse_qsl(query.lstrip("?"), keep_blank_values=True):
        value = _readable(text)
        if name.strip():
            found.append((_readable(name.strip()), value))
        elif value.strip():
            refused.append(
                f"{value[:40]} has no name: write a name before it, as friction=0.3"
            )
    pairs = dict(found)
    counts = Counter(name for name, value in set(found))
    for name, count in counts.items():
        if OF_OTHERS.fullmatch(name):
            pairs.pop(name)
        elif count > 1:
            refused.append(f"{name[:40]} has {count} values: the last one is taken")
    return pairs


def _readable(text: str) -> str:
    """A text with characters that cannot be seen as an address has them, as %0A."""
    return "".join([each if each.isprintable() else quote(each) for each in text])


def _without_unknown(pairs: dict[str, str], base: Settings) -> list[str]:
    """Take out all but a few names that no setting has; return their names.

    The search for a name that is alike takes a hundredth of a second, in which the
    server does nothing else.
    """
    unknown = [name for name in pairs if name not in base.definitions()]
    for name in unknown[MOST:]:
        del pairs[name]
    return unknown[MOST:]


def _question(text: str, settings: Settings, refused: list[str]) -> str:
    """Question of the tab What if in an address; refuse one without such settings."""
    question = " ".join(text.split())
    if question and str(question_of(question, settings)) != question:
        refused.append(
            f"the question {question[:40]} cannot be asked here: choose one under "
            f"{WHAT_IF}"
        )
        return ""
    return question


def _plots(pairs: dict[str, str], case: str, refused: list[str]) -> list[str]:
    """Names of plots in an address, else those of its case; refuse unknown names."""
    names = plots_of(case)
    if "plots" in pairs:
        names = [name.strip() for name in pairs.pop("plots").split(",")]
    known = []
    for name in names:
        if name in KINDS:
            known.append(name)
        elif name:
            refused.append(f"there is no plot {name[:40]}")
    return known


def _checked(pairs: dict[str, str], refused: list[str]) -> Shown:
    """Allowed parts of an address besides settings; refuse the others."""
    allowed = {}
    for name, definition in _CHECKED.items():
        if name not in pairs:
            continue
        value: Any = pairs.pop(name)
        try:
            # The choices of a selector are texts, which may look like numbers.
            if not isinstance(definition, param.Selector):
                value = typed_value(value, name, definition)
            allowed[name] = checked_value(definition, name, value)
        except RefusedError as refusal:
            refused.append(str(refusal))
    return allowed


def _of_present(
    base: Settings, pairs: dict[str, str], present: Settings | None, refused: list[str]
) -> dict[str, Any]:
    """Present values of the settings that are too long for an address."""
    values = {}
    for name in pairs.pop("file", "").split(","):
        is_there = present is not None and present.scene == base.scene
        if is_there and name in base.definitions():
            values[name] = getattr(present, name)
        elif name:
            refused.append(f"{name[:40]} is too long for it: open its file")
    return values


def _base(pairs: dict[str, str], refused: list[str]) -> tuple[Settings, dict[str, str]]:
    """Base settings of an address, and their lesson or case."""
    scene = pairs.pop("scene", "")
    names = {kind: pairs.pop(kind, "") for kind in KNOWN}
    for kind, name in names.items():
        found = KNOWN[kind].get(name)
        if found is not None:
            if scene not in ("", found.settings.scene):
                refused.append(
                    f"the {kind} has a scene of its own, {found.settings.scene}"
                )
            return settings_of(found), {kind: name}
        if name:
            refused.append(f"there is no {kind} {name[:40]}: {_proposal(kind, name)}")
    if scene in CATALOGUE:
        return default_settings(scene), {}
    if scene:
        refused.append(f"there is no scene {scene[:40]}: choose {', '.join(CATALOGUE)}")
    return default_settings(next(iter(CATALOGUE))), {}


def _proposal(kind: str, name: str) -> str:
    """Remedy for a name that no lesson, or no case, has."""
    near = get_close_matches(name, KNOWN[kind], n=1, cutoff=ALIKE)
    if near:
        return f"did you mean {near[0]}?"
    return f"choose one under {kind.capitalize()}s"


def _typed(
    base: Settings, pairs: Mapping[str, str], refused: list[str]
) -> dict[str, Any]:
    """Values of settings in an address; refuse those of another unit."""
    definitions = base.definitions()
    values = {}
    for name, text in pairs.items():
        try:
            values[name] = typed_value(text, name, definitions.get(name))
        except RefusedError as refusal:
            refused.append(message_of(refusal, base))
    return values


def _together(base: Settings, values: dict[str, Any], refused: list[str]) -> Settings:
    """Settings with the consistent values; refuse the others one by one."""
    # A refusal may be of a setting that the address does not name, and that does not go
    # with one that it names: then its last value goes first.
    while True:
        try:
            return base.replace(**values)
        except RefusedError as refusal:
            name = refusal.name
            if name not in values:
                name = next(reversed(values))
            value = values.pop(name)
            message = f"{name[:40]}: {refusal.remedy}"
            if refusal.name in base.definitions():
                message = message_of(refusal, base, name, value)
            refused.append(message)


def too_long(settings: Settings) -> list[str]:
    """Names of the settings whose values are too long for an address."""
    long = []
    for name, value in settings.values().items():
        is_long = isinstance(value, tuple | str)
        if is_long and len(json.dumps(value)) > LONGEST:
            long.append(name)
    return long
