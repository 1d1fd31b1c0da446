"""A translation is one file: of texts that there are, each with the same places for numbers."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from itertools import product
from pathlib import Path
from string import Formatter
from typing import Any

import param
import pytest
from lone_link import lone_session
from shown_pages import ALL, SMALL, Shown

from app.controls.items import items
from app.controls.refusals import refused
from app.controls.sidebar import Sidebar
from app.languages.language import CONTEXT, LANGUAGES, SOURCE, language, preferred
from app.lessons.lesson import LESSONS, content
from app.shell.address import query_of, sight_from_query
from app.views.catalogue import VIEWS
from solver.definitions import SettingError, about
from solver.phrases import Phrase, Sentence
from solver.scenes import CATALOGUE

ROOT = Path(__file__).resolve().parents[1]
TRANSLATIONS = [name for name in LANGUAGES if name != SOURCE]
TAUGHT = ("best-k", "broken-wire", "more-substructures")
"""Lessons that are there in every language."""
MARK = re.compile(r"\{[^}]*\}|</?\w+|\*")


def places(text: str) -> list[str]:
    """Give what a text has beside its words: places in the order of their numbers, and marks."""
    found = MARK.findall(text)
    if all(one in ("{}", "{0}", "{1}", "{2}", "{3}") for one in found if one.startswith("{")):
        free = iter(range(len(found)))
        found = [f"{{{next(free)}}}" if one == "{}" else one for one in found]
    return sorted(found)


@cache
def source() -> tuple[set[str], list[re.Pattern[str]], str]:
    """Give all texts of the source: whole ones, those made around values, and all programs."""
    whole, made = set[str](), list[re.Pattern[str]]()
    for file in (*ROOT.glob("app/**/*.py"), *ROOT.glob("solver/**/*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                whole.add(node.value)
            if isinstance(node, ast.JoinedStr):
                parts = [one.value if isinstance(one, ast.Constant) else "" for one in node.values]
                if sum(map(len, map(str, parts))) > 5:
                    made.append(re.compile(".+".join(re.escape(str(one)) for one in parts)))
    for entry in CATALOGUE.values():
        for definition in entry.settings.definitions().values():
            whole |= {about(definition).title, str(definition.doc)}
    for lesson in LESSONS.values():
        whole |= {lesson.title, lesson.question, lesson.why, lesson.drawn_quantity}
        whole |= {lesson.drawn_quantity.split(" to ")[0]}
        whole |= {*lesson.text, *lesson.explanation, *lesson.choices}
    whole |= {one.rpartition(" (")[0] for one in whole if one.endswith(")")}
    programs = "\n".join(one.read_text(encoding="utf-8") for one in ROOT.glob("app/**/*.js"))
    return whole, made, re.sub(r'"\s*\+\s*"', "", programs)


def is_in_the_source(text: str) -> bool:
    whole, made, programs = source()
    in_program = any(f"{mark}{text}{mark}" in programs for mark in '"`') or f"{text}:" in programs
    return text in whole or in_program or any(one.fullmatch(text) for one in made)


@pytest.mark.parametrize("name", TRANSLATIONS)
def test_what_is_translated_is_in_the_source_with_the_same_places(name: str) -> None:
    texts = language(name).texts
    assert len(texts) > 500
    gone = [key for key in texts if not is_in_the_source(key.rpartition(CONTEXT)[2])]
    assert gone == []
    plain = {key.rpartition(CONTEXT)[2]: said for key, said in texts.items()}
    assert [key for key, said in plain.items() if places(key) != places(said)] == []
    assert not is_in_the_source("Load pathes")


@pytest.mark.parametrize("name", TRANSLATIONS)
def test_every_text_of_a_translation_can_be_filled_in(name: str) -> None:
    for key, said in language(name).texts.items():
        fields = [one for _, one, _, _ in Formatter().parse(key) if one == ""]
        if fields:
            Phrase(said, *fields)


def test_a_phrase_is_said_anew_with_its_parts_in_their_order() -> None:
    german = language("de")
    texts = {"a {} of {}": "von {1} ein {0}", "steel": "Stahl", "Load": "Last", "wire": "Draht"}
    say = type(german)("de", texts)
    phrase = Sentence("a {} of {}", Phrase("{}", "wire"), "steel")
    assert phrase == "A wire of steel."
    assert say(phrase) == "Von Stahl ein Draht."
    assert say("Load (kN)") == "Last (kN)"
    assert say("nothing of it") == "nothing of it"
    assert language(SOURCE)(phrase) is phrase


@pytest.mark.parametrize(
    ("header", "name"),
    [
        ("", "en"),
        ("de-AT,de;q=0.9,en;q=0.8", "de"),
        ("en-US,en;q=0.9,de;q=0.8", "en"),
        ("it,fr-CH;q=0.7,de;q=0.6", "fr"),
        ("ja;q=x,;,", "en"),
    ],
)
def test_a_browser_is_answered_in_the_first_language_that_there_is(header: str, name: str) -> None:
    assert preferred(header) == name


def test_an_address_keeps_the_language_that_it_asked_for_and_refuses_others() -> None:
    settings = CATALOGUE["bar"].settings.checked({})
    sight, refused = sight_from_query("?lang=de")
    assert not refused
    assert "lang=de" in query_of(settings, sight)
    assert "lang" not in query_of(settings)
    assert "de, fr" in sight_from_query("?lang=xx")[1]


def shown(name: str, scene: str) -> dict[str, Any]:
    """Give what a worker paints of a scene in a language."""
    page = Shown(type(ALL)(**{**vars(ALL), "language": name}))
    page.run(1, scene, SMALL[scene])
    return page.page


@pytest.mark.parametrize("name", TRANSLATIONS)
@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_what_a_run_says_is_translated_whole(name: str, scene: str) -> None:
    """Words of the English picture that are still there are of numbers, units and symbols."""
    english, other = (words_in(shown(one, scene)) for one in (SOURCE, name))
    say = language(name)
    left = {one for one in english & other if say.texts.get(one, one) != one}
    assert left == set()
    status = shown(name, scene)["status"]["text"]
    assert language(name)("■ at rest") not in status
    assert "iterations" not in re.sub("itérations", "", status)


def words_in(models: dict[str, Any]) -> set[str]:
    """Give the texts of titles, words and axes."""
    texts = [str(one.get("text", one.get("axis_label", ""))) for one in models.values()]
    return {part.strip() for text in texts for part in re.split(r"<[^>]*>|\d", text)}


WRONG = ("abc", -1e99, 0.0, 200.0, 1e6, 4.5, [], [[1]], [[0, "a"]], [[0, 1], [0, 1]], [[0, -1.0]])


def said_of(scene: str) -> Iterator[str]:
    """Give the templates, and the parts of several words, of what a page refuses of a scene."""
    settings = CATALOGUE[scene].settings.checked({})
    # A switch on the page is on or off.
    kinds = settings.definitions().items()
    names = [name for name, kind in kinds if not isinstance(kind, param.Boolean)]
    for name, value in product(names, WRONG):
        try:
            settings.with_change(name, value)
        except SettingError as refusal:
            yield from leaves(refused(refusal, settings, name, value))


def leaves(text: Any) -> Iterator[str]:
    if isinstance(text, Phrase):
        yield from (text.template, *(leaf for part in text.parts for leaf in leaves(part)))
    elif isinstance(text, str):
        yield text


@pytest.mark.parametrize("name", TRANSLATIONS)
@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_what_a_control_refuses_is_said_in_the_pages_language(name: str, scene: str) -> None:
    titles = {about(one).title for one in CATALOGUE[scene].settings.definitions().values()}
    told = {one for one in said_of(scene) if re.search("[a-z]{2}.* .*[a-z]{2}", one)}
    assert told - titles - language(name).texts.keys() == set()


def test_a_refused_control_speaks_german_on_a_german_page() -> None:
    session = lone_session(CATALOGUE["bar"].settings.checked({}))
    session.watch(language="de")
    Sidebar(session, lambda name: None).hear("peak", 1e20, False, 1)
    found = "jede Zahl (dem Betrag nach höchstens 1·10¹⁵ N)"
    told = "Spitzenlast kann nicht 1·10²⁰ N sein: einen Wert in diesem Bereich wählen. Erlaubt: "
    assert session.say(session.refusal) == f"{told}{found}."


@pytest.mark.parametrize("name", TRANSLATIONS)
def test_three_lessons_are_translated_whole(name: str) -> None:
    say = language(name)
    for one in TAUGHT:
        lesson = LESSONS[one]
        told = content(lesson, 0, say)
        assert told["title"] != lesson.title
        assert told["why"] != lesson.why
        paragraphs = zip(content(lesson, 0)["explanation"], told["explanation"], strict=True)
        for english, other in paragraphs:
            kinds = [
                sorted(part[:2] for part in each if part[0] in ("control", "value"))
                for each in (english, other)
            ]
            assert kinds[0] == kinds[1]
            assert english != other


@pytest.mark.parametrize("name", TRANSLATIONS)
def test_what_stands_at_first_in_the_sidebar_and_above_plots_is_translated(name: str) -> None:
    say, missing = language(name), set[str]()
    for entry in CATALOGUE.values():
        first = [one for one in items(entry.settings) if not one.get("sheet") and "label" in one]
        named = {one["label"].rpartition(" (")[0] or one["label"] for one in first}
        missing |= {*named, *(one["help"] for one in first)} - say.texts.keys()
    missing |= {view.name for view in VIEWS} - say.texts.keys()
    assert missing == set()
