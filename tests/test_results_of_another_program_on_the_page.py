"""Results of another program lie beside the run in a browser, and go when one wants it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pages import Visit, card, choose_scene, one_page, open_sheets, press, status
from playwright.sync_api import Locator, Page, expect

from solver.reference.choice import reference_of
from solver.scenes import CATALOGUE, discretise

SIZE = {"elements": 20, "instants": 13, "substructures": 4}
QUERY = "&".join(f"{name}={value}" for name, value in SIZE.items())
page = one_page(f"?{QUERY}&plots=Friction+force,Hysteresis+loop", "certified")
FIELD = "Results of another program"


def field(page: Page) -> Locator:
    return page.get_by_label(FIELD)


def far(page: Page) -> Locator:
    return page.locator(".thing", has_text="Distance to")


@pytest.fixture(scope="module")
def theirs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Give our own friction times 1.25, as another program with another mesh would have it."""
    settings = CATALOGUE["bar"].settings.checked(SIZE)
    problem = discretise(settings)
    found = reference_of(problem)
    law = problem.friction
    x, t = np.linspace(0.1, 1.0, 37), problem.instants[1:]
    force = found.contact_force / law.by_point(law.weights)[:, None]
    tables = {
        "friction force": [np.interp(x, law.positions, one) for one in 1.25 * force.T[1:]],
        "displacement": [np.interp(x, problem.positions, one) for one in found.displacement.T[1:]],
    }
    folder = tmp_path_factory.mktemp("theirs")
    for name, lines in tables.items():
        rows = [
            f"{time},{place},{value}"
            for time, line in zip(t, lines, strict=True)
            for place, value in zip(x, line, strict=True)
        ]
        (folder / f"{name}.csv").write_text("\n".join([f"t,x,{name}", *rows]))
    return {name: folder / f"{name}.csv" for name in tables}


def test_friction_is_drawn_and_its_distance_is_told_until_it_is_removed(
    page: Page, theirs: dict[str, Path]
) -> None:
    open_sheets(page)
    field(page).set_input_files(theirs["friction force"])
    expect(far(page)).to_contain_text("Friction force 20 %")
    expect(far(page)).to_contain_text("444 of 444 rows")
    expect(card(page, "Friction force")).to_contain_text("friction force.csv, t = 0.75 s")
    press(page, "Remove")
    expect(far(page)).to_have_count(0)
    expect(card(page, "Friction force")).not_to_contain_text(".csv")


def test_a_file_may_be_dropped(page: Page, theirs: dict[str, Path]) -> None:
    open_sheets(page)
    page.locator(".setting-brought").get_by_text(FIELD).first.evaluate(
        """(place, text) => {
          const dataTransfer = new DataTransfer()
          dataTransfer.items.add(new File([text], "dropped.csv"))
          const more = {dataTransfer, bubbles: true, cancelable: true}
          place.dispatchEvent(new DragEvent("drop", more))
        }""",
        theirs["friction force"].read_text(),
    )
    expect(far(page)).to_contain_text("dropped.csv")
    press(page, "Remove")
    expect(far(page)).to_have_count(0)


def test_a_displacement_is_drawn_at_the_loaded_end(page: Page, theirs: dict[str, Path]) -> None:
    open_sheets(page)
    field(page).set_input_files(theirs["displacement"])
    expect(far(page)).to_contain_text("Displacement")
    expect(card(page, "Hysteresis loop")).to_contain_text("displacement.csv")
    press(page, "Remove")
    expect(card(page, "Hysteresis loop")).not_to_contain_text(".csv")


def test_what_is_refused_says_why_and_leaves_all_as_it_was(
    page: Page, theirs: dict[str, Path], tmp_path: Path
) -> None:
    open_sheets(page)
    field(page).set_input_files(theirs["friction force"])
    expect(far(page)).to_contain_text("20 %")
    wrong = tmp_path / "wrong.csv"
    wrong.write_text("x,t,friction force [N]\n0.1,0.1,1\n")
    field(page).set_input_files(wrong)
    expect(page.get_by_role("alert").first).to_contain_text(
        "give it in N/m, kN/m, N/mm; divide nodal forces"
    )
    expect(far(page)).to_contain_text("friction force.csv")
    assert "elements=20" in page.url
    press(page, "Remove")
    expect(far(page)).to_have_count(0)


def test_it_stays_with_its_scene_and_follows_what_is_set(
    open_page: Visit, theirs: dict[str, Path]
) -> None:
    page = open_page(f"?{QUERY}&plots=Friction+force")
    expect(status(page)).to_contain_text("certified")
    open_sheets(page)
    field(page).set_input_files(theirs["friction force"])
    expect(far(page)).to_contain_text("20 %")
    choose_scene(page, CATALOGUE["block"].title)
    expect(page.locator(".thing").first).to_be_visible()
    expect(far(page)).to_have_count(0)
    choose_scene(page, CATALOGUE["bar"].title)
    expect(far(page)).to_contain_text("20 %")


def test_an_instant_is_saved_for_other_solvers(open_page: Visit) -> None:
    h5py = pytest.importorskip("h5py")
    page = open_page("?scene=block&elements=16&elements_up=6&instants=13&plots=Contact+tractions")
    expect(status(page)).to_contain_text("certified")
    press(page, "Take away")
    with page.expect_download() as download:
        press(page, "FCLIB")
    assert download.value.suggested_filename == "slipfront-block.hdf5"
    with h5py.File(download.value.path()) as file:
        assert file["fclib_local/vectors/mu"].shape == (17,)
        assert file["fclib_local/W/m"][0] == 34
