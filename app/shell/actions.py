"""What one does with a page as a whole, in its header: a class, a projector, links and files."""

from __future__ import annotations

from collections.abc import Callable
from textwrap import shorten
from typing import Any, ClassVar

import param

from app.components.form import STYLE
from app.components.innards import Plain
from app.components.menu import STYLE as MENU
from app.components.panes import script
from app.controls.refusals import refused, refused_by_name
from app.picture.labels import label_of
from app.picture.usual import changed, usual_settings
from app.session.session import Session
from app.session.undo import Undo
from app.session.uploads import load_in, saved
from solver.definitions import SettingError
from solver.files import scene_settings, settings_from_toml
from solver.settings import Settings

LONGEST_NAME = 40
NO_TEXT = "The file is not text: give a settings file (.toml) or a table (.csv)."


class ActionBar(Plain):
    """Buttons in the header, and what opens below them.

    Messages from the browser are `{kind, value}`: to "undo" and "redo", to start a "class", to
    "present", to copy the "link", to "save" the settings, to "open" a file of a name with its text,
    to bring back the "defaults", to "keep" the run under a name, and to "compare" with one kept.

    Attributes
    ----------
    steps
        Whether there is what can be undone, and done again.
    kept, scene
        Name, scene and settings of a run that the browser is to keep, and a number that tells it
        from the one before; the present scene, whose runs can be compared with.
    file
        A text that the browser is to save, and a number that tells it from the one before.
    """

    steps = param.List(default=[False, False])
    kept = param.List(default=[])
    scene = param.String(default="")
    file = param.List(default=[])

    _esm = script(
        *("say.js", "elements.js", "menu.js", "decoded.js"), "shell/runs.js", "shell/actions.js"
    )
    _stylesheets: ClassVar[list[str]] = [STYLE, MENU]


class Actions:
    """Does what the header's buttons say.

    Parameters
    ----------
    session
        Of the page.
    obey
        Makes the changes of settings that are still waiting.
    undo
        Has what was set before.
    copy, present
        Copies the page's address; shows the page as a projector needs it.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(
        self,
        session: Session,
        obey: Callable[[], None],
        undo: Undo,
        copy: Callable[[], None],
        present: Callable[[], None],
    ) -> None:
        self._session = session
        self._obey = obey
        self._saved = 0
        self.view = ActionBar(margin=0, scene=session.wanted.scene)  # type: ignore[no-untyped-call]
        self._does: dict[str, Callable[[Any], None]] = {
            "undo": lambda _: undo.undo(),
            "redo": lambda _: undo.redo(),
            "class": lambda _: self._lead(),
            "present": lambda _: present(),
            "link": lambda _: copy(),
            "save": lambda _: self._save(),
            "defaults": lambda _: self._adopt(usual_settings(scene_settings(session.wanted.scene))),
            "open": lambda file: self._open(*file),
            "keep": self._keep,
            "compare": self._compare,
        }
        session.param.watch(lambda event: self.view.param.update(steps=list(event.new)), "steps")
        session.param.watch(lambda event: self.view.param.update(scene=event.new.scene), "wanted")
        self.view.on_msg(lambda message: self.hear(**message.data))

    def hear(self, kind: str, value: Any = "") -> None:
        """Follow what the user does."""
        self._obey()
        self._does[kind](value)

    def _lead(self) -> None:
        self._session.attendance.lead(self._session.wanted)
        self._session.ask(afresh=True)

    def _save(self) -> None:
        facts = self._session.facts
        was_warm = facts is not None and facts.was_warm
        self._saved += 1
        self.view.file = [saved(self._session.settings, was_warm=was_warm), self._saved]

    def _keep(self, name: str) -> None:
        """Give the browser the settings of the run, by default under what is not as usual in it."""
        settings = self._session.wanted
        differ = changed(settings)
        called = label_of(settings, differ, self._session.look.units)
        name = shorten(name, LONGEST_NAME) or called or "defaults"
        self._saved += 1
        self.view.kept = [name, settings.scene, saved(settings, was_warm=False), self._saved]

    def _compare(self, text: str) -> None:
        """Have a run that was kept go in step with the present one, as run A."""
        session = self._session
        try:
            twin = settings_from_toml(text)
        except SettingError as refusal:
            session.refusal = refused_by_name(refusal, session.wanted)
            return
        if twin.scene == session.wanted.scene:
            with session.together():
                session.refusal, session.twin = "", twin
                session.start(session.wanted)

    def _adopt(self, settings: Settings) -> None:
        self._session.refusal = ""
        self._session.adopt(settings)

    def _open(self, filename: str, text: str | None) -> None:
        """Take the settings or the load path of a file."""
        if text is None:
            self._session.refusal = NO_TEXT
            return
        settings = self._session.wanted
        try:
            if filename.endswith(".toml"):
                self._adopt(settings_from_toml(text))
            else:
                found, said = load_in(text, filename, settings)
                self._adopt(found)
                self._session.told = said
        except SettingError as refusal:
            say = refused_by_name if filename.endswith(".toml") else refused
            self._session.refusal = say(refusal, settings)
