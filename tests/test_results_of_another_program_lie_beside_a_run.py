"""The worker draws results of another program, and tells how far the shown iterate is from them."""

from __future__ import annotations

import base64
import io
import re
from typing import Any

import numpy as np
import pytest
from lone_link import LoneLink
from shown_pages import ALL, SMALL, Shown, keys

from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from app.views.drawing.colors import VERMILION
from app.views.drawing.drawing import Drawing
from app.views.interface import friction, tractions
from app.views.load import loop
from app.wire.orders import Bring, Seek, Tabulate, Watch
from app.worker import saving
from solver.scenes import CATALOGUE
from solver.study.other_programs.brought import Brought

LATIN = {"method": "paper", "max_iterations": 12, "finish": "none"}
PLACES, TIMES = (one.ravel() for one in np.meshgrid([0.1, 0.2, 0.4, 0.6], [0.25, 0.5, 0.75]))


def brought(scene: str = "bar", quantity: str = "friction force", **fields: Any) -> Brought:
    length = CATALOGUE[scene].settings.checked({}).length
    given = {"x": PLACES * length, "t": TIMES, "values": 100.0 * np.ones(len(TIMES))} | fields
    return Brought(quantity, given["x"], given["t"], given["values"], "a<b.csv", scene, "")


def shown(scene: str = "bar", theirs: Brought | None = None, **options: Any) -> Shown:
    found = Shown()
    found.obey(Bring(theirs or brought(scene)))
    found.run(1, scene, SMALL[scene] | options)
    return found


def figures(page: Shown) -> str:
    found: str = page.page["figures"]["text"]
    return found


def dashed(drawing: Drawing | None) -> list[Any]:
    assert drawing is not None
    return [one for one in drawing.curves if one.color == VERMILION and one.dash == "dashed"]


def test_the_distance_is_that_of_the_iterate_that_is_shown() -> None:
    page = shown(**LATIN)
    said = []
    for iteration in (1, 12):
        page.obey(Seek(1, iteration))
        beside = page.scene().beside
        assert beside is not None
        said.append(100.0 * beside.of(page.frame().iterate))
        (written,) = re.findall(r"Friction force &lt;b&gt;([\d.e+]+) %", figures(page))
        assert float(written) == pytest.approx(said[-1], rel=0.05)
    assert said[0] != pytest.approx(said[1], rel=0.01)


def test_the_name_of_a_file_is_text_and_no_markup() -> None:
    page = shown()
    assert "&lt;i&gt;a&amp;lt;b.csv" in figures(page)


def test_it_is_drawn_at_the_instant_of_theirs_that_is_nearest() -> None:
    page = shown()
    for phase, time in ((0.3, 0.25), (0.4, 0.5), (1.0, 0.75)):
        look = ALL.__class__(views=ALL.views, phase=phase)
        page.obey(Watch(look))
        scene = page.scene(look, round(phase * 20))
        drawing = friction.draw(scene, None)
        assert f"a<b.csv, t = {time:g} s" in keys(drawing)
        (curve,) = dashed(drawing)
        np.testing.assert_array_equal(curve.x, [0.1, 0.2, 0.4, 0.6])


def test_an_axis_holds_all_of_theirs() -> None:
    far = brought(values=np.full(len(TIMES), 1e5))
    drawing = friction.draw(shown(theirs=far).scene(), None)
    assert drawing is not None
    assert drawing.y is not None
    assert drawing.y.high >= 1e5


def test_a_point_alone_is_seen_too() -> None:
    alone = brought(x=np.full(4, 0.5), t=np.linspace(0.0, 1.0, 4), values=np.ones(4))
    (curve,) = dashed(friction.draw(shown(theirs=alone).scene(), None))
    assert np.ptp(curve.x) > 0.0
    assert np.mean(curve.x) == pytest.approx(0.5)


def test_a_displacement_of_the_end_is_drawn_over_the_force_of_the_run() -> None:
    times = np.array([1.0, 0.0, 0.5, 0.25])
    end = brought(quantity="displacement", x=np.ones(4), t=times, values=1e-4 * times)
    page = shown(theirs=end)
    scene = page.scene()
    (curve,) = dashed(loop.draw(scene, None))
    np.testing.assert_allclose(curve.x, [0.0, 0.25e-4, 0.5e-4, 1e-4])
    stand = scene.run.stand
    assert stand.load is not None
    wanted = np.interp([0.0, 0.25, 0.5, 1.0], stand.all_instants, stand.load)
    np.testing.assert_allclose(curve.y, wanted, atol=1e-6)
    assert not dashed(friction.draw(scene, None))
    assert "Displacement" in figures(page)


