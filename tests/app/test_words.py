"""Terms have their meaning where they stand, and each is said once."""

from __future__ import annotations

import pytest

from app.status import TERMS
from app.views.catalogue import CARDS
from app.views.view import View
from app.widgets import GLOSSARY, MEANINGS, ROW, explained


@pytest.mark.parametrize("term", TERMS)
def test_a_term_of_the_status_has_its_meaning_at_hand(term: str) -> None:
    written = explained(f"12 {term} · 3", *TERMS)
    assert written.startswith("12 <abbr")
    assert written.striptags() == f"12 {term} · 3"
    assert MEANINGS[term][:12] in written


@pytest.mark.parametrize("kind", [kind for card in CARDS for kind in card])
def test_every_plot_says_what_it_shows(kind: type[View]) -> None:
    assert kind.name in MEANINGS


def test_a_word_is_explained_once() -> None:
    words = [word for words, _ in ROW.findall(GLOSSARY) for word in words.split(", ")]
    words = [word for word in words if word not in ("Word", "Plot", "Key")]
    assert sorted(set(words)) == sorted(words)


def test_markup_in_a_text_is_text_and_a_term_within_a_word_is_none() -> None:
    written = explained("<b>wrongly</b> researched", *TERMS)
    assert "<" not in written
    assert written.unescape() == "<b>wrongly</b> researched"
