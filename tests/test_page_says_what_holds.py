"""The page says what holds: of its address, of a run, in numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any
from urllib.parse import quote, unquote

import pytest
from shown_pages import ALL, Shown

from app.controls.comparing import CHOICES, choice_of, pair
from app.picture.usual import changed, shown
from app.server.serve import is_phone
from app.shell.address import (
    Sight,
    query_of,
    settings_from_query,
    sight_from_query,
    twin_from_query,
)
from app.shell.page_link import waits_at
from app.wire.reports import Facts
from app.worker.words import number
from solver.definitions import SettingError
from solver.scenes import CATALOGUE

PHONE = "Mozilla/5.0 (Linux; Android 14; Pixel 8) AppleWebKit/537.36 Chrome/130.0 Mobile Safari"
DESK = "Mozilla/5.0 (X11; Linux x86_64) AppleWebKit/537.36 Chrome/130.0 Safari/537.36"


@pytest.mark.parametrize(
    ("query", "kept", "refused"),
    [
        (
            "?friction=-3&substructures=5",
            {"substructures": 5},
            ["Friction coefficient μ (friction) cannot be -3"],
        ),
        (
            "?friction=-3&peak=many&seed=2",
            {"seed": 2},
            ["(friction) cannot be -3", "(peak) cannot be “many”"],
        ),
        ("?frictoin=0.2&seed=2", {"seed": 2}, ["there is no setting frictoin"]),
        ("?elements=5&substructures=20&seed=2", {"substructures": 20, "seed": 2}, ["Elements is"]),
        ("?scene=strand&broken=6&wires=9", {"broken": 6, "wires": 9}, []),
        ("?scene=strand&broken=6&wires=9&grip=x", {"broken": 6, "wires": 9}, ["Grip cannot be"]),
        ("?scene=strand&broken=99&peak=500", {"peak": 500.0}, ["(broken) cannot be 99"]),
        ("?scene=cable&seed=2", {}, ["scene"]),
    ],
)
def test_what_is_valid_holds_and_all_that_is_not_is_named(
    query: str, kept: dict[str, Any], refused: list[str]
) -> None:
    settings, complaint = settings_from_query(query)
    assert {name: settings.values()[name] for name in kept} == kept
    assert set(changed(settings)) <= set(kept)
    assert bool(complaint) == bool(refused)
    assert all(part in complaint for part in refused)


@pytest.mark.parametrize(
    ("query", "sight", "refused"),
    [
        ("", Sight(), []),
        ("?instant=0.5&pace=5&tab=Study", Sight("Study", 0.5, "5"), []),
        ("?pace=fastest&pace=20", Sight(pace="20"), []),
        ("?pace=100", Sight(pace="fastest"), []),
        ("?iteration=7&theme=dark", Sight(iteration=7, theme="dark"), []),
        ("?iteration=1.5&theme=blue", Sight(), ["iteration = 1.5", 'theme = "blue"']),
        ("?tab=figures", Sight("Figures"), []),
        ("?view=present", Sight(view="present"), []),
        ("?view=cinema", Sight(), ['view = "cinema"']),
        ("?plots=Scene,Convergence", Sight(plots="Scene,Convergence"), []),
        ("?view=embed&plots=Sceen", Sight(view="embed"), ['plots = "Sceen"', "Stick and slip"]),
        ("?tab=STUDY&pace=Fastest", Sight("Study"), ['pace = "Fastest"']),
        ("?instant=2&pace=7&tab=studies", Sight(), ["instant = 2", 'pace = "7"', '"studies"']),
        ("?instant=nan&tab=Figures&seed=2", Sight("Figures"), ["instant"]),
    ],
)
def test_an_address_says_what_is_looked_at(query: str, sight: Sight, refused: list[str]) -> None:
    found, complaint = sight_from_query(query)
    assert found == sight
    assert bool(complaint) == bool(refused)
    assert all(part in complaint for part in refused)
    settings, other = settings_from_query(query)
    assert other == ""
    again = query_of(settings, found)
    assert sight_from_query(again) == (found, "")
    assert settings_from_query(again)[0].values() == settings.values()


@pytest.mark.parametrize(
    ("query", "finish", "said"),
    [
        ("?seed=2", "accuracy", ""),
        ("?finish=at+once", "at-once", "at-once"),
        ("?finish=status", "at-once", "at-once"),
        ("?finish=none", "none", "none"),
        ("?method=paper", "none", ""),
        ("?method=paper&finish=accuracy", "accuracy", "accuracy"),
    ],
)
def test_a_link_watches_unless_it_says_how_a_run_ends(query: str, finish: str, said: str) -> None:
    settings, _ = settings_from_query(query)
    assert settings.finish == finish
    assert ("finish" in query_of(settings)) == bool(said)


def test_another_method_brings_what_the_page_shows_of_it() -> None:
    watched, _ = settings_from_query("")
    only = shown(watched.replace(method="paper"), watched)
    again = shown(only.replace(method="fast"), only)
    assert (only.finish, again.finish) == ("none", "accuracy")


@pytest.mark.parametrize(
    ("changes", "text"),
    [({}, "{}"), ({"multiscale": False, "peak": 700.0}, '{"multiscale":false,"peak":700.0}')],
)
def test_an_address_says_what_run_a_has_other_than_run_b(
    changes: dict[str, Any], text: str
) -> None:
    settings, _ = settings_from_query("?seed=2&method=paper")
    query = query_of(settings, twin=settings.replace(**changes))
    assert unquote(query).endswith(f"compare={text}")
    twin, complaint = twin_from_query(query, settings_from_query(query)[0])
    assert twin is not None
    assert (twin.values(), complaint) == (settings.replace(**changes).values(), "")
    assert twin_from_query(query_of(settings), settings) == (None, "")


@pytest.mark.parametrize(
    "text", ["friction", "[1]", '{"friction":-3}', '{"frictoin":1}', "{" * 9999]
)
def test_a_run_a_that_is_refused_is_named_and_left_out(text: str) -> None:
    query = f"?compare={quote(text)}"
    settings, complaint = settings_from_query(query)
    twin, refused = twin_from_query(query, settings)
    assert (twin, complaint) == (None, "")
    assert "From the address: " in refused


@pytest.mark.parametrize(
    ("facts", "goes_on", "iteration"),
    [
        (None, True, 0),
        (Facts(iteration=9, done=9), True, 0),
        (Facts(iteration=4, done=9), True, 4),
        (Facts(iteration=9, done=9), False, 9),
        (Facts(iteration=9, done=9, is_over=True), False, 0),
        (Facts(iteration=4, done=9, is_over=True), False, 4),
        (Facts(is_broken=True), False, 0),
    ],
)
def test_a_link_has_the_iteration_that_waits_or_is_looked_at(
    facts: Facts | None, goes_on: bool, iteration: int
) -> None:
    assert waits_at(facts, goes_on=goes_on) == iteration


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_a_choice_of_two_runs_is_called_as_it_was_chosen(scene: str) -> None:
    settings = CATALOGUE[scene].settings.checked({})
    for choice in CHOICES.values():
        twin, own = pair(choice, settings)
        assert choice_of(twin, own) == choice
    one = settings.replace(substructures=1)
    if not one.applies("multiscale"):
        with pytest.raises(SettingError, match="cut the body"):
            pair("monoscale | multiscale", one)


def test_a_long_address_is_answered_in_few_words() -> None:
    query = "?" + "&".join(f"{'name' * 100}{number}=1" for number in range(2000))
    _, complaint = settings_from_query(query)
    assert "and 1997 more" in complaint
    assert len(complaint) < 400


def test_a_complaint_stands_in_the_status_line_as_text() -> None:
    shown = Shown(replace(ALL, complaint="From the address: <b> is refused."))
    shown.run(1, "bar", {})
    # Twice escaped: what stands there is HTML, and Panel's pane takes it escaped.
    assert "From the address: &amp;lt;b&amp;gt; is refused." in shown.words


def test_a_phone_is_known_by_what_it_asks_with() -> None:
    assert is_phone({"User-Agent": PHONE})
    assert is_phone({"User-Agent": DESK, "Sec-Ch-Ua-Mobile": "?1"})
    assert not is_phone({"User-Agent": DESK, "Sec-Ch-Ua-Mobile": "?0"})
    assert not is_phone({})


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (9.98e-11, "1·10⁻¹⁰"),
        (2.3e-4, "2.3·10⁻⁴"),
        (0.0164, "0.0164"),
        (4e6, "4·10⁶"),
        (0.0, "0"),
        (float("nan"), "–"),
    ],
)
def test_numbers_have_one_digit_before_the_point_of_a_power(value: float, text: str) -> None:
    assert number(value) == text
