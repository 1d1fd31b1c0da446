"""What stands at the side: the settings, the choice of views, and what carries settings away."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from app.components.form import ENDS, POINTS, USUAL, Form, shown_value
from app.controls.comparing import choice_of, pair
from app.controls.items import (
    CLASS,
    COMPARE,
    DEFAULTS,
    LESSON,
    LINK,
    NOTE,
    SAVE,
    SCENE,
    SHARE,
    VIEWS,
    WARM,
    items,
)
from app.controls.refusals import last_that_holds, refused
from app.reports.report import Report
from app.session.session import Session
from app.session.uploads import load_in, saved
from app.views.catalogue import VIEWS as ALL_VIEWS
from solver.definitions import SettingError, about
from solver.files import settings_from_toml
from solver.scenes import ends_of, points_of
from solver.settings import Settings


class Sidebar:
    """The controls of a session.

    Parameters
    ----------
    session
        Is told what the user changes.
    rearrange
        Called when settings or the choice of views have changed.
    complain, tell
        Tell the user what was refused and why, until nothing is; and what was done.
    copy
        Copies the page's address.
    teach
        Opens a lesson by its name; an empty one leaves that which is open.

    Attributes
    ----------
    lesson
        Name of the one that is open, or empty.
    named
        Whether the views are those that a lesson or an address names.
    report
        What is looked at, whose settings alone are shown; None for the live run.
    view
        What stands on the page.
    """

    def __init__(
        self,
        session: Session,
        rearrange: Callable[[], None],
        complain: Callable[[str], None],
        tell: Callable[[str], None],
        copy: Callable[[], None],
        teach: Callable[[str], None],
    ) -> None:
        self._session = session
        self._rearrange = rearrange
        self._complain, self._tell = complain, tell
        self._copy = copy
        self._teach = teach
        self.lesson = ""
        self.report: Report | None = None
        self._views: list[str] = []
        self._unwanted: set[str] = set()
        self.named = False
        self._asked: dict[str, Any] = {}
        self._in_hand: set[str] = set()
        self._ends: set[str] = set()
        self._has_obeyed = False
        self._heard = self._answered = 0.0
        self.view = Form(sizing_mode="stretch_width", margin=(4, 10))
        self.view.on_msg(lambda message: self.hear(**message.data))

    def show(self, settings: Settings) -> None:
        """Show the settings that hold."""
        definitions = settings.definitions()
        acting = (
            [name for name, one in definitions.items() if about(one).applies(settings)]
            if self.report is None
            else self.report.acting()
        )
        values = {name: shown_value(getattr(settings, name)) for name in acting}
        wanted = [name for name in self._views if name not in self._unwanted]
        own = {
            SCENE: settings.scene,
            LESSON: self.lesson,
            COMPARE: choice_of(self._session.twin, settings),
            WARM: self._session.warm_start,
            VIEWS: [self._views, wanted],
            SHARE: None,
            "": self._answered,
            ENDS: ends_of(settings),
        }
        if self.report is not None:
            kept = {SCENE, SHARE, ENDS, ""} if acting else {SHARE, ""}
            own = {NOTE: self.report.note, **{name: own[name] for name in kept}}
        changes: dict[str, Any] = {"shown": {**values, **own}}
        # Param takes longer to compare the controls with themselves than to pass on the values.
        if (controls := items(type(settings))) is not self.view.items:
            changes["items"] = controls
        self.view.param.update(**changes)

    def hear(self, name: str, value: Any, hand: bool, count: float) -> None:
        """Follow what the user does with a control."""
        self._heard = count
        if name == SCENE:
            self._on_scene(value)
        elif name == LESSON:
            self.obey()
            self._teach(value)
        elif name == COMPARE:
            self._on_compare(value)
        elif name == WARM:
            self._session.warm_start = value
        elif name == VIEWS:
            self._unwanted = (self._unwanted | set(self._views)) - set(value)
            self.named = False
            self._rearrange()
        elif name == SHARE:
            self._on_share(value)
        elif value is None:
            self._let_go(name)
        elif value == POINTS:
            self._on_setting(name, points_of(self._session.wanted, name))
        elif value == USUAL:
            settings = self._session.wanted
            self._on_setting(name, settings.usual(settings.method)[name])
        else:
            self._on_setting(name, value, by_hand=hand)

    def obey(self) -> None:
        """Make the changes that were asked for since the last one; to be called at every tick."""
        asked, self._asked = self._asked, {}
        self._has_obeyed, self._answered = bool(asked), self._heard
        said = [self._change(name, value) for name, value in asked.items()]
        if asked and None not in said:
            self._complain(" ".join(filter(None, said)))
        if asked:
            self._after_change()

    def _change(self, name: str, value: Any) -> str | None:
        """Change a setting; say why not, or nothing if that was said already.

        A slider that is dragged beyond what holds goes as far as it can.
        """
        session, by_hand = self._session, name in self._in_hand
        try:
            session.change(name, value, by_hand=by_hand)
        except SettingError as refusal:
            words = refused(refusal, session.wanted, name, value)
        else:
            self._ends.discard(name)
            return ""
        if name in self._ends:
            return None
        if by_hand:
            self._ends.add(name)
            end = last_that_holds(session.wanted, name, value)
            if end is not None:
                session.change(name, end, by_hand=True)
        return words

    def offer(self, views: Sequence[str]) -> list[str]:
        """Offer these views, and give those of them that are wanted."""
        if self._views != list(views):
            self._views = list(views)
            self.show(self._session.wanted)
        return [name for name in views if name not in self._unwanted]

    @property
    def plots(self) -> str:
        """The views that are wanted, separated by commas, or nothing if all are."""
        wanted = (view.name for view in ALL_VIEWS if view.name not in self._unwanted)
        return ",".join(wanted) if self._unwanted else ""

    def draw(self, views: Iterable[str]) -> None:
        """Draw these views and no others, until the user wants more."""
        self._unwanted = {view.name for view in ALL_VIEWS} - set(views)
        self.named = bool(self._unwanted)
        self.show(self._session.wanted)

    def _on_scene(self, scene: str) -> None:
        self.obey()
        self._session.choose_scene(scene)
        self._after_change()

    def _on_compare(self, choice: str) -> None:
        self.obey()
        try:
            self._session.twin, settings = pair(choice, self._session.wanted)
            self._session.start(settings)
        except SettingError as refusal:
            self._complain(refused(refusal, self._session.wanted))
        self._after_change()

    def _on_share(self, value: Any) -> None:
        if value == LINK:
            self._copy()
        elif value == SAVE:
            facts = self._session.facts
            was_warm = facts is not None and facts.was_warm
            self.view.file = [saved(self._session.settings, was_warm=was_warm), self._heard]
        elif value == DEFAULTS:
            self._adopt(type(self._session.settings).checked({}))
        elif value == CLASS:
            self._session.attendance.lead(self._session.wanted)
            self._session.ask(afresh=True)
        else:
            self._open(*value)

    def _let_go(self, name: str) -> None:
        """Follow the end of a drag."""
        self._in_hand.discard(name)
        self.obey()
        self._ends.discard(name)
        self._session.let_go()
        # A slider whose move was refused waits for the answer to this, its last message.
        self.show(self._session.wanted)

    def _on_setting(self, name: str, value: Any, *, by_hand: bool = False) -> None:
        """Make the first change at once, and of those before the next tick the newest then.

        A slider that is dragged sends more of them than the server could obey.
        """
        self._asked[name] = value
        (self._in_hand.add if by_hand else self._in_hand.discard)(name)
        if not self._has_obeyed:
            self.obey()

    def _adopt(self, settings: Settings) -> None:
        self.obey()
        self._complain("")
        self._session.adopt(settings)
        self._after_change()

    def _after_change(self) -> None:
        self.show(self._session.wanted)
        self._rearrange()

    def _open(self, filename: str, text: str | None) -> None:
        """Take the settings or the load path of a file."""
        if text is None:
            self._complain("The file is not text: give a settings file (.toml) or a table (.csv).")
            return
        settings = self._session.wanted
        try:
            if filename.endswith(".toml"):
                self._adopt(settings_from_toml(text))
            else:
                found, said = load_in(text, filename, settings)
                self._adopt(found)
                self._tell(said)
        except SettingError as refusal:
            is_settings = filename.endswith(".toml")
            self._complain(str(refusal) if is_settings else refused(refusal, settings))