def test_without_points_at_the_end_a_displacement_is_told_and_not_drawn() -> None:
    page = shown(theirs=brought(quantity="displacement"))
    assert not dashed(loop.draw(page.scene(), None))
    assert "12 of 12 rows" in figures(page)


def test_bodies_in_the_plane_have_it_with_their_tractions() -> None:
    page = shown("block")
    (curve,) = dashed(tractions.draw(page.scene(), None))
    assert np.size(curve.x) == 4
    assert "Distance to" in figures(page)


def test_it_is_of_the_interface_that_is_looked_at() -> None:
    page = shown("strand")
    found = []
    for name in ("contact 1-2", "contact 2-3"):
        look = ALL.__class__(views=ALL.views, interface=name)
        page.obey(Watch(look))
        beside = page.scene(look).beside
        assert beside is not None
        found.append((beside.interface, beside.of(page.frame().iterate)))
    assert [name for name, _ in found] == ["contact 1-2", "contact 2-3"]


def test_other_scenes_have_none_of_it_and_it_is_there_again_with_its_own() -> None:
    page = shown()
    page.run(2, "block", SMALL["block"])
    assert "Distance to" not in figures(page)
    page.run(3, "bar", SMALL["bar"] | {"friction": 0.2})
    assert "Distance to" in figures(page)
    page.obey(Bring(None))
    assert "Distance to" not in figures(page)
    assert not dashed(friction.draw(page.scene(), None))


def test_where_nothing_is_covered_any_more_it_says_so() -> None:
    page = shown(duration=0.2)
    assert "nothing to compare" in figures(page)
    assert "0 of 12 rows" in figures(page)


def test_a_page_that_is_taken_away_has_it() -> None:
    page = shown()
    page.obey(Tabulate("page", 1))
    assert "a&lt;b.csv" in page.files[-1][1] or "a<b.csv" in page.files[-1][1]


def test_a_process_that_is_new_is_given_it_before_its_run() -> None:
    link = LoneLink()
    settings = CATALOGUE["bar"].settings.checked({})
    session = Session(Pages(1), ReportExecutor(), settings, link.hire)
    theirs = session.brought = brought()
    session.start()
    kinds = [type(order).__name__ for order in link.orders]
    assert kinds.index("Bring") < kinds.index("Run")
    assert [order.brought for order in link.orders if isinstance(order, Bring)] == [theirs]
    session.start(settings.replace(friction=0.2))
    # It travels once to each process, however many runs there are.
    assert [type(order).__name__ for order in link.orders].count("Bring") == 1
    session.close()


def test_the_chosen_instant_is_saved_as_fclib_has_it() -> None:
    h5py = pytest.importorskip("h5py")
    page = shown("block")
    page.obey(Tabulate(saving.FCLIB, 7))
    name, text, number = page.files[-1]
    assert (name, number) == ("slipfront-block.hdf5", 7)
    with h5py.File(io.BytesIO(base64.b64decode(text))) as file:
        assert file["fclib_local/spacedim"][0] == 2
        time = page.recording.stand.instants[page.pictures[-1].facts.instant]
        title = file["fclib_local/info/title"][()].decode()
        assert title == f"Slipfront, block, t = {time:.6g} s"
        assert set(file["solution"]) == {"u", "r"}


@pytest.mark.parametrize("scene", ["bar", "incline"])
def test_what_fclib_does_not_have_is_said_and_the_run_goes_on(scene: str) -> None:
    page = shown(scene)
    page.obey(Tabulate(saving.FCLIB, 1))
    assert not page.files
    assert "FCLIB" in page.said[-1]
    page.obey(Watch(ALL.__class__(views=ALL.views, phase=0.5)))
    assert page.pictures[-1].facts.iteration > 0


def test_an_instant_with_too_many_points_is_left_to_the_command_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    page = shown("block")
    monkeypatch.setattr(saving, "has_reference", lambda settings: False)
    page.obey(Tabulate(saving.FCLIB, 1))
    assert "python -m solver fclib" in page.said[-1]
