"""The words of a page in its language: English as the source has it, others as their files say.

A file `LANGUAGE.po` here is a translation, in the format that translators' tools read: English and
what it is called, text by text. A text that has no translation stays English.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator, Mapping
from functools import cache, cached_property
from pathlib import Path

from solver.phrases import Phrase

FOLDER = Path(__file__).parent
SOURCE = "en"
LANGUAGES = (SOURCE, *sorted(file.stem for file in FOLDER.glob("*.po")))
FORMS, OR = "term", "|"
"""Context in a file of how a term is spelt within sentences, and what stands between spellings."""
LESSON = "lesson"
"""Context of what a lesson says once it is open."""
CONTEXT = "\x04"
"""Stands between context and text, as in GNU gettext."""


class Language:
    """Says texts in a language.

    Attributes
    ----------
    name
        Its code, as in addresses.
    texts
        What is said in place of an English text.
    """

    def __init__(self, name: str, texts: Mapping[str, str]) -> None:
        self.name, self.texts = name, texts

    def __call__(self, text: str, context: str = "") -> str:
        """Say an English text; of one that was made of parts, template and parts.

        A title goes before its unit in brackets.
        """
        if not self.texts:
            return text
        found = self.texts.get(f"{context}{CONTEXT}{text}" if context else text)
        if found is not None:
            return found
        if isinstance(text, Phrase):
            return text.anew(self)
        title, bracket, unit = text.rpartition(" (")
        if bracket and unit.endswith(")") and title in self.texts:
            return f"{self.texts[title]}{bracket}{unit}"
        return text

    @cached_property
    def in_browser(self) -> str:
        """All that needs no context, as JSON that may stand in a program in HTML."""
        plain = {text: said for text, said in self.texts.items() if CONTEXT not in text}
        return json.dumps(plain).replace("<", "\\u003c")

    def spellings(self, term: str) -> list[str]:
        """Give how a term may be spelt, first as it is called by itself."""
        forms = self.texts.get(f"{FORMS}{CONTEXT}{term}", "").split(OR)
        return list(dict.fromkeys(one for one in (self(term), *forms) if one))


@cache
def language(name: str) -> Language:
    """Give a language that there is."""
    return Language(name, {} if name == SOURCE else translation(FOLDER / f"{name}.po"))


def translation(file: Path) -> dict[str, str]:
    """Read a file: English, and what it is called; with its context, if it has one, before it."""
    found, entry = {}, {"msgctxt": "", "msgid": "", "msgstr": ""}
    for key, text in (*_lines(file), ("msgctxt", "")):
        if key in ("msgctxt", "msgid") and entry["msgstr"]:
            before = entry["msgctxt"] + CONTEXT if entry["msgctxt"] else ""
            if entry["msgid"]:
                found[before + entry["msgid"]] = entry["msgstr"]
            entry = dict.fromkeys(entry, "")
        entry[key] += text
    return found


def _lines(file: Path) -> Iterator[tuple[str, str]]:
    """Give the texts of a file line by line, each with what it is part of."""
    key = ""
    for line in file.read_text(encoding="utf-8").splitlines():
        word, _, quoted = line.strip().partition('"')
        if quoted and not word.startswith("#"):
            key = word.strip() or key
            yield key, ast.literal_eval(f'"{quoted}')


def preferred(header: str) -> str:
    """Choose a language by what a browser would rather have (`Accept-Language`)."""
    offers = []
    for offer in header.split(","):
        name, _, weight = offer.partition(";q=")
        try:
            offers.append((-float(weight or 1.0), name.strip().lower().partition("-")[0]))
        except ValueError:
            continue
    ordered = sorted(offers, key=lambda offer: offer[0])
    return next((name for _, name in ordered if name in LANGUAGES), SOURCE)
