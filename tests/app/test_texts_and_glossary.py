"""Terms have their meaning where they stand, and each is said once."""

from __future__ import annotations

from itertools import chain

import pytest

from app.status import TERMS, explained
from app.views.catalogue import CARDS
from app.views.view import View
from app.widgets import GLOSSARY, MEANINGS, ROW, PlainText


@pytest.mark.parametrize("term", TERMS)
def test_a_term_of_the_status_has_its_meaning_at_hand(term: str) -> None:
    written = explained(f"12 {term} · 3")
    assert written.startswith("12 <abbr")
    assert written.striptags() == f"12 {term} · 3"
    assert MEANINGS[term] in written.unescape()


@pytest.mark.parametrize("kind", list(chain.from_iterable(CARDS)))
def test_every_plot_says_what_it_shows(kind: type[View]) -> None:
    assert kind.name in MEANINGS


def test_a_word_is_explained_once() -> None:
    _, _, said = GLOSSARY.partition("#### Words")
    rows = [words.split(", ") for words, _ in ROW.findall(said)]
    words = [word for word in chain.from_iterable(rows) if word != ":---"]
    assert sorted(set(words)) == sorted(words)


def test_markup_in_a_text_is_text_and_a_term_within_a_word_is_none() -> None:
    written = explained("<b>wrongly</b> researched")
    assert "<" not in written
    assert written.unescape() == "<b>wrongly</b> researched"


def test_a_plain_text_is_shown_as_it_is_written() -> None:
    text = PlainText()
    text.object = "<b>3</b>"
    assert text.__panel__().object == "&lt;b&gt;3&lt;/b&gt;"
