"""What the page is made of: panes that the style sheet knows by their roles, buttons and lists."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel_material_ui.template.base import Page

from app.components.innards import ignore_business
from app.components.theme import template_in
from app.languages.language import Language

APP = Path(__file__).resolve().parents[1]
STATIC = APP.parent / "static"
STYLE = (STATIC / "style.css").read_text(encoding="utf-8")

HEADER = {
    "& .header .MuiBox-root:has(> .child-wrapper)": {
        "display": "flex",
        "flex": "1",
        "alignItems": "center",
    },
    "@media (max-width: 899px)": {"& .title": {"display": "none"}},
}
"""Its parts have all of its width; the name of the page goes where there is no room for it."""


CLOSE = {
    "& .MuiSelect-select": {
        "fontSize": "14px",
        "lineHeight": "23px",
        "padding": "6px 22px 6px 8px !important",
    }
}
"""A list in a row of others has no room to spare."""
SLIM = {
    "& .MuiSelect-select": {
        **CLOSE["& .MuiSelect-select"],
        "padding": "1px 22px 1px 8px !important",
    }
}
"""One in a line of text has less."""


def column(*parts: Any, role: str, **options: Any) -> pn.Column:
    """Put parts one below the other."""
    return pn.Column(*parts, **{"margin": 0, **looks(role), **options})


def row(*parts: Any, **options: Any) -> pn.FlexBox:
    """Put parts beside each other, as many as there is room for."""
    return pn.FlexBox(*parts, flex_wrap="wrap", sizing_mode="stretch_width", **options)


def text(html: str = "", *, role: str, **options: Any) -> pn.pane.HTML:
    """Show words; pictures find them by their tag, if they have one."""
    return pn.pane.HTML(html, **{"margin": (2, 10), **looks(role), **options})


def button(label: str, icon: str, act: Callable[[], None], **options: Any) -> pmui.Button:
    """Give a small button that does something."""
    made = pmui.Button(label=label, icon=icon, size="small", **options)
    made.on_click(lambda event: act())
    return made


def select(
    label: str, options: Any, choose: Callable[[Any], None] = lambda value: None, **more: Any
) -> pmui.Select:
    """Give a small list to choose from; `choose` is told what is chosen."""
    made = pmui.Select(label=label, options=options, size="small", **{"sx": CLOSE, **more})
    made.param.watch(lambda event: choose(event.new), "value")
    return made


def script(*names: str) -> str:
    """Give the program of a component: these files one after the other.

    Of a name without a folder the folder is that of the components.
    """
    files = (APP / name if "/" in name else APP / "components" / name for name in names)
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


def page(sidebar: Any, header: list[Any], main: Any, say: Language) -> Page:
    """Make a page with its parts at their places."""
    made = Page(
        title="Slipfront",
        favicon=STATIC / "logo.svg",
        logo=STATIC / "logo.svg",
        sidebar=[sidebar],
        sidebar_width=310,
        header=header,
        main=[main],
        sx=HEADER,
        busy_indicator=None,
        template=template_in(say),
        meta_description="A laboratory for frictional contact: LATIN iterations, live.",
    )
    ignore_business(made)
    return made


def looks(role: str) -> dict[str, Any]:
    """Give what has the style sheet know a pane by its roles."""
    classes = role.split()
    return {"css_classes": classes, "stylesheets": [STYLE], "sizing_mode": "stretch_width"}
