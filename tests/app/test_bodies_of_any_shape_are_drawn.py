"""Bodies of any shape on the page: cells, bands, supports, thrust, loads, pieces."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
import shaped_bodies
from frames import arch, ran
from pictures import shown
from scipy.spatial import Delaunay
from small_scenes import SMALL

from app.frame import Extremes, Frame, Selection
from app.lessons.catalogue import CASES
from app.state import PageState, default_settings
from app.status import figures_line
from app.views.inside import Thrust
from app.views.scene import Scene
from app.views.supports import hatched
from app.worker.cells import BAND, MOST_CELLS, Drawing, drawings_of, joined
from solver.discrete import Bodies, Body, Held, Lattice, Mesh, discretise
from solver.scenes import CATALOGUE


def areas(cells: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Areas of cells, (n_cells,), by the shoelace formula."""
    x, y = np.moveaxis(positions[cells], -1, 0)
    after = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    return np.asarray(0.5 * np.sum(x * after[1] - after[0] * y, axis=1))


def disc(rings: int) -> Mesh:
    """Triangles in a disc of radius 1 with a hole of radius a half."""
    places = []
    for radius in np.linspace(0.5, 1.0, rings):
        angles = np.linspace(0.0, 2.0 * np.pi, 12 * rings, endpoint=False)
        angles = angles + radius
        places.append(radius * np.stack([np.cos(angles), np.sin(angles)], axis=1))
    corners = np.concatenate(places)
    triangles = Delaunay(corners).simplices
    middles = np.hypot(*corners[triangles].mean(axis=1).T)
    elements = triangles[middles > 0.5]
    x, y = np.moveaxis(corners[elements], -1, 0)
    cross = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0])
    cross -= (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
    elements[cross < 0.0] = elements[cross < 0.0][:, ::-1]
    return Mesh(corners, elements)


def held(mesh: Mesh, substructures: int) -> Bodies:
    """A body that is held at a few nodes."""
    body = Body("disc", mesh, 1e9, substructures=substructures)
    nodes = np.arange(3)
    instants = np.linspace(0.0, 1.0, 3)
    holds = [Held(f"held {n}", 0, nodes, n, 0.0 * instants) for n in (0, 1)]
    return Bodies([body], (), holds, (), instants, 1.0)


def drawings(structure: Bodies) -> list[Drawing]:
    inside = discretise(structure).inside
    assert inside is not None
    return drawings_of(structure, inside)


@pytest.mark.parametrize("substructures", [1, 3])
@pytest.mark.parametrize("rings", [4, 12])
def test_cells_cover_a_body_once_and_are_few(rings: int, substructures: int) -> None:
    mesh = disc(rings)
    drawn = joined(drawings(held(mesh, substructures)))
    covered = areas(drawn["cells"], drawn["nodes"].astype(float))
    assert len(covered) == pytest.approx(min(len(mesh.elements), MOST_CELLS), abs=2)
    assert covered.min() > 0.0
    # Neighbours share what is left of their border: no hole, and nothing twice.
    outlines = drawn["outlines"]
    rings = np.split(outlines, np.flatnonzero(outlines < 0))
    positions = drawn["nodes"].astype(float)
    enclosed = [float(areas(ring[ring >= 0][None], positions)[0]) for ring in rings]
    assert covered.sum() == pytest.approx(sum(enclosed), rel=1e-5)
    # Of a thinned outline the bows between two nodes are missing.
    assert covered.sum() == pytest.approx(mesh.volume, rel=0.02)


def test_a_lattice_beside_a_mesh_is_drawn_by_lines_of_its_grid() -> None:
    lattice = Lattice(60, 40, 0.1, 0.1)
    beside = replace(held(disc(4), 1).bodies[0], name="disc")
    body = Body("lattice", lattice, 1e9, substructures=2)
    nodes = np.arange(3)
    instants = np.linspace(0.0, 1.0, 3)
    holds = [
        Held(f"{part} {axis}", part, nodes, axis, 0.0 * instants)
        for part, axis in product((0, 1), repeat=2)
    ]
    drawn = drawings(Bodies([body, beside], (), holds, (), instants, 1.0))
    assert [each.part for each in drawn] == [0, 1, 2]
    of_lattice = [areas(each.cells, each.positions) for each in drawn[:2]]
    # Straight sides: nothing of the rectangle is cut off, and no cell is bent.
    assert np.sum(of_lattice[0]) + np.sum(of_lattice[1]) == pytest.approx(24.0)
    for each in drawn[:2]:
        corners = each.positions[each.cells]
        assert corners[:, 0, 1] == pytest.approx(corners[:, 1, 1])
        assert corners[:, 1, 0] == pytest.approx(corners[:, 2, 0])
        assert len(each.cells) < 60 * 40 / 2
    assert areas(drawn[2].cells, drawn[2].positions).min() > 0.0


def test_cells_of_thinned_elements_lie_where_these_are() -> None:
    mesh = disc(12)
    (drawing,) = drawings(held(mesh, 1))
    centres = mesh.centres
    for cell in range(0, len(drawing.cells), 37):
        corners = drawing.positions[drawing.cells[cell]]
        own = centres[drawing.cell_of_elements == cell]
        assert np.all(own > corners.min(axis=0) - 0.05)
        assert np.all(own < corners.max(axis=0) + 0.05)
    assert np.all(np.bincount(drawing.cell_of_elements) > 0)


def test_rims_run_along_the_outline_and_round_a_hole_but_not_along_cuts() -> None:
    drawn = joined(drawings(held(disc(4), 3)))
    ends = drawn["rims"].reshape(-1, 3)[:, :2]
    radii = np.hypot(*np.moveaxis(drawn["nodes"][ends].astype(float), -1, 0))
    on_rim = np.isclose(radii, 1.0) | np.isclose(radii, 0.5)
    assert on_rim.all()
    lengths = np.hypot(*np.diff(drawn["nodes"][ends].astype(float), axis=1)[:, 0].T)
    assert lengths.sum() == pytest.approx(3.0 * np.pi, rel=0.01)


def test_a_belt_is_a_band_that_lies_on_its_drum() -> None:
    structure = shaped_bodies.belt(np.pi, 0.3, 1.2)
    thickness = BAND * structure.box[1].max()
    (drawing,) = drawings(structure)
    count = len(drawing.positions) // 2
    inner = np.hypot(*drawing.positions[:count].T)
    outer = np.hypot(*drawing.positions[count:].T)
    on_drum = slice(3, count - 3)
    assert inner[on_drum] == pytest.approx(0.1, rel=1e-6)
    assert outer[on_drum] - inner[on_drum] == pytest.approx(thickness, rel=0.01)
    # Both nodes of the band move with one of the line.
    assert np.array_equal(drawing.numbers[:count], drawing.numbers[count:])


def test_the_line_of_thrust_lies_in_the_arch_and_carries_its_weight(
    spread: Frame,
) -> None:
    thrust = spread.extras["thrust"]
    points = thrust["lines"][:, 1, :, -1].astype(float)
    # Positions are from the lower left corner, of the structure from the centre.
    corner, _ = spread.run.settings.structure().box
    radii = np.hypot(*(points + corner).T)
    assert np.all((radii > 0.925 - 1e-6) & (radii < 1.075 + 1e-6))
    description = spread.run.geometry.description
    (weight,) = (a.values[-1] for a in description.acts if a.where == "body")
    at_ends = thrust["forces"][[0, -1], -1].astype(float)
    expected = np.hypot(spread.loop[1, -1], 0.5 * weight)
    assert at_ends == pytest.approx(np.full(2, expected), rel=1e-3)
    # From joint to joint: what ends one line begins the next.
    lines = thrust["lines"][..., -1]
    assert lines[:-1, 0] == pytest.approx(lines[1:, 2])


def test_hinges_are_marked_and_counted_as_the_quantity_counts_them(
    spread: Frame,
) -> None:
    hinges = spread.extras["thrust"]["hinges"]
    count = int(hinges[:, spread.run.column(0.5)].sum())
    assert count == spread.readings["hinges@0.5"]
    # At the crown and at both haunches.
    assert count == 3
    assert hinges[:, 0].sum() == 0.0
    view = shown(spread, 0.5, Thrust)
    marks = view.sources["hinges"].data
    assert len(marks["x"]) == count
    # A hinge is drawn at a corner of the stones that turn about it.
    picture = view.picture
    assert picture is not None
    nodes = picture.page(picture.nodes)
    for x, y in zip(marks["x"], marks["y"], strict=True):
        assert np.hypot(*(nodes - [x, y]).T).min() < 1.0
    notes = str([item.label for item in view._keys.items])
    assert f"hinges: {count}" in notes


def test_the_foot_of_an_abutment_is_hatched_and_moves_with_it(spread: Frame) -> None:
    kinds = [footing.kind for footing in spread.run.geometry.description.footings]
    assert kinds == ["clamp", "clamp"]
    view = shown(spread, 1.0)
    picture = view.picture
    assert picture is not None
    held_now = picture._holds()
    before = shown(spread, 0.0).picture._holds()  # type: ignore[union-attr]
    moved = np.nanmax(held_now[:, 0]) - np.nanmax(before[:, 0])
    assert moved == pytest.approx(1e-3 * picture.factor * picture.layout.scale[0])
    assert np.nanmin(held_now[:, 0]) == pytest.approx(np.nanmin(before[:, 0]))


def test_a_load_that_travels_is_one_arrow_and_is_dragged_where_it_is() -> None:
    frame = ran(arch(live=2000.0, displacement=0.0, thickness=0.2), ends=False)
    places = []
    for phase in (0.4, 0.6, 0.8):
        view = shown(frame, phase)
        picture = view.picture
        assert picture is not None
        (arrows,) = (each for each in picture.draggable if each.setting == "live")
        assert len(arrows.lines) == 1  # type: ignore[union-attr]
        places.append(float(arrows.base[0, 0]))  # type: ignore[union-attr]
    assert places[0] < places[1] < places[2]
    handle = picture.page(arrows.handle)
    base = picture.page(arrows.base[0])  # type: ignore[union-attr]
    half = 0.5 * (handle + base)
    view._hold(SimpleNamespace(x=handle[0], y=handle[1]))
    view._drag(SimpleNamespace(x=half[0], y=half[1]))
    view._let_go(SimpleNamespace(x=half[0], y=half[1]))
    assert view.state.settings.live == pytest.approx(1000.0, rel=0.02)


def test_an_arch_that_falls_shows_by_which_mechanism() -> None:
    frame = ran(arch(thickness=0.09))
    assert frame.run.mechanism is not None
    view = shown(frame, 1.0)
    ghost = np.stack([view.sources["ghost"].data[axis] for axis in "xy"], axis=1)
    bodies = np.stack([view.sources["bodies"].data[axis] for axis in "xy"], axis=1)
    away = np.hypot(*(ghost - bodies).T)
    assert np.nanmax(away) > 10.0
    # It goes on from where the abutment was moved to, which itself falls not.
    lines = frame.run.geometry.outlines
    moved = np.abs(frame.run.mechanism).max(axis=1)[lines]
    is_held = (lines >= 0) & (moved == 0.0)
    assert is_held.sum() > 4
    assert np.allclose(away[is_held], 0.0, atol=0.01)


def test_hatches_of_a_round_support_lie_behind_it() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 41)
    outward = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    strokes = hatched(100.0 * outward, -outward)
    radii = np.hypot(*strokes[np.isfinite(strokes[:, 0])].T)
    assert radii.max() < 100.0 + 1e-9
    assert radii.min() < 94.0


