"""A structure taken apart: pieces fit, and forces balance, by iterations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from bokeh.events import Tap

from app.frame import LINEAR, Frame, Selection
from app.lessons.catalogue import LESSONS
from app.messages import Needs, Start
from app.state import PageState, default_settings
from app.views.pieces import PiecesView
from app.worker.piece_joints import MOST_JOINTS
from app.worker.pieces import Cutter, Pieces
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from app.worker.sampling import Sampler
from solver.discrete import Problem
from solver.latin import Iterate, iterations
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings

SMALL: dict[str, dict[str, object]] = {
    "bar": {},
    "strand": {"instants": 41},
    "rope": {"elements": 20, "instants": 9},
    "block": {"elements": 24, "instants": 41},
    "layers": {"elements": 24, "instants": 41},
    "wall": {"bricks": 4, "courses": 4, "instants": 21},
    "fault": {"elements": 24, "instants": 41},
    "incline": {"instants": 41},
    "arch": {"voussoirs": 12, "instants": 21},
    "bundle": {"rings": 1, "elements": 4, "instants": 21},
}
PLAIN = {
    "start": "zero",
    "finish": "none",
    "relaxation": 1.0,
    "acceleration": "none",
}
"""Settings of the search itself: relaxed and mixed iterates hold a part of the start,
which is not in balance."""


def settings_of(scene: str, **changes: object) -> Settings:
    return CATALOGUE[scene].checked(SMALL[scene] | changes)


def taken_apart(
    settings: Settings, last: int, name: str = ""
) -> Iterator[tuple[Iterate, Pieces]]:
    """The first iterates, and their pieces."""
    problem = discretise(settings)
    cutter = Cutter(problem, settings, np.arange(problem.n_instants))
    needs = Needs(interface=name or next(iter(problem.contacts)))
    for iterate in iterations(problem, method_of(settings)):
        yield iterate, cutter.pieces(iterate, needs)
        if iterate.number == last:
            return


def unbalanced(pieces: Pieces, stage: str) -> float:
    """Largest sum of the macro forces of both sides over the largest of them."""
    forces = pieces.stages[stage].forces
    sums = np.zeros((len(pieces.names), *forces.shape[1:]))
    np.add.at(sums, pieces.joints, forces)
    has_two = np.bincount(pieces.joints) == 2
    assert has_two.any()
    return float(np.abs(sums[has_two]).max() / np.abs(forces).max())


def courses(pieces: Pieces) -> int:
    """Number of courses that move by a tenth of the largest displacement or more."""
    moved = np.nan_to_num(np.abs(pieces.stages["linear"].moved[:, 0])).max(axis=1)
    corners = np.nan_to_num(pieces.corners[:, 1])
    moving = np.unique(pieces.parts[moved > 0.1 * moved.max()])
    return len({np.max(corners[pieces.parts == piece]) for piece in moving})


@pytest.mark.parametrize("scene", ["strand", "block", "layers", "wall", "fault"])
def test_with_a_coarse_problem_macro_forces_balance_from_the_first_iteration(
    scene: str,
) -> None:
    with_coarse = taken_apart(settings_of(scene, **PLAIN), last=2)
    assert all(unbalanced(pieces, "linear") < 1e-6 for _, pieces in with_coarse)
    without = taken_apart(settings_of(scene, **PLAIN, multiscale=False), last=2)
    assert all(unbalanced(pieces, "linear") > 0.01 for _, pieces in without)


def test_without_a_coarse_problem_news_walks_one_piece_an_iteration() -> None:
    settings = settings_of("bar", start="zero", finish="none", multiscale=False)
    for iterate, pieces in taken_apart(settings, last=9):
        names = np.array(pieces.names)[pieces.joints]
        forces = np.abs(pieces.stages["linear"].forces).max(axis=(1, 2, 3))
        reached = np.unique(pieces.joints[(names == "") & (forces > 0.0)])
        assert len(reached) == iterate.number


def test_a_wall_moves_course_by_course_or_with_a_coarse_problem_at_once() -> None:
    changes = {"bricks": 6, "courses": 6, "start": "zero", "finish": "none"}
    alone = dict[int, int]()
    for iterate, pieces in taken_apart(
        settings_of("wall", **changes, multiscale=False), last=8
    ):
        alone[iterate.number] = courses(pieces)
    assert (alone[1], alone[8]) == (1, 3)
    ((_, pieces),) = taken_apart(settings_of("wall", **changes), last=1)
    assert courses(pieces) > 4


@pytest.mark.parametrize("scene", list(SMALL))
def test_in_the_local_stage_both_sides_fit_and_their_forces_balance(scene: str) -> None:
    *_, (_, pieces) = taken_apart(settings_of(scene, start="zero"), last=3)
    assert unbalanced(pieces, "local") < 1e-6
    local = pieces.stages["local"]
    assert local.gap.max() <= 1e-6 * np.nanmax(np.abs(local.moved))


@pytest.mark.parametrize("scene", ["block", "layers", "wall", "incline", "arch"])
def test_in_the_linear_stage_each_piece_is_in_balance_and_in_the_local_stage_not(
    scene: str,
) -> None:
    settings = settings_of(scene, start="zero", finish="none", multiscale=False)
    *_, (iterate, pieces) = taken_apart(settings, last=3)
    problem = iterate.problem
    parts = problem.substructures
    free = [n for n, part in enumerate(parts) if not problem.is_held[part.rows].any()]
    assert len(free) > 1
    left = {
        stage: max(unbalance_of_piece(problem, pieces, stage, piece) for piece in free)
        for stage in ("local", "linear")
    }
    assert left["linear"] < 1e-4
    assert left["local"] > 0.01


def unbalance_of_piece(
    problem: Problem, pieces: Pieces, stage: str, piece: int
) -> float:
    """Resultant and moment of all forces on a piece, over its largest force."""
    # Pieces are drawn from the lower left corner of all on.
    corner = problem.inside.nodes.min(axis=0)
    is_own = pieces.owners == piece
    forces = [pieces.stages[stage].forces[is_own].reshape(-1, 2, problem.n_instants)]
    at = [pieces.quarters[is_own].reshape(-1, 2)]
    part = problem.substructures[piece]
    if part.body_force is not None:
        along = problem.inside.directions[part.dofs, :2]
        given = along[:, :, None] * part.body_force[:, None]
        forces.append(given * problem.scales.force)
        at.append(problem.positions[part.dofs] - corner)
    force = np.concatenate(forces)
    x, y = np.concatenate(at).T[:, :, None]
    moment = (x - x.mean()) * force[:, 1] - (y - y.mean()) * force[:, 0]
    size = max(np.ptp(x), np.ptp(y))
    sums = np.abs(force.sum(axis=0)).max(), np.abs(moment.sum(axis=0)).max() / size
    return float(max(sums) / np.abs(force).max())


@pytest.mark.parametrize("scene", ["block", "strand", "arch"])
def test_micro_forces_have_no_resultant_and_no_moment(scene: str) -> None:
    settings = settings_of(scene, start="zero", finish="none")
    *_, (_, pieces) = taken_apart(settings, last=2)
    micro = pieces.stages["linear"].micro
    assert np.abs(micro).max() > 0.0
    for side in np.unique(pieces.sides):
        points = pieces.points[pieces.sides == side]
        along = points[:, np.ptp(points, axis=0).argmax()].astype(float)
        along -= along.mean()
        values = micro[pieces.sides == side].reshape(len(along), -1)
        largest = np.abs(micro).max() * np.ptp(along)
        # The traction at nodes stands for their lengths.
        lengths = np.gradient(along) * np.where(
            np.isin(np.arange(len(along)), [0, len(along) - 1]), 0.5, 1.0
        )
        assert np.abs(lengths @ values).max() < 1e-5 * largest
        assert np.abs((along * lengths) @ values).max() < 1e-5 * largest * np.ptp(along)


def test_gaps_between_pieces_of_a_belt_are_lengths() -> None:
    """The angle between two beams, in rad, was called 0.29 mm, where 8 µm gaped."""
    settings = CATALOGUE["belt"].checked({"elements": 20, "instants": 9, **PLAIN})
    *_, (iterate, pieces) = taken_apart(settings, 3)
    problem = iterate.problem
    moved = iterate.boundary_displacement * problem.scales.displacement
    inside = problem.inside
    assert inside is not None
    largest = 0.0
    for cut in problem.cuts:
        is_length = inside.directions[problem.row_dofs[cut.first], 2] == 0.0
        jumps = np.abs(moved[cut.first] - moved[cut.second])
        assert jumps.max() > 5.0 * jumps[is_length].max()
        largest = max(largest, float(jumps[is_length].max()))
    assert pieces.stages[LINEAR].gap.max() == pytest.approx(largest, rel=1e-6)


def test_micro_forces_of_a_belt_that_is_wound_three_times_are_finite() -> None:
    settings = LESSONS["turns-on-a-bollard"].settings
    *_, (_, pieces) = taken_apart(settings, last=2)
    micro = pieces.stages["linear"].micro
    assert np.isfinite(micro).all()
    assert np.abs(micro).max() > 0.0


@pytest.mark.parametrize("scene", list(SMALL))
def test_pieces_of_a_solution_fit_and_stand_where_the_bodies_are_drawn(
    scene: str,
) -> None:
    settings = settings_of(scene, finish="at-once")
    # A run that follows a slider has its answer without a reference beside it.
    order = Start(1, settings, np.inf, is_dragged=True)
    runner = Runner(order, ReferenceCache(), lambda: False)
    while runner.status is None:
        runner.advance()
    frame = runner.frame(Needs(extras=frozenset({"pieces"})))
    pieces = frame.extras["pieces"]
    stage = pieces.stages["linear"]
    largest = np.nanmax(np.abs(stage.moved))
    assert stage.gap.max() < 1e-3 * largest
    assert np.nanmax(np.abs(stage.moved - stage.joined)) < 1e-3 * largest
    assert unbalanced(pieces, "linear") < 1e-3
    # A rope shows one wire, and is drawn round its axis.
    if scene == "rope":
        return
    nodes = frame.run.geometry.nodes
    away = np.abs(pieces.corners[:, None] - nodes).sum(axis=-1)
    is_corner = np.isfinite(pieces.corners[:, 0])
    nearest = away[is_corner].argmin(axis=1)
    is_there = away[is_corner].min(axis=1) < 1e-6 * nodes.max()
    assert is_there.sum() >= 4
    drawn = frame.deformed.nodes[nearest[is_there]][:, :, pieces.columns]
    own = stage.moved[is_corner][is_there]
    # Nodes of several pieces stand at one position.
    differences = np.abs(drawn - own).max(axis=(1, 2))
    assert np.median(differences) < 1e-3 * largest


def frame_of(settings: Settings, number: int, name: str = "") -> Frame:
    """Frame of an iterate, with its pieces."""
    problem = discretise(settings)
    sampler = Sampler(problem, settings, 1)
    needs = Needs(extras=frozenset({"pieces"}), interface=name)
    for iterate in iterations(problem, method_of(settings)):
        if iterate.number == number:
            return sampler.frame(iterate, [], None, needs)
    raise AssertionError


def test_a_rope_shows_the_selected_wire() -> None:
    settings = settings_of("rope")
    shown = []
    for name in ("wire 1.1", "wire 1.2"):
        pieces = frame_of(settings, 1, name).extras["pieces"]
        assert set(pieces.names) == {"", name}
        shown.append(set(pieces.substructures.tolist()))
    assert shown[0]
    assert not shown[0] & shown[1]


def test_a_large_wall_shows_the_forces_of_some_joints_and_says_so() -> None:
    settings = CATALOGUE["wall"].checked({"bricks": 16, "courses": 8})
    frame = frame_of(settings, 1)
    pieces = frame.extras["pieces"]
    assert len(pieces.names) == MOST_JOINTS
    view = PiecesView(PageState(settings))
    assert view.figure is not None
    view.update(frame, Selection(), None)
    count = MOST_JOINTS + pieces.left_out
    assert f"forces of {MOST_JOINTS} of {count} joints" in words(view)


def words(view: PiecesView) -> str:
    """Text of a view, in one line."""
    return view._told.text.replace("\n", " ")


def test_the_view_says_what_fits_keeps_its_scales_and_selects_by_a_tap() -> None:
    settings = settings_of("wall", start="zero", multiscale=False)
    state = PageState(settings)
    view = PiecesView(state)
    assert view.figure is not None
    view.update(frame_of(settings, 1), Selection(), None)
    assert "macro forces differ at" in words(view)
    scale = words(view)[words(view).index("Displacement") :]
    frame = frame_of(settings, 2)
    view.update(frame, Selection(), None)
    assert scale in words(view)
    # A joint between two bricks is tapped: both are told apart by its name.
    pieces = frame.extras["pieces"]
    joint = next(n for n, name in enumerate(pieces.names) if "and brick" in name)
    middles = view._placed.quarters.mean(axis=1)
    x, y = middles[pieces.joints == joint][0]
    view._tap(Tap(view.figure, x=float(x), y=float(y)))
    assert state.selection.interface == pieces.names[joint]
    assert len(view.sources["selected"].data["x"])


def sized(width: float, height: float, size: str) -> PiecesView:
    """The pieces of a bar in a figure of a size, px, with type of a size."""
    frame = frame_of(settings_of("bar"), 2)
    view = PiecesView(PageState(frame.run.settings))
    assert view.figure is not None
    view.magnify(size)
    view.lay_out(width, height)
    view.update(frame, Selection(), None)
    return view


@pytest.mark.parametrize("size", ["12px", "23px"])
def test_words_are_in_lines_no_longer_than_the_figure(size: str) -> None:
    view = sized(400.0, 260.0, size)
    lines = view._told.text.splitlines()
    assert lines[0].startswith("Linear stage")
    letter = 0.5 * float(size.removesuffix("px"))
    assert letter * max(map(len, lines)) < 400.0


def test_without_pieces_of_a_scene_there_are_no_words() -> None:
    view = sized(400.0, 260.0, "12px")
    frame, selection, ghost = view._shown  # type: ignore[misc]
    other = replace(frame.run, settings=default_settings("strand"))
    view.update(replace(frame, run=other, extras={}), selection, ghost)
    assert view._told.text == ""


def test_pieces_are_drawn_in_a_figure_that_is_small() -> None:
    view = sized(300.0, 60.0, "23px")
    heights = np.asarray(view.sources["pieces"].data["y"])
    assert 0.0 < np.nanmin(heights) < np.nanmax(heights) < 60.0


@pytest.mark.parametrize(("scene", "count"), [("bar", 10), ("strand", 0)])
def test_only_pieces_on_a_support_have_one_below_them(scene: str, count: int) -> None:
    frame = frame_of(settings_of(scene), 2)
    view = PiecesView(PageState(frame.run.settings))
    assert view.figure
    view.update(frame, Selection(), None)
    x, y = map(np.asarray, view.sources["supports"].data.values())
    is_edge = np.isfinite(y) & (y == np.max(y, initial=0.0, where=np.isfinite(y)))
    # Each is a line as long as its piece, with strokes that begin on it.
    pieces = view.sources["pieces"].data
    assert len(np.unique(np.round(x[is_edge]))) >= 2 * count
    if count:
        assert y[is_edge].max() < np.nanmin(np.asarray(pieces["y"]))
    else:
        assert len(x) == 0


def test_micro_forces_of_rods_stand_across_as_long_as_they_are() -> None:
    frame = frame_of(settings_of("strand", **PLAIN), 2)
    view = PiecesView(PageState(frame.run.settings))
    assert view.figure
    view.update(frame, Selection(), None)
    lengths = []
    for side in ("above", "below"):
        x, y = map(np.asarray, view.sources[f"micro {side}"].data.values())
        assert np.allclose(x[::3], x[1::3])
        lengths.append(np.abs(y[1::3] - y[::3]).max())
    assert min(lengths) > 3.0
    assert "micro forces drawn across" in words(view)
