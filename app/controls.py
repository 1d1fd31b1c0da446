"""The controls at the side: a Panel widget for each setting, from its definition."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.browser import fade_first
from app.echoes import linked
from app.files.opener import files_panel
from app.setting_control import WIDTH, SettingControl
from app.state import PageState
from app.widgets import looks, mask_of, rebuilt
from solver.scenes import CATALOGUE
from solver.settings.definitions import properties_of

FILES = "Files"
"""Title of the group that saves and opens files; the other groups have settings."""
GROUPS = (
    "Load",
    "Ends",
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
"""Order of the groups: the scene, then its solution from Decomposition on."""


class Controls:
    """All controls of the present scene: main ones, and groups that open.

    Controls that are not in sight follow the state once they are opened: each widget
    costs a browser time.
    """

    def __init__(self, state: PageState, *, is_open: bool = True) -> None:
        self._state = state
        self._is_open = is_open
        # Toggle buttons have no pictures of their own: rules of style give each of them
        # one.
        pictures = {
            f"& .MuiToggleButton-root:nth-of-type({number})::before": mask_of(kind.icon)
            for number, kind in enumerate(CATALOGUE.values(), start=1)
        }
        self._scene = pmui.RadioButtonGroup(
            options={name.capitalize(): name for name in CATALOGUE},
            value=state.settings.scene,
            width=WIDTH,
            margin=0,
            size="small",
            sx=pictures,
            **looks("pictures"),
        )
        self._show_scene = linked(
            self._scene, state, lambda: state.settings.scene, self._choose_scene
        )
        self._groups = pmui.Accordion(
            margin=(10, 0),
            width=WIDTH,
            title_variant="body2",
            disable_gutters=True,
            elevation=0,
            **looks("groups"),
        )
        self._groups.param.watch(lambda event: self._open(), "active")
        self.view = pmui.Column(self._scene, self._groups, width=WIDTH, margin=(4, 12))
        self._files: pn.Column | None = None
        self._built = ""
        self._titles: list[str] = []
        self._chief: list[str] = []
        self._made: dict[str, SettingControl] = {}
        state.param.watch(lambda event: self.update(), "settings")
        self.update()

    def _choose_scene(self, scene: str) -> None:
        fade_first(self._state, partial(self._state.choose_scene, scene))

    def open(self, is_open: bool) -> None:
        """Start or stop following the state."""
        self._is_open = is_open
        self.update()

    def update(self) -> None:
        """Show the present values, if the controls are open.

        With another scene build the controls of that scene.
        """
        if not self._is_open:
            return
        settings = self._state.settings
        with pn.io.hold():
            if settings.scene != self._built:
                with rebuilt():
                    self._build()
            else:
                for control in self._made.values():
                    control.update()
                self._complete()

    def _build(self) -> None:
        settings = self._state.settings
        self._built = settings.scene
        self._show_scene()
        self._scene.label = settings.title
        self._made = {}
        self._chief, groups = _groups_of(type(settings))
        self._complete()
        # The numbers of open groups would mean groups of the scene before. Files alone
        # stay open: settings that a file brings with their scene have a message.
        has_files = FILES in [self._titles[number] for number in self._groups.active]
        self._groups.active = []
        self._titles = [*groups, FILES]
        # Each group is a spacer until it is opened: it costs a page less than a column.
        self._closed = dict(enumerate([*groups.items(), (FILES, [])]))
        # A title that is given beside a group costs a pane that nobody sees. The names
        # of groups are read where their number changes.
        self._groups.objects = []
        self._groups.objects = [
            pn.Spacer(name=title, height=0) for title in self._titles
        ]
        if has_files:
            self._groups.active = [len(groups)]

    def _complete(self) -> None:
        """Make the main controls that apply; others would cost each page their time."""
        settings = self._state.settings
        missing = [name for name in self._chief if name not in self._made]
        new = [name for name in missing if settings.applies(name)]
        for name in new:
            self._made[name] = SettingControl(name, self._state)
        if new:
            made = [self._made[name] for name in self._chief if name in self._made]
            self.view[1:-1] = views_of(made)

    def _open(self) -> None:
        """Build groups that are opened for the first time."""
        for number in self._closed.keys() & set(self._groups.active):
            _, names = self._closed.pop(number)
            if names:
                controls = {name: SettingControl(name, self._state) for name in names}
                self._made |= controls
                view = pn.Column(*views_of(controls.values()), margin=0)
            else:
                if self._files is None:
                    self._files = files_panel(self._state, WIDTH)
                view = self._files
            views = list(self._groups)
            views[number] = view
            self._groups.objects = views


def views_of(controls: Iterable[SettingControl]) -> list[Any]:
    """Widgets of controls on the page, in order."""
    views = []
    for control in controls:
        views += control.views
    return views


def _groups_of(kind: Any) -> tuple[list[str], dict[str, list[str]]]:
    """The main settings of a scene, and other variable ones by group."""
    definitions = kind.definitions()
    chief = [name for name in (*kind.CHIEF, *kind.ALSO_CHIEF) if name in definitions]
    groups: dict[str, list[str]] = {group: [] for group in GROUPS}
    for name, definition in definitions.items():
        if name not in chief and len(getattr(definition, "objects", "any")) > 1:
            groups.setdefault(properties_of(definition).group, []).append(name)
    return chief, {group: names for group, names in groups.items() if names}