def test_an_end_that_is_moved_at_an_angle_has_one_arrow_along_its_way() -> None:
    changes = {"guide": "duct", "driven": "moved", "pull_load": "jack", "wrap": 60.0}
    settings = default_settings("belt").replace(**changes)
    frame = ran(settings, ends=False)
    (act,) = (act for act in frame.run.geometry.description.acts if act.unit == "m")
    assert act.symbol == "u"
    _, along = settings.structure().guide.outwards
    assert along[1] < -0.5
    assert np.asarray(act.towards) == pytest.approx(along)
    assert act.values[-1] == pytest.approx(frame.run.settings.displacement)


def test_a_figure_is_zero_where_an_iterate_leaves_next_to_nothing() -> None:
    frame = ran(
        default_settings("bundle").replace(rings=1, elements=4, instants=9), ends=False
    )
    loop = frame.loop.copy()
    loop[1, 0] = 1e-6 * np.abs(loop[1]).max()
    line = figures_line(replace(frame, loop=loop), Selection(0.0))
    assert re.search(r"Force on plate along x .*>0 k?N<", line), line


def test_a_plate_that_is_held_at_both_ends_has_rollers_at_each() -> None:
    frame = ran(
        default_settings("bundle").replace(rings=1, elements=4, instants=9), ends=False
    )
    description = frame.run.geometry.description
    rollers = [each for each in description.footings if each.kind == "rollers"]
    assert [np.ptp(each.points[:, 0]) for each in rollers] == pytest.approx([0, 0])
    sides = [each.outward.mean(axis=0).tolist() for each in rollers]
    assert sides == [pytest.approx([-1.0, 0.0]), pytest.approx([1.0, 0.0])]
    (act,) = (act for act in description.acts if act.symbol == "u")
    # It stands where a displacement to the right pulls.
    assert act.outward == pytest.approx((1.0, 0.0))


