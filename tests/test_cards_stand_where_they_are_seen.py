"""Views share cards, and the picture of the scene is as large as it deserves."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from lone_link import LoneLink

from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from app.shell.layout import layout
from app.views.catalogue import VIEWS, beside, drawn, fitting
from solver.scenes import CATALOGUE, kind_of
from solver.settings import Settings

USUAL = {name: entry.settings.checked({}) for name, entry in CATALOGUE.items()}


@pytest.fixture
def session() -> Iterator[Session]:
    with ReportExecutor() as executor:
        yield Session(Pages(1), executor, USUAL["bar"], LoneLink().hire)


def names(session: Session) -> list[str]:
    return [view.name for view in drawn(session.wanted, session.chosen)]


@pytest.mark.parametrize("settings", USUAL.values(), ids=USUAL)
def test_every_view_of_a_scene_stands_on_one_of_as_many_cards_as_the_window_holds(
    settings: Settings,
) -> None:
    cards = [tuple(beside(view, settings)) for view in drawn(settings, None)]
    # Below the band of a strand's picture there is a card more: its cross-section.
    assert len(cards) == (7 if kind_of(settings) == "helices" else 6)
    assert sorted(view.name for card in cards for view in card) == sorted(
        view.name for view in fitting(settings)
    )


@pytest.mark.parametrize("settings", USUAL.values(), ids=USUAL)
@pytest.mark.parametrize("count", range(1, 7))
def test_the_first_six_cards_have_places_of_their_own_in_the_window(
    settings: Settings, count: int
) -> None:
    found = layout(drawn(settings, None)[:count], settings)
    assert len(found.areas) == count
    if found.is_long:
        spans = [int(area.split()[-1]) for area in found.areas[1:]]
        assert sum(spans) % 6 == 0
        assert count == 1 or sum(spans) <= 12
    else:
        assert {*found.areas} == {*"".join(re.findall('"(.*?)"', found.template)).replace(" ", "")}
        assert len({*found.areas}) == count


def test_long_things_have_a_band_and_all_others_stand_beside_their_plots() -> None:
    long = {name for name, one in USUAL.items() if layout(drawn(one, None), one).is_long}
    assert long == {"bar", "strand", "layers", "rope"}


def test_without_the_picture_cards_fill_their_rows() -> None:
    for count in range(1, 9):
        spans = [int(one.split()[-1]) for one in layout(VIEWS[2 : count + 2], USUAL["bar"]).areas]
        assert sum(spans) == 6 * -(-count // 3)


def test_plots_that_are_chosen_stay_with_their_scene_and_a_lessons_do_not(session: Session) -> None:
    session.draw(["Scene", "Hysteresis loop"])
    session.choose_scene("block")
    assert "Load path" in names(session)
    session.choose_scene("bar")
    assert names(session) == ["Scene", "Hysteresis loop"]
    assert session.plots == "Scene,Hysteresis loop"


def test_what_says_nothing_of_a_run_leaves_its_place_to_the_first_on_its_card(
    session: Session,
) -> None:
    chosen = ["Scene", "PGD basis size"]
    assert [view.name for view in drawn(session.wanted, chosen)] == ["Scene", "Singular values"]
    with_bases = session.wanted.with_change("linear_stage", "pgd")
    assert [view.name for view in drawn(with_bases, chosen)] == chosen
