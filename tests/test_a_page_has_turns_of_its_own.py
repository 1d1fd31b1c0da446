"""What threads and other pages ask for is done in turns of the page, once it stands there."""

from __future__ import annotations

import asyncio
from contextlib import closing

import panel as pn
import pytest
from bokeh.document import Document
from lone_link import lone_session
from panel.io.state import set_curdoc
from web_pages import run_apart

from app.session.turns import Act, Turns
from app.shell.dashboard import Dashboard
from solver.files import scene_settings

MOMENT = 0.01
TURNS = 5
"""Of the loop, more than anything here takes."""


async def rest() -> None:
    for _ in range(TURNS):
        await asyncio.sleep(0.0)


def test_nothing_has_a_turn_before_the_browser_has_built_the_page() -> None:
    pn.extension(notifications=True)

    async def open_page() -> tuple[list[str], list[str]]:
        done: list[str] = []
        turns = Turns(lambda act: act())
        settings = scene_settings("bar").checked({})
        with closing(lone_session(settings, turns)) as session:
            page = Dashboard(session)
            turns.soon(lambda: done.append("news"))
            turns.timer(lambda: done.append("timer")).set(0.0)
            await asyncio.sleep(MOMENT)
            before = list(done)
            page.loaded()
            turns.soon(lambda: done.append("more"))
            await rest()
            return before, done

    before, after = run_apart(open_page())
    assert before == []
    assert after == ["news", "timer", "more"]


@pytest.mark.parametrize("way", ["soon", "later"])
def test_what_another_page_asks_for_is_not_done_with_its_document(way: str) -> None:
    async def ask() -> list[Document | None]:
        seen: list[Document | None] = []
        turns = Turns(lambda act: act())
        turns.begin()

        def look() -> None:
            seen.append(pn.state.curdoc)

        with set_curdoc(Document()):
            if way == "soon":
                turns.soon(look)
            else:
                turns.later(0.0, look)
        await asyncio.sleep(MOMENT)
        return seen

    assert run_apart(ask()) == [None]


def test_a_page_that_is_closed_has_no_more_turns() -> None:
    async def close() -> list[str]:
        done: list[str] = []
        turns = Turns(lambda act: act())
        turns.begin()
        first: Act = turns.close
        turns.soon(first)
        turns.soon(lambda: done.append("late"))
        await rest()
        return done

    assert run_apart(close()) == []
