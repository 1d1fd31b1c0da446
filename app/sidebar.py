"""What stands at the side: the settings, the choice of views, and what carries settings away."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from io import StringIO
from typing import Any

import panel_material_ui as pmui

from app.controls import Control, make_control
from app.innards import gather_briefly
from app.samples import points_of
from app.session import Session
from app.uploads import load_in
from solver.definitions import SettingError, about
from solver.files import settings_from_toml
from solver.scenes import CATALOGUE
from solver.settings import Settings, dump

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
    "Method",
    "Stop",
)

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

    Attributes
    ----------
    view
        What stands on the page; it is empty until `fill`.
    """

    def __init__(
        self,
        session: Session,
        rearrange: Callable[[], None],
        complain: Callable[[str], None],
        copy: Callable[[], None],
    ) -> None:
        self._session = session
        self._rearrange = rearrange
        self._complain = complain
        self._copy = copy
        self._unwanted: set[str] = set()
        self._asked: dict[str, Any] = {}
        self._in_hand: set[str] = set()
        self._has_obeyed = False
        self._views = pmui.CheckBoxGroup(options=[], value=[])
        self._views.param.watch(self._on_views, "value")
        self._more = pmui.Column(sizing_mode="stretch_width", margin=0)
        self._scene = pmui.Select(
            label="Scene",
            options={entry.title: name for name, entry in CATALOGUE.items()},
            value=session.wanted.scene,
            size="small",
            sizing_mode="stretch_width",
            description="What is solved; each scene keeps its settings until the page is closed.",
        )
        self._scene.param.watch(self._on_scene, "value")
        self._controls = self._make_controls(essential=True)
        self._made_for = session.wanted.scene
        self._warm = pmui.Switch(
            label="Start from the run before",
            description="When a setting changes, start from the last iterate of the run before, "
            "if one iteration from there leaves less than a fourth of the k-free indicator that "
            "one from the start above leaves. Reset never does. The time of both is billed.",
            value=session.warm_start,
            size="small",
            sizing_mode="stretch_width",
        )
        # As for the settings, or a slider moved next would overtake it.
        gather_briefly(self._warm)
        self._warm.param.watch(self._on_warm, "value")
        self.view = pmui.Column(sizing_mode="stretch_width", margin=0)

    def fill(self) -> None:
        """Put the controls into the page."""
        self.view[:] = self._items()

    def show(self, settings: Settings) -> None:
        """Show the settings that hold; the controls of another scene come with `catch_up`."""
        if settings.scene != self._made_for:
            self._made_for = settings.scene
            self._scene.value = settings.scene
            self._controls = {}
            self._more[:] = []
            self.view[1:] = []
        for control in self._controls.values():
            control.show(settings)

    def catch_up(self) -> None:
        """Put in the controls of a scene once its first picture is painted: they take longer."""
        if not self._controls:
            self._controls = self._make_controls(essential=True)
            self.show(self._session.wanted)
            self.fill()

    def obey(self) -> None:
        """Make the changes that were asked for since the last one; to be called at every tick."""
        asked, self._asked = self._asked, {}
        self._has_obeyed = bool(asked)
        for name, value in asked.items():
            try:
                self._session.change(name, value, by_hand=name in self._in_hand)
            except SettingError as refusal:
                self._complain(str(refusal))
        if asked:
            self._after_change()

    def offer(self, views: Sequence[str]) -> list[str]:
        """Offer these views, and give those of them that are wanted."""
        wanted = [name for name in views if name not in self._unwanted]
        if self._views.options != list(views):
            self._views.param.update(options=list(views), value=wanted)
        return wanted

    def _on_scene(self, event: Any) -> None:
        if event.new != self._session.wanted.scene:
            self.obey()
            self._session.choose_scene(event.new)
            self._after_change()

    def _on_warm(self, event: Any) -> None:
        self._session.warm_start = event.new

    def _on_views(self, event: Any) -> None:
        offered = set(self._views.options)
        unwanted = (self._unwanted - offered) | (offered - set(event.new))
        if unwanted != self._unwanted:
            self._unwanted = unwanted
            self._rearrange()

    def _items(self) -> list[Any]:
        """Put the essential controls under their headings, the others behind "more"."""
        groups: dict[str, list[Any]] = {}
        for control in self._controls.values():
            groups.setdefault(about(control.definition).group, []).append(control.view)
        items: list[Any] = []
        for group in [*ORDER, *(group for group in groups if group not in ORDER)]:
            if group in groups:
                items += [_heading(group), *groups[group]]
            if group == "Method":
                items.append(self._warm)
        more = pmui.Accordion(("More settings", self._more), sizing_mode="stretch_width")
        more.param.watch(self._open_more, "active")
        return [
            self._scene,
            *items,
            more,
            _heading("Views"),
            self._views,
            _heading("Share"),
            *self._share(),
        ]

    def _share(self) -> list[Any]:
        link = pmui.Button(
            label="Link",
            icon="link",
            variant="outlined",
            size="small",
            description="Copy the address, which has the settings and what is looked at.",
        )
        link.on_click(lambda event: self._copy())
        save = pmui.FileDownload(
            label="Save",
            callback=self._saved,
            filename="slipfront.toml",
            size="small",
            variant="outlined",
            description="Save the settings; the command line reads them too.",
        )
        default = pmui.Button(
            label="Defaults",
            icon="undo",
            variant="outlined",
            size="small",
            description="Bring all settings back to their defaults.",
        )
        default.on_click(lambda event: self._adopt(type(self._session.settings).checked({})))
        upload = pmui.FileInput(
            label="Open settings (.toml) or load (.csv)",
            accept=".toml,.csv",
            size="small",
            sizing_mode="stretch_width",
        )
        upload.param.watch(self._on_upload, "value")
        return [pmui.Row(link, save, default), upload]

    def _make_controls(self, *, essential: bool) -> dict[str, Control]:
        made = {
            name: make_control(name, definition, self._on_setting, self._points_of, self._let_go)
            for name, definition in self._session.wanted.definitions().items()
            if about(definition).essential is essential
        }
        return {name: control for name, control in made.items() if control is not None}

    def _open_more(self, event: Any) -> None:
        """Make the controls behind "more" when they are first looked at: few ever are."""
        if event.new and not self._more.objects:
            self.obey()
            more = self._make_controls(essential=False)
            self._controls.update(more)
            self.show(self._session.wanted)
            self._more[:] = [control.view for control in more.values()]

    def _points_of(self, name: str) -> list[tuple[float, float]]:
        """Give points that stand for the preset of a curve setting."""
        return points_of(self._session.wanted, name)

    def _let_go(self, name: str) -> None:
        """Follow the end of a drag."""
        self._in_hand.discard(name)
        self.obey()
        self._session.let_go()

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

    def _on_upload(self, event: Any) -> None:
        if event.new is None:
            return
        try:
            text = event.new.decode("utf-8-sig")
            if event.obj.filename.endswith(".toml"):
                self._adopt(settings_from_toml(text))
            else:
                self._on_setting(*load_in(text, event.obj.filename, self._session.wanted))
        except SettingError as refusal:
            self._complain(str(refusal))
        except UnicodeDecodeError:
            self._complain("The file is not text: give a settings file (.toml) or a table (.csv).")

    def _saved(self) -> StringIO:
        facts = self._session.facts
        warm = facts is not None and facts.was_warm
        return StringIO((WARM_NOTE if warm else "") + dump(self._session.settings))


def _heading(text: str) -> Any:
    return pmui.Typography(text, variant="overline", margin=(6, 10, -6, 10))
