"""What stands at the side: the settings, the choice of views, and what carries settings away."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from typing import Any

from app.comparing import CHOICES, choice_of, pair
from app.form import POINTS, USUAL, Form, item_of
from app.lesson import LESSONS
from app.session import Session
from app.uploads import load_in
from app.views.catalogue import VIEWS as ALL_VIEWS
from solver.checked import dump
from solver.definitions import SettingError, about
from solver.files import settings_from_toml
from solver.scenes import CATALOGUE, points_of
from solver.settings import Settings

METHOD = "Method"
ORDER = (
    "Load",
    "Top",
    "Left",
    "Right",
    "Contact",
    "Bar",
    "Strand",
    "Body",
    "Body force",
    "Decomposition",
    METHOD,
    "Stop",
)

# None of these is the name of a setting.
SCENE, LESSON, WARM = "the-scene", "the-lesson", "start-from-before"
VIEWS, SHARE, COMPARE = "the-views", "share", "compare"
SCENE_ITEM = {
    "name": SCENE,
    "kind": "choice",
    "label": "Scene",
    "help": "What is solved; each scene keeps its settings until the page is closed.",
    "options": [[entry.title, name] for name, entry in CATALOGUE.items()],
}
LESSON_ITEM = {
    "name": LESSON,
    "kind": "choice",
    "label": "Lesson",
    "help": "A question to predict the answer of, one thing to change, and why it is so.",
    "options": [["none", ""], *([one.title, one.name] for one in LESSONS.values())],
}
COMPARE_ITEM = {
    "name": COMPARE,
    "kind": "choice",
    "label": "Compare with",
    "help": "Run A goes in step with the run at work, B, on the same axes: the present settings "
    "are kept as A and you change B, or both are set at once.",
    "options": [[title, name] for title, name in CHOICES.items()],
}
WARM_ITEM = {
    "name": WARM,
    "kind": "flip",
    "label": "Start from the run before",
    "help": "When a setting changes, begin with the solution of the run before, if one iteration "
    "shows it to be much nearer to the new one: its k-free indicator is then below a fourth of "
    "that from the usual start. The time of both is counted. Reset always takes the usual start.",
    "group": METHOD,
}
VIEWS_ITEM = {"name": VIEWS, "kind": "checks", "help": "What is drawn.", "group": "Views"}
LINK, SAVE, DEFAULTS, CLASS = "Link", "Save", "Defaults", "Class"
SHARE_ITEM = {
    "name": SHARE,
    "kind": "share",
    "group": "Share",
    "buttons": [
        [LINK, "Copy the address, which has the settings and what is looked at."],
        [SAVE, "Save the settings; the command line reads them too."],
        [DEFAULTS, "Bring all settings back to their defaults."],
        [CLASS, "Begin a class: whoever joins by its code sees what you see."],
    ],
    "label": "Open settings (.toml) or load (.csv)",
}

WARM_NOTE = """\
# The run on the page started from the solution of the run before it, so its iterations and times
# are not those of these settings alone, which start as `start` says.
"""
"""Stands in a file that is saved while such a run is looked at."""


class Sidebar:
    """The controls of a session.

    Parameters
    ----------
    session
        Is told what the user changes.
    rearrange
        Called when settings or the choice of views have changed.
    complain
        Tells the user what was refused and why.
    copy
        Copies the page's address.
    teach
        Opens a lesson by its name; an empty one leaves that which is open.

    Attributes
    ----------
    lesson
        Name of the one that is open, or empty.
    view
        What stands on the page.
    """

    def __init__(
        self,
        session: Session,
        rearrange: Callable[[], None],
        complain: Callable[[str], None],
        copy: Callable[[], None],
        teach: Callable[[str], None],
    ) -> None:
        self._session = session
        self._rearrange = rearrange
        self._complain = complain
        self._copy = copy
        self._teach = teach
        self.lesson = ""
        self._views: list[str] = []
        self._unwanted: set[str] = set()
        self._asked: dict[str, Any] = {}
        self._in_hand: set[str] = set()
        self._has_obeyed = False
        self._heard = self._answered = 0.0
        self.view = Form(sizing_mode="stretch_width", margin=(4, 10))
        self.view.on_msg(lambda message: self.hear(**message.data))

    def show(self, settings: Settings) -> None:
        """Show the settings that hold."""
        values = {
            name: getattr(settings, name)
            for name, definition in settings.definitions().items()
            if about(definition).applies(settings)
        }
        wanted = [name for name in self._views if name not in self._unwanted]
        own = {
            SCENE: settings.scene,
            LESSON: self.lesson,
            COMPARE: choice_of(self._session.twin, settings),
            WARM: self._session.warm_start,
            VIEWS: [self._views, wanted],
            SHARE: None,
            "": self._answered,
        }
        self.view.param.update(items=_items(type(settings)), shown={**values, **own})

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
        for name, value in asked.items():
            try:
                self._session.change(name, value, by_hand=name in self._in_hand)
            except SettingError as refusal:
                self._complain(str(refusal))
        if asked:
            self._after_change()

    def offer(self, views: Sequence[str]) -> list[str]:
        """Offer these views, and give those of them that are wanted."""
        if self._views != list(views):
            self._views = list(views)
            self.show(self._session.wanted)
        return [name for name in views if name not in self._unwanted]

    def draw(self, views: Iterable[str]) -> None:
        """Draw these views and no others, until the user wants more."""
        self._unwanted = {view.name for view in ALL_VIEWS} - set(views)
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
            self._complain(str(refusal))
        self._after_change()

    def _on_share(self, value: Any) -> None:
        if value == LINK:
            self._copy()
        elif value == SAVE:
            self.view.file = [self._saved(), self._heard]
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
        try:
            if filename.endswith(".toml"):
                self._adopt(settings_from_toml(text))
            else:
                self._on_setting(*load_in(text, filename, self._session.wanted))
        except SettingError as refusal:
            self._complain(str(refusal))

    def _saved(self) -> str:
        facts = self._session.facts
        warm = facts is not None and facts.was_warm
        return (WARM_NOTE if warm else "") + dump(self._session.settings)


@cache
def _items(settings: type[Settings]) -> list[dict[str, Any]]:
    """Say what controls there are, those behind "more" before the choice of views."""
    made = [item_of(name, definition) for name, definition in settings.definitions().items()]
    found = [item for item in made if item is not None]
    open_ones = [item for item in found if not item["more"]]
    groups = [*ORDER, *(item["group"] for item in open_ones)]
    open_ones.sort(key=lambda item: groups.index(item["group"]))
    after = max(i for i, item in enumerate(open_ones) if item["group"] == METHOD) + 1
    open_ones.insert(after, WARM_ITEM)
    more = [item for item in found if item["more"]]
    return [SCENE_ITEM, LESSON_ITEM, COMPARE_ITEM, *open_ones, *more, VIEWS_ITEM, SHARE_ITEM]
