"""A browser keeps runs under names and the plots of a scene; what it gives back may be anything."""

from __future__ import annotations

import pytest
from lone_link import lone_session

from app.session.session import Session
from app.session.undo import Undo
from app.shell.actions import LONGEST_NAME, Actions
from solver.scenes.bar import BarSettings
from solver.scenes.block import BlockSettings

SEEN = frozenset({"Scene", "Hysteresis loop"})


@pytest.fixture
def session() -> Session:
    return lone_session(BarSettings.checked({}))


def header(session: Session) -> Actions:
    undo = Undo(session, lambda name: None)
    return Actions(session, lambda: None, undo, lambda: None, lambda: None)


def test_a_run_that_was_kept_is_opened_again_or_goes_in_step_as_run_a(session: Session) -> None:
    actions = header(session)
    session.change("peak", 910.0)
    actions.hear("keep", "")
    name, scene, text, _ = actions.view.kept
    assert ("910" in name, scene) == (True, "bar")
    session.change("peak", 950.0)
    actions.hear("compare", text)
    assert session.twin is not None
    assert (session.twin.peak, session.wanted.peak) == (910.0, 950.0)
    actions.hear("open", ["run.toml", text])
    assert session.wanted.peak == 910.0
    actions.hear("keep", "a " * LONGEST_NAME)
    assert len(actions.view.kept[0]) <= LONGEST_NAME


@pytest.mark.parametrize("text", ["foo = [", "scene = 1", "", 'scene = "bar"\npeak = "x"'])
def test_what_is_no_run_is_refused_in_words_and_changes_nothing(
    session: Session, text: str
) -> None:
    actions, before = header(session), session.wanted
    actions.hear("compare", text)
    actions.hear("open", ["run.toml", text])
    assert session.wanted is before
    assert session.twin is None
    assert session.refusal


def test_plots_that_were_chosen_come_back_with_their_scene(session: Session) -> None:
    foolish = {
        "bar": [*sorted(SEEN), "Nonsense", 4, []],
        "block": ["Scene"],
        "zoo": 5,
        "strand": [3],
    }
    session.recall(foolish)
    assert session.chosen == SEEN
    session.choose_scene("block")
    assert session.chosen == {"Scene"}
    session.choose_scene("strand")
    assert session.chosen is None
    session.draw(["Scene", "Convergence"])
    assert session.keeps == ("strand", ["Convergence", "Scene"])


def test_plots_that_an_address_names_go_before_those_of_the_browser(session: Session) -> None:
    session.draw(["Convergence"], is_named=True)
    session.recall({"bar": sorted(SEEN)})
    assert session.chosen == {"Convergence"}
    assert session.keeps is None


def test_a_run_of_another_scene_does_not_go_in_step(session: Session) -> None:
    other = lone_session(BlockSettings.checked({}))
    kept = header(other)
    kept.hear("keep", "block")
    header(session).hear("compare", kept.view.kept[2])
    assert session.twin is None
