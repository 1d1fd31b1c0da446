"""Every term of the page has one line, and every line a term that the page uses."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

import pytest
from pages import ENDLESS, Visit, iteration, one_page, slider, status
from playwright.sync_api import Locator, Page, expect
from shown_pages import SMALL, Shown, keys

from app.picture.glossary import TERMS, explained
from app.views.catalogue import fitting
from app.worker.key_figures import FIGURES
from solver.scenes.bar import BarSettings

ROOT = Path(__file__).resolve().parents[1]
LINES = {one.lower(): line for spellings, line in TERMS.items() for one in spellings}
TERM = re.compile(r'<abbr tabindex="0">(.*?)</abbr>')
PLAIN = re.compile(
    r"A|B|pressure p|friction|thickness not to scale|von Mises|chosen|now|\d.*|.*, [\d.]+ \S+|"
    r"(xx|yy|xy)|x = .*|\S+ (on|off|\d\S*).*"
)
"""Names in legends that say all: letters of runs, quantities with their value, places, wires."""


def legends(scene: str, **changes: Any) -> set[str]:
    """Give all names in the legends of a scene, of a run with one before it."""
    shown = Shown()
    values = {**SMALL[scene], **changes}
    shown.run(1, scene, values)
    shown.run(2, scene, {**values, "friction": 0.25})
    seen = shown.scene()
    return {name for view in fitting(seen.run.settings) for name in keys(view.draw(seen, None))}


@pytest.mark.parametrize(
    ("scene", "changes"), [*((name, {}) for name in SMALL), ("bar", {"linear_stage": "pgd"})]
)
def test_every_name_in_a_legend_has_a_line(scene: str, changes: dict[str, Any]) -> None:
    names = legends(scene, **changes)
    assert names
    assert [one for one in names if not (TERM.search(explained(one)) or PLAIN.match(one))] == []


def strings(file: Path) -> str:
    """Give all strings of a program that are no docstrings."""
    tree = ast.walk(ast.parse(file.read_text(encoding="utf-8")))
    nodes = [node for node in tree if not isinstance(node, ast.Expr)]
    found = (one for node in nodes for one in ast.iter_child_nodes(node))
    return " ".join(
        one.value for one in found if isinstance(one, ast.Constant) and isinstance(one.value, str)
    )


def line_of(term: str) -> str:
    """Say what a term means, however it is spelt; empty for one that is none."""
    return LINES.get(term.lower()) or LINES.get(term.lower().removesuffix("s"), "")


def test_every_key_figure_has_a_line() -> None:
    assert all(line_of(head) for head in FIGURES)


def test_every_term_stands_on_the_page() -> None:
    files = {file for folder in ("app", "solver") for file in (ROOT / folder).rglob("*.py")}
    said = " ".join(map(strings, files - {ROOT / "app" / "picture" / "glossary.py"})).lower()
    assert [one for spellings in TERMS for one in spellings if one.lower() not in said] == []


def test_no_two_terms_are_spelt_alike() -> None:
    spelt = [one.lower() for spellings in TERMS for one in spellings]
    assert len(spelt) == len(set(spelt))


def test_a_term_is_marked_where_it_first_stands_and_nowhere_inside_another_or_a_tag() -> None:
    text = '<i class="mode">two modes</i> of the k-free indicator, a mode, an indicator, a model'
    assert TERM.findall(explained(text)) == ["modes", "k-free indicator", "indicator"]
    assert TERM.sub(r"\1", explained(text)) == text


page = one_page(
    "?elements=20&substructures=2&instants=11&finish=at+once", "✓ converged", has_touch=True
)
"""A page whose run has ended, on a device with a mouse and a screen to touch."""


def words_in_sight(page: Page) -> list[Locator]:
    """Give all words that are explained and stand on the page."""
    found = [one for one in page.locator("abbr").all() if one.is_visible()]
    assert len(found) > 20
    return found


def test_what_is_explained_follows_a_mouse_from_word_to_word(page: Page) -> None:
    note = page.get_by_role("tooltip")
    for word in words_in_sight(page):
        word.hover()
        expect(note).to_have_text(line_of(word.inner_text()))
    word.click()
    expect(note).to_have_text(line_of(word.inner_text()))
    page.locator(".status").first.hover(position={"x": 2.0, "y": 2.0})
    expect(note).to_be_hidden()


def test_what_is_explained_follows_a_finger_from_word_to_word(page: Page) -> None:
    note = page.get_by_role("tooltip")
    for word in words_in_sight(page):
        word.tap()
        expect(note).to_have_text(line_of(word.inner_text()))
    page.locator(".status").first.tap(position={"x": 2.0, "y": 2.0})
    expect(note).to_be_hidden()


def test_what_is_explained_follows_the_keyboard_from_word_to_word(page: Page) -> None:
    note, words = page.get_by_role("tooltip"), page.locator(".figures abbr")
    page.get_by_role("button", name="Method").press("Enter")
    words.first.focus()
    for word in words.all_text_contents()[1:]:
        page.keyboard.press("Tab")
        expect(note).to_have_text(line_of(word))
        expect(page.locator(".figures abbr:focus")).to_have_attribute(
            "aria-description", line_of(word)
        )
    page.keyboard.press("Escape")
    expect(note).to_be_hidden()


def test_all_words_are_in_a_list(page: Page) -> None:
    page.keyboard.press("?")
    expect(page.get_by_role("dialog")).to_contain_text(line_of("singular value"))
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_be_hidden()


def test_a_term_keeps_the_focus_while_pictures_come(open_page: Visit) -> None:
    page = open_page(f"?elements=20&substructures=2&instants=11&{ENDLESS}&plots=Scene")
    expect(status(page)).to_contain_text("running")
    page.locator(".figures abbr", has_text="Slips").focus()
    before = iteration(page)
    while iteration(page) < before + 5:
        page.wait_for_timeout(100)
    expect(page.get_by_role("tooltip")).to_have_text(line_of("slip"))
    expect(page.locator(".figures abbr", has_text="Slips")).to_be_focused()


def test_what_a_control_is_for_is_said_to_the_keyboard(page: Page) -> None:
    help_of = {name: one.doc for name, one in BarSettings.definitions().items()}
    note = page.get_by_role("tooltip")
    slider(page, "Peak load").focus()
    for _ in range(3):
        page.keyboard.press("Tab")
        place = page.locator(".sidebar [class*=setting-]").filter(has=page.locator(":focus"))
        name = (place.get_attribute("class") or "").removeprefix("setting-")
        expect(note).to_contain_text(help_of[name])
        expect(place.locator("input:focus, select:focus")).to_have_attribute(
            "aria-description", re.compile(re.escape(help_of[name]))
        )
    page.mouse.click(640, 300)
    expect(note).to_be_hidden()
