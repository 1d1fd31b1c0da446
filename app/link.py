"""The address of a page.

Reads it to show a state, and writes the state that is shown.
"""

from __future__ import annotations

import json
from typing import Any
from urllib.parse import parse_qsl, quote

import panel as pn
import param

from app.browser import Browser
from app.frame import Selection
from app.lessons.catalogue import KINDS, KNOWN, LESSONS, plots_of, settings_of
from app.refusals import message_of
from app.state import PageState, default_settings
from solver.files.saved import dump
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.settings.definitions import SettingGroup, checked_value, parse, title_of
from solver.settings.scene import Settings

SHARED = "lesson", "case", "tab", "question", "pace", "plots", "view", "room"
"""Parts of a page's state in its address, beside settings."""
DEFAULTS = {name: PageState.param[name].default for name in SHARED}
LONGEST = 1500
"""Characters of a value in an address; mail, chat and proxies cut what is much
longer."""

Place = dict[str, Any]
"""What an address says, by the names of `PageState`: `settings` in any case; the room
is "class" in the address. Beside that the `instant` as a share of the interval, and the
`iteration` at which the run waits."""
_CHECKED: dict[str, Any] = {
    "instant": SettingGroup("").quantity(0.0, (0.0, 1.0), (0.0, 1.0), ""),
    "iteration": SettingGroup("").count(0, (0, 100_000), (0, 100_000), ""),
    **{name: PageState.param[name] for name in ("tab", "pace", "view")},
}
"""Definitions of what may be refused beside settings, scene, lesson, case and plots."""


class Link:
    """Keeps the address of a page, and shows an address that the browser goes back to.

    Each change is an entry of the browser's history, so that Back undoes it; but for
    one that is dragged, and instants and iterations. `query` is the address from the
    question mark on.
    """

    def __init__(self, state: PageState, browser: Browser) -> None:
        self._state = state
        self._browser = browser
        self._location = pn.state.location
        self.query = query_of(place_of(state))
        browser.on_change("search", lambda name, old, new: new and self.go(new))
        state.param.watch(
            lambda *events: self._write(), ["settings", "is_dragged", *SHARED]
        )

    def _write(self) -> None:
        """Write the state that is shown into the address."""
        query = query_of(place_of(self._state))
        if self._state.is_dragged or query == self.query:
            return
        self.query = query
        if self._location is not None:
            # After going back the location has not heard where the browser is.
            is_same = self._location.search == query
            if is_same:
                self._location.search = f"{query}&"
            else:
                self._location.search = query

    def copy(self) -> str:
        """Have the browser copy the whole link, and return a message on it."""
        self._browser.copied = ""
        self._browser.copied, message = link_of(self._state)
        return f"The link to what is shown is copied. {message}".rstrip()

    def go(self, query: str) -> None:
        """Show the state of an address."""
        place, refusal = read(query, self._state.settings)
        self.query = query_of(place)
        show(self._state, place)
        self._state.refusal = refusal


def show(state: PageState, place: Place) -> None:
    """Show the state that was read from an address."""
    # At once: what is between two addresses has none.
    with param.parameterized.batch_call_watchers(state):
        state.param.update(**{name: place.get(name, DEFAULTS[name]) for name in SHARED})
        if "instant" in place:
            state.select(phase=place["instant"])
        if dump(place["settings"]) != dump(state.settings):
            state.adopt(place["settings"])
    if place.get("iteration"):
        state.reset(place["iteration"])


def place_of(state: PageState) -> Place:
    """The state that is shown, without the instant and the iteration."""
    return {name: getattr(state, name) for name in ("settings", *SHARED)}


def link_of(state: PageState) -> tuple[str, str]:
    """The whole link, with instant and iteration, and a message on values left out."""
    frame = state.frame
    is_held = not state.running or state.frame is not state.newest
    is_waiting = frame is not None and not frame.is_answer and is_held
    place = place_of(state) | {
        # Who leads a class has its key there, too.
        "room": state.room.partition(".")[0],
        "instant": round(state.selection.phase, 4),
        "iteration": frame.iteration if is_waiting else 0,
    }
    if pn.state.location is not None:
        root = pn.state.location.href.partition("?")[0]
    else:
        root = ""
    long = too_long(state.settings)
    titles = ", ".join(title_of(state.settings.definitions()[name]) for name in long)
    if long:
        message = f"Too long for a link, so that a saved file has it alone: {titles}."
    else:
        message = ""
    return root + query_of(place), message