@pytest.mark.parametrize("name", ["tendon-draw-in", "heap-of-logs"])
def test_the_ground_of_a_case_is_all_that_supports_bodies_of_any_shape(
    name: str,
) -> None:
    case = CASES[name]
    frame = ran(case.settings.replace(instants=9), ends=False)
    view = Scene(PageState(frame.run.settings, case=name, frame=frame))
    _ = view.figure
    view.update(frame, Selection(1.0), None)
    picture = view.picture
    assert picture is not None
    # Bands lie on the contact alone, and not on an image of it, too.
    bands = picture._bands()
    drawn = np.concatenate([line for line, _, _ in bands[2:]])
    away = picture.points[:, None] - drawn[~np.isnan(drawn[:, 0])]
    assert np.hypot(*np.moveaxis(away, -1, 0)).min(axis=0).max() < 10.0
    ground = view.sources["ground"].data
    assert len(ground["xs"]) == 1
    _, y = picture.page(picture.nodes).T
    if case.surroundings is not None and case.surroundings.place == "around":
        assert min(ground["ys"][0]) < y.min() < y.max() < max(ground["ys"][0])
    hatches = picture._holds()
    clamps = [each for each in picture.description.footings if each.kind == "clamp"]
    assert bool(len(hatches)) == bool(clamps)


