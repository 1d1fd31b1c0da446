"""The page: its header, the controls at the side, and the tabs of the main area."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.io.resources import LOCAL_DIST
from panel.util import edit_readonly

from app.browser import AtOnce, Browser
from app.class_dialog import ClassDialog
from app.classroom import ClassMember, begin_with_class
from app.controls import Controls
from app.echoes import linked_to
from app.experiments.fit import FitTab
from app.experiments.reports import Reports
from app.experiments.whatif import WhatIf
from app.files.export import LOOK, offers
from app.lessons.guide import Guide, kinds_beside
from app.link import Link, read, show
from app.live import STYLE, Live, column, first_needs, large_type, type_size
from app.server import PAGES
from app.state import TABS, WHAT_IF, PageState
from app.status import spoken_status
from app.supervisor import Supervisor
from app.templates import html
from app.transport import TOUCHED
from app.widgets import GLOSSARY, PlainText, button, dialog, looks, wrapped

NO_SLIDING = {"transition": "none"}
"""Look of what takes its size at once as the controls open and close: figures would be
painted in each size on the way."""
COMPACT = {
    "& .MuiToolbar-root": {"minHeight": "48px !important"},
    "& .main": NO_SLIDING,
    # On a phone the buttons are moved by a finger.
    "@media (max-width: 600px)": {
        "& header .title": {"display": "none"},
        "& header": {"overflowX": "auto"},
        "& header .MuiToolbar-root": {"padding": "0 4px 0 14px"},
        "& header .MuiIconButton-edgeStart": {"marginRight": 0},
    },
    # In a narrow window the controls are a sheet below the picture, which stays in
    # sight while they are moved.
    "@media (max-width: 899px)": {
        "& nav": {"width": "0 !important"},
        "& .main": {"marginLeft": "0 !important"},
        "& .sidebar": {
            "position": "fixed !important",
            "inset": "auto 0 0 0 !important",
            "width": "100% !important",
            "height": "45vh !important",
            "borderTop": "1px solid var(--mui-palette-divider)",
            "boxShadow": "0 -2px 14px rgba(0, 0, 0, 0.25)",
        },
        "& .sidebar > .MuiToolbar-root": {"display": "none"},
    },
}
LOADING = """
#loader { background: none !important; }
#loader:not(.error)::after {
  content: "Slipfront is loading …";
  font: 18px Roboto, sans-serif;
}
"""
"""Style of what is seen until the page is there."""
NETWORK = """
#network {
  position: fixed; inset: 8px 0 auto; z-index: 2000; margin: auto;
  width: fit-content; max-width: 90%; padding: 8px 14px; border-radius: 6px;
  background: #B3261E; color: #FFF; font: 15px Roboto, sans-serif;
}
#network:empty { display: none; }
"""
"""Style of what is said of a network that is lost, over the header."""
READ = 15.0
"""Type size of the text beside the plots, px."""
HEADINGS = {
    "components": {
        # The page's title; spacers of the template.
        "MuiTypography": {
            "defaultProps": {"variantMapping": {"h3": "h1", "h5": "div"}}
        },
        "MuiAccordion": {
            "defaultProps": {"slotProps": {"heading": {"component": "h2"}}}
        },
    }
}
"""Elements of headings in the theme: else the page would have none of first rank."""
BARE = {
    # It stands over the page and takes no room; what it holds need not change its size.
    "& .header": {"visibility": "hidden"},
    "& .main": NO_SLIDING,
    "& .main .MuiToolbar-root": {"display": "none"},
}


class Page:
    """A page of one session: state, worker, widgets and views; `template` is served.

    The first run waits at `iteration`; with 0 it continues.
    """

    def __init__(self, state: PageState, iteration: int = 0) -> None:
        self.state = state
        document = pn.state.curdoc
        self._browser = Browser(name="browser")
        self._link = Link(state, self._browser)
        self._supervisor = Supervisor(state, document)
        if not state.room:
            # The first picture is there once the browser is.
            state.needs = first_needs(state, kinds_beside(state))
            self._supervisor.begin()
            state.reset(iteration or 1)
            state.running = not iteration
        self._live = Live(state, document)
        self._member = ClassMember(state, self._supervisor, document)
        transport = self._live.transport
        open_counts = self._member.open_counts
        self._guide = Guide(state, transport, self._dress, open_counts)
        self._class = ClassDialog(self._member, self._link.join)
        self._guide.view.stylesheets = [STYLE]
        self._class.view.stylesheets = [STYLE]
        self._refusal = PlainText(margin=(4, 8), styles={"font-weight": "bold"})
        self._refused = pn.Row(
            self._refusal, margin=0, css_classes=["refused"], stylesheets=[STYLE]
        )
        self._beside = wrapped(
            self._live.view, self._guide.view, sizing_mode="stretch_width"
        )
        self._tabs: dict[str, Any] = {TABS[0]: self._beside}
        self._main = column("main", self._beside)
        self._make_dialogs()
        self._controls = Controls(state, is_open=self._has_controls)
        self.template = self._framed()
        document.add_next_tick_callback(self._fill)
        follow_itself(self.template)
        keys = transport.keys() | {"p": self._present, "?": self._help}
        self._browser.listen(state, document, keys)
        self._follow_state()
        self._turn(state.tab)
        self._guide.show()

    def _make_dialogs(self) -> None:
        """Make the dialogs of the page; each is put on the page when first opened."""
        self._dialogs = pmui.Column(margin=0, height=0)
        self._away = dialog("Take away")
        self._words = dialog(
            "Keys and words", pn.pane.Markdown(GLOSSARY), width_option="md"
        )
        dialogs = [
            *self._guide.dialogs.values(),
            self._class.dialog,
            self._away,
            self._words,
        ]
        for each in dialogs:
            each.param.watch(self._put, "open")
        self._away.param.watch(lambda event: self._live.offer(event.new), "open")

    def _framed(self) -> pmui.Page:
        """Make the template with header, controls and main area."""
        return pmui.Page(
            title="Slipfront",
            sidebar_width=320,
            sidebar_open=self._has_controls,
            sidebar_variant="persistent",
            raw_css=[LOADING, NETWORK],
            busy_indicator=None,
            # As `theme` in the address has it, and a person chooses.
            dark_theme=self.state.is_dark,
            sx=COMPACT,
            theme_config=HEADINGS,
        )

    def _fill(self) -> None:
        """Put the parts on the page, while the browser loads scripts.

        Each stands in a component of its own: Bokeh lays out all that a component holds
        whenever one widget in it is mounted, or changes its size.
        """
        self.template.param.update(
            sidebar=[self._controls.view],
            header=[self._header()],
            main=[pmui.Column(self._main, margin=0, sizing_mode="stretch_width")],
        )
        self._live.prepare(kinds_beside(self.state))

    def _follow_state(self) -> None:
        """Watch the state, and show the line of the class."""
        self._class.view.param.watch(lambda event: self._place(), "visible")
        acts = [*TOUCHED, "plots", "view"]
        watch = self.state.param.watch
        watch(lambda *events: self.state.param.update(is_new=False), acts)
        told = ["newest", "frame", "running", "message", "refusal"]
        watch(
            lambda *events: self._browser.tell(spoken=spoken_status(self.state)),
            told,
        )
        watch(lambda event: self._turn(event.new), "tab")
        watch(lambda event: self._place(), "refusal")
        watch(lambda event: self._dress(), "view")
        watch(lambda event: self._show_controls(), "is_narrow")
        watch(lambda event: self._on_height(), "height")
        self.template.param.watch(
            lambda event: self.state.param.update(is_dark=event.new), "dark_theme"
        )
        # A person may open or close the controls, too.
        self.template.param.watch(
            lambda event: self._on_controls(event.new), "sidebar_open"
        )

    def loaded(self) -> None:
        """Show the figures when the browser is connected, and run or follow a class."""
        self._supervisor.open()
        self._live.open(kinds_beside(self.state))
        PAGES.opening.discard(self.state)
        if not self.state.room:
            self._live.display.pulse.on_change("painted", self._go_on)
        elif not self._member.enter(self.state.room):
            self._supervisor.begin()
            self.state.run()

    def _go_on(self, name: str, old: int, new: int) -> None:
        """Run when the first picture is painted: the search is seen from its start.

        While the browser still mounts widgets, some of them would not show changes.
        """
        self._live.display.pulse.remove_on_change("painted", self._go_on)
        if self.state.running:
            self.state.param.trigger("pace")

    def end(self, _context: Any) -> None:
        """Leave the class, and end the worker, after the page was closed."""
        self._member.close()
        self._supervisor.end()
        PAGES.opening.discard(self.state)
        PAGES.leave()

    def _header(self) -> pmui.Row:
        actions: dict[str, tuple[str, Callable[[Any], None]]] = {
            "Lessons": ("school", lambda event: self._guide.offer("lesson")),
            "Cases": ("cases", lambda event: self._guide.offer("case")),
            "A class": ("groups", lambda event: self._class.open()),
            "Presenter view (p)": ("slideshow", lambda event: self._present()),
            "Take away": ("download", lambda event: self._take_away()),
            "Keys and words (?)": ("help_outline", lambda event: self._help()),
        }
        tabs = pmui.RadioButtonGroup(
            options=TABS,
            value=self.state.tab,
            size="small",
            margin=(7, 8, 0, 8),
            # All others stand at the other end.
            styles={"margin-right": "auto"},
            **looks("in-header"),
        )
        linked_to(self.state, "tab", tabs)
        # A phone has room for the first button: the others are in a list there.
        buttons = []
        roles = ["in-header"]
        for title, (icon, action) in actions.items():
            look = {"margin": 0, **looks(*roles)}
            buttons.append(
                pmui.IconButton(icon=icon, description=title, on_click=action, **look)
            )
            roles = ["in-header", "of-desk"]
        parts = [tabs, *buttons, AtOnce()]
        header = pmui.Row(*parts, margin=0, sizing_mode="stretch_width")

        def complete() -> None:
            """Add the list once a window is narrow: a wide one hides it."""
            if self.state.is_narrow and len(header) == len(parts):
                header.insert(-1, _listed(actions))

        self.state.param.watch(lambda event: complete(), "is_narrow")
        complete()
        return header

    def _present(self) -> None:
        """Switch between the view for a projector and the normal one."""
        self.state.view = "present" if self.state.view == "page" else "page"

    def _on_height(self) -> None:
        self._read()
        self._live.arrange(kinds_beside(self.state))

    def _read(self) -> None:
        """Set the type size of the text next to the plots to that of the plots."""
        styles = {}
        if self.state.view == "present":
            zoom = f"{large_type(self.state) / READ:.2f}"
            styles = {
                "zoom": zoom,
                "--zoom": zoom,
                "--above": "4px",
            }
        self._guide.view.styles = styles
        self._guide.magnify(type_size(self.state))

    def _put(self, event: Any) -> None:
        """Put a dialog on the page when the dialog is first opened."""
        if event.obj not in self._dialogs:
            self._dialogs.append(event.obj)
        if self._dialogs not in self.template.main:
            self.template.main = [*self.template.main, self._dialogs]

    def _take_away(self) -> None:
        """Open the dialog with the link to the page and files to save."""
        copied = PlainText(margin=(0, 8))

        def copy() -> None:
            copied.object = self._link.copy()

        link = button("Copy link", copy, icon="link", **LOOK)
        self._away[:] = [
            link,
            copied,
            *offers(self.state, list(self._live.display.views)),
        ]
        self._away.open = True

    def _help(self) -> None:
        self._words.open = True

    def _turn(self, tab: str) -> None:
        """Show a tab; build the tab when it is first opened."""
        if tab not in self._tabs:
            kind = {WHAT_IF: WhatIf, "Fit": FitTab, "Reports": Reports}[tab]
            self._tabs[tab] = kind(self.state).view
        self._place()
        self._live.look()

    def _place(self) -> None:
        """Put only visible parts on the page.

        Beside hidden parts the browser does not paint figures.
        """
        # The text is hidden in its place: a row whose children change has all others
        # rendered again. Text and line of the class are put in front by the style
        # sheet: a column whose children change their order loses some of them.
        self._guide.view.visible = self._guide.is_open
        main = [self._tabs[self.state.tab]]
        roles = ["main", self.state.view]
        if self._class.view.visible:
            main.append(self._class.view)
            roles.append("with-line")
        # The tab Live has it in its status line.
        if self.state.refusal and self.state.tab != TABS[0]:
            self._refusal.object = self.state.refusal
            main.append(self._refused)
        if list(self._main) != main:
            self._main[:] = main
        self._main.css_classes = roles
        is_projected = self.state.view == "present"
        # The bar of a run leads back from it; other tabs keep the header for that.
        is_bare = is_projected and self.state.tab == TABS[0]
        self.template.sx = BARE if is_bare else COMPACT

    def _dress(self) -> None:
        """Arrange the plots of the lesson or view, and show or hide the controls.

        A lesson has the plots that it speaks of; the view for a projector shows a run
        alone.
        """
        self._place()
        self._read()
        self._live.arrange(kinds_beside(self.state))
        self._show_controls()

    @property
    def _has_controls(self) -> bool:
        """Check whether controls are at the side, and cover nothing."""
        is_alone = self.state.view == "page" and not self._guide.is_open
        return is_alone and not self.state.is_narrow

    def _show_controls(self) -> None:
        self.template.sidebar_open = self._has_controls

    def _on_controls(self, is_open: bool) -> None:
        self._controls.open(is_open)
        self._live.make_room(is_open and self.state.is_narrow)


def _listed(actions: dict[str, tuple[str, Callable[[Any], None]]]) -> pmui.MenuButton:
    """A list of all buttons of the header but the first, by their icons and actions."""
    titles = list(actions)[1:]
    return pmui.MenuButton(
        label="",
        icon="more_vert",
        icon_size="24px",
        items=[{"label": title, "icon": actions[title][0]} for title in titles],
        variant="text",
        description="More",
        on_click=lambda item: actions[item["label"]][1](None),
        margin=0,
        **looks("in-header", "of-phone"),
    )


def follow_itself(template: pmui.Page) -> None:
    """Show a page as loading while it loads, not while the server is busy.

    Each event of a page would be told to all others, and what watches the server as a
    whole keeps the page in memory once it is closed. A value in place of the reference
    leaves the watcher.
    """
    with edit_readonly(template):
        template.busy = template.param.loading


def open_page() -> pmui.Page:
    """Make the page of one session; its run starts when the browser is connected."""
    # Without notifications: each page's would stay in Panel's table of views for good.
    pn.extension(
        "katex",
        reconnect=True,
        respect_explicit_sizing=True,
        # Signatures help an editor that completes code, and take 8 ms of each page.
        apply_signatures=False,
    )
    # Panel sets this as it sends a page. One that is made again by the socket, as its
    # session had ended while a slow browser was still loading, is not sent: its style
    # sheets would be asked from the internet.
    pn.state.curdoc.template_variables["dist_url"] = LOCAL_DIST
    if not PAGES.enter():
        words = pn.pane.HTML(html("full.html"), css_classes=["full"])
        full = pmui.Page(title="Slipfront", main=[words])
        follow_itself(full)
        return full
    shown, refusal = read(pn.state.location.search)
    # As long as the browser has not told how wide its window is.
    is_phone = "Mobi" in pn.state.headers.get("User-Agent", "")
    state = PageState(
        shown["settings"],
        refusal=refusal,
        is_narrow=is_phone,
        is_dark=pn.config.theme == "dark",
    )
    iteration = shown.pop("iteration", 0)
    show(state, shown)
    begin_with_class(state)
    PAGES.opening.add(state)
    page = Page(state, iteration)
    pn.state.onload(page.loaded)
    pn.state.on_session_destroyed(page.end)
    return page.template