def query_of(place: Place) -> str:
    """The address: differences from the defaults, or from a lesson or a case."""
    if place.get("room"):
        return f"?class={quote(place['room'])}"
    settings = place["settings"]
    lesson = LESSONS.get(place.get("lesson", ""))
    base = default_settings(settings.scene)
    pairs = {"scene": settings.scene}
    for kind, known in KNOWN.items():
        if (name := place.get(kind)) in known:
            base = settings_of(known[name])
            pairs = {kind: name}
    long = too_long(settings)
    pairs |= {
        name: json.dumps(value, separators=(",", ":"))
        for name, value in settings.changed(base).items()
        if name not in long
    }
    if long:
        pairs["file"] = ",".join(long)
    first = DEFAULTS | {"plots": plots_of(place.get("case", "")), "iteration": 0}
    if lesson:
        first["instant"] = lesson.instant
    else:
        first["instant"] = Selection().phase
    for name in ("tab", "question", "instant", "iteration", "pace", "plots", "view"):
        if place.get(name, first[name]) != first[name]:
            if name == "plots":
                pairs[name] = ",".join(place[name])
            else:
                pairs[name] = str(place[name])
    return "?" + "&".join(
        f"{name}={quote(text, safe=',:[]')}" for name, text in pairs.items()
    )


def read(query: str, present: Settings | None = None) -> tuple[Place, str]:
    """State of an address from the question mark on, and refused parts with reasons, or "".

    The settings that hold at present have what is too long for an address.
    """
    pairs = dict(parse_qsl(query.lstrip("?"), keep_blank_values=True))
    # Panel begins a page in the theme.
    pairs.pop("theme", "")
    refused: list[str] = []
    place: Place = {
        "room": pairs.pop("class", ""),
        "question": pairs.pop("question", ""),
    }
    base, opened = _base(pairs, refused)
    place |= opened
    if "lesson" in opened:
        place["instant"] = LESSONS[opened["lesson"]].instant
    plots = plots_of(opened.get("case", ""))
    if "plots" in pairs:
        plots = list(filter(None, map(str.strip, pairs.pop("plots").split(","))))
    place["plots"] = [name for name in plots if name in KINDS]
    refused += [f"there is no plot {name[:40]}" for name in plots if name not in KINDS]
    for name in [name for name in _CHECKED if name in pairs]:
        text = pairs.pop(name)
        definition = _CHECKED[name]
        try:
            if isinstance(definition, param.Selector):
                value = text
            else:
                value = parse(text)
            place[name] = checked_value(definition, name, value)
        except RefusedError as refusal:
            refused.append(str(refusal))
    for name in filter(None, pairs.pop("file", "").split(",")):
        if (
            present is not None
            and present.scene == base.scene
            and name in base.definitions()
        ):
            base = base.replace(**{name: getattr(present, name)})
        else:
            refused.append(f"{name[:40]} is too long for it: open its file")
    place["settings"] = _together(
        base, {name: parse(text) for name, text in pairs.items()}, refused
    )
    message = "; ".join(text.rstrip(".") for text in refused)
    return place, f"From the address: {message}." if refused else ""


def _base(pairs: dict[str, str], refused: list[str]) -> tuple[Settings, dict[str, str]]:
    """Settings from which an address differs, and the lesson or case of them."""
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
            refused.append(f"there is no {kind} {name[:40]}")
    if scene and scene not in CATALOGUE:
        refused.append(f"there is no scene {scene[:40]}: choose {', '.join(CATALOGUE)}")
    return default_settings(scene if scene in CATALOGUE else next(iter(CATALOGUE))), {}


def _together(base: Settings, values: dict[str, Any], refused: list[str]) -> Settings:
    """Settings with the values that hold together; refuse the others one by one."""
    while True:
        try:
            return base.replace(**values)
        except RefusedError as refusal:
            if refusal.name in values:
                name = refusal.name
            else:
                name = next(reversed(values))
            value = values.pop(name)
            is_known = refusal.name in base.definitions()
            message = message_of(refusal, base, name, value)
            refused.append(message if is_known else f"{name[:40]}: {refusal.remedy}")


def too_long(settings: Settings) -> list[str]:
    """Names of the settings whose values are too long for an address."""
    tables = {
        n: value for n, value in settings.values().items() if isinstance(value, tuple)
    }
    return [name for name, table in tables.items() if len(json.dumps(table)) > LONGEST]