@pytest.mark.parametrize(
    "scene", ["arch", "belt", "block", "bundle", "fault", "incline", "mesh", "wall"]
)
def test_the_points_of_a_contact_move_with_their_body(scene: str) -> None:
    frame = ran(CATALOGUE[scene].checked(SMALL[scene]), ends=True)
    nodes = frame.run.geometry.nodes
    size = np.ptp(nodes, axis=0).max()
    largest = np.abs(frame.deformed.nodes).max()
    found = 0
    for place, moved in zip(
        frame.run.geometry.points, frame.deformed.points, strict=True
    ):
        is_there = np.hypot(*(nodes - place).T) < 1e-6 * size
        # Of the bodies that meet there it is on one, of which it may be no drawn node:
        # the other moves as it does but for slip and gap.
        aside = np.abs(frame.deformed.nodes[is_there] - moved).max(axis=(1, 2))
        assert np.min(aside, initial=np.inf) < 0.1 * largest or not is_there.any()
        found += is_there.any()
    assert found >= 2
    assert largest > 0.0


def test_a_side_that_is_held_is_not_moved_during_the_search() -> None:
    frame = ran(arch(displacement=0.0), ends=False)
    moved = frame.deformed.nodes
    rounding = 1e-8 * np.abs(moved).max() * np.ones_like(frame.loop[0])
    still = Extremes(float(rounding[0]), 0.0, float(rounding[-1]))
    frame = replace(
        frame,
        loop=np.stack([rounding, frame.loop[1]]),
        extremes=(still, frame.extremes[1]),
    )
    line = figures_line(frame, Selection(0.5))
    assert "Movement of the right abutment <b>0 " in line
