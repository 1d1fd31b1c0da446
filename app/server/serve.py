"""One page for every session that opens one."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from html import escape
from typing import Any

import panel as pn
from bokeh.document import Document
from panel.io.state import set_curdoc
from panel_material_ui.template.base import Page

from app.components.innards import forget
from app.languages.language import preferred
from app.picture.units import COOKIE
from app.server.lateness import Lateness
from app.session.pages import Pages, most_pages
from app.session.report_executor import shared_executor
from app.session.session import Session
from app.session.state import PACES
from app.session.turns import Turns
from app.shell.address import (
    class_from_query,
    settings_from_query,
    sight_from_query,
    twin_from_query,
)
from app.shell.dashboard import Dashboard
from app.whatif.question import question_from_query
from app.worker.link import warm_up

PAGES = Pages(most_pages())
LATENESS = Lateness()
NAMES: set[str] = set()
"""Of the pages that are open."""
FULL = (
    "<h2>Slipfront is full</h2><p>This server has as many pages open as it can serve. "
    "This page tries again by itself.</p><meta http-equiv=refresh content=20>"
)
NO_CLASS = (
    "<h2>There is no class {}</h2><p>It has ended, or a letter is wrong: ask for its code.</p>"
    "<form><label>Code of the class <input name=class required size=6 maxlength=12 "
    "autocomplete=off autocapitalize=characters autofocus></label> <button>Follow</button></form>"
    "<p><a href='?'>Go on by myself</a></p>"
)


def open_page() -> Page:
    """Make the page of one session; its run starts when the browser is there."""
    _configure()
    if PAGES.is_full:
        return _said(FULL, "full")
    document = pn.state.curdoc
    assert document is not None
    query = pn.state.location.search if pn.state.location else ""
    room, missing = class_from_query(query)
    if missing:
        return _said(NO_CLASS.format(escape(missing)), "missing")
    settings, complaint = settings_from_query(query)
    sight, more = sight_from_query(query, pn.state.cookies.get(COOKIE, ""))
    twin, refused = twin_from_query(query, settings)
    turns = Turns(document.add_next_tick_callback)
    first = room.settings if room else settings
    session = Session(PAGES, shared_executor(), first, turns=turns)
    if room is not None:
        session.attendance.follow(room)
    else:
        session.twin = twin
    session.set_pace(PACES[sight.pace])
    complaint = " ".join(filter(None, (complaint, more, refused)))
    chosen = sight.lang or preferred(str(pn.state.headers.get("Accept-Language", "")))
    looks = {"units": sight.units, "language": chosen}
    session.watch(phase=sight.instant, complaint=complaint, **looks)
    session.question = question_from_query(query)
    dashboard = Dashboard(
        session,
        sight=sight,
        on_phone=is_phone(pn.state.headers),
    )
    NAMES.add(dashboard.pulse.page)
    pn.state.onload(dashboard.loaded)
    pn.state.on_session_destroyed(partial(_end, dashboard, document))
    pn.state.log(f"page opened, {len(PAGES)} in all")
    return dashboard.page


def is_phone(headers: Mapping[str, str | list[str]]) -> bool:
    """Tell from a request whether a phone asks, which has room for the run alone."""
    return headers.get("Sec-Ch-Ua-Mobile") == "?1" or "Mobi" in headers.get("User-Agent", "")


def facts() -> dict[str, Any]:
    """Say how the server fares: its pages, their workers, how late the event loop was, s."""
    return {"pages": len(PAGES), "workers": PAGES.workers, "lateness": LATENESS.facts()}


def rehearse() -> None:
    """Start a worker and build a page, for nothing: what is done once only is then done."""
    warm_up()
    document = Document()
    with set_curdoc(document):
        _configure()
        session = Session(PAGES, shared_executor(), settings_from_query("")[0])
        dashboard = Dashboard(session)
        dashboard.page.server_doc(document)
        document.to_json()
        session.close()


def _end(dashboard: Dashboard, document: Document, _context: Any) -> None:
    """Leave nothing behind when a page is gone."""
    dashboard.session.close()
    NAMES.discard(dashboard.pulse.page)
    forget(document)
    pn.state.log(f"page closed, {len(PAGES)} left")


def _said(html: str, role: str) -> Page:
    """Say something on a page of its own."""
    return Page(title="Slipfront", main=[pn.pane.HTML(html, css_classes=[role])])


def _configure() -> None:
    # A page that is cut off connects again by itself (`pulse.js`), and to its own server alone.
    pn.extension(notifications=True, respect_explicit_sizing=True)
