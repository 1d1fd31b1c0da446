"""The paper's figures as the page has them made, and shows them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from jobs import refuse, sleep
from processes import wait_for

from app import reports
from app.errand import Errand, Found
from app.reports import PaperFigures
from app.worker.bench import Bench
from app.worker.desk import Desk, files
from app.worker.studies import figures_of_the_paper


@pytest.fixture(scope="module")
def told() -> list[float]:
    """Give the shares that were told while `found` was made."""
    return []


@pytest.fixture(scope="module")
def seen() -> list[list[str]]:
    """Give the files that were there after each was written."""
    return []


@pytest.fixture(scope="module")
def found(
    tmp_path_factory: pytest.TempPathFactory, told: list[float], seen: list[list[str]]
) -> Found:
    folder = tmp_path_factory.mktemp("figures")

    class Spied(Desk):
        def tell(self, doing: str, share: float) -> None:
            told.append(share)

        def publish(self, write: object) -> None:
            super().publish(write)
            seen.append([file.name for file in files(folder)])

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.worker.studies.Desk", Spied)
        figures_of_the_paper(folder)
    return Found("any", {file.name: file.read_bytes() for file in files(folder)})


@pytest.fixture(autouse=True)
def computed(monkeypatch: pytest.MonkeyPatch) -> list[Found]:
    """Give what the server has computed: nothing yet."""
    nothing: list[Found] = []
    monkeypatch.setattr(reports, "COMPUTED", nothing)
    return nothing


@pytest.fixture
def errand() -> Iterator[Errand]:
    with Bench() as bench:
        made = Errand(bench)
        yield made
        made.cancel()


@pytest.fixture
def view(errand: Errand) -> PaperFigures:
    made = PaperFigures(errand, "")
    made.view.visible = True
    return made


def test_they_come_one_by_one_and_say_how_far_they_are(
    found: Found, told: list[float], seen: list[list[str]]
) -> None:
    names = [f"figure-{number}.png" for number in (3, 4, 5, 6, 7, 8)]
    assert seen == [[*names[: count + 1], "figures.html"] for count in range(len(names))]
    assert told == sorted(told)
    assert told[0] == 0.0


def test_the_page_of_the_command_is_shown_where_they_are_found_computed(
    view: PaperFigures, errand: Errand, computed: list[Found], found: Found
) -> None:
    computed.append(found)
    view.open()
    assert not errand.is_busy
    assert not view._start.visible
    assert view._card.visible
    assert view._sheet.object.encode() == found.files["figures.html"]
    assert [button.label for button in view._files] == list(found.files)


def test_a_failure_is_told_and_can_be_tried_again(
    view: PaperFigures, errand: Errand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reports, "figures_of_the_paper", refuse)
    view.open()
    assert not view._start.visible
    wait_for(lambda: errand.collect() and not errand.is_busy)
    view.refresh()
    assert "no such thing" in view._progress.object
    assert view._start.visible
    assert not view._start.disabled
    monkeypatch.setattr(reports, "figures_of_the_paper", sleep)
    view._on_start()
    assert errand.is_busy
    assert not view._start.visible


def test_it_can_be_cancelled_and_another_page_has_them_later(
    view: PaperFigures,
    errand: Errand,
    computed: list[Found],
    found: Found,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(reports, "figures_of_the_paper", sleep)
    view.open()
    wait_for(lambda: errand.collect() and errand.doing == "asleep")
    view.refresh()
    assert view._cancel.visible
    view._on_cancel()
    assert "Cancelled." in view._progress.object
    assert view._start.visible
    computed.append(found)
    view.open()
    assert view._sheet.object == found.html
    assert not view._start.visible
