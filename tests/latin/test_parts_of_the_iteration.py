"""Mixtures, bases, indicators, starts and ends, by what they must not change."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import islice

import numpy as np
import pytest
from contact_problems import on_a_support, rubbing_strands
from small_scenes import SMALL

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin import (
    PGD,
    Answer,
    Checkpoint,
    Full,
    Iterate,
    Latin,
    Nested,
    Paper,
    iterations,
    solve,
)
from solver.latin.anderson import AndersonState
from solver.latin.end.certified import (
    answer_of_iterate,
    balance_of_rows,
    certified_answer,
    known_forces,
    row_forces,
)
from solver.latin.end.status_step import Certificate, states_of, status_step
from solver.latin.indicators import ratio, violation_of
from solver.latin.stages.blocks import Blocks
from solver.latin.stages.linear import LinearStage
from solver.latin.start import prolong
from solver.laws import OPEN
from solver.reference.contact import IncrementalContact
from solver.reference.incremental import reference_of
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise

SCENES = {
    "bar": {"elements": 20, "instants": 11, "substructures": 4, "body_force": 500.0},
    "strand": {"elements": 8, "instants": 9},
    "block": {"elements": 8, "elements_up": 4, "instants": 9},
}


@cache
def scene_problem(scene: str) -> Problem:
    return discretise(CATALOGUE[scene].checked(SCENES[scene]))


@cache
def certificate(scene: str) -> Certificate:
    of = scene_problem(scene)
    guess = next(iterations(of, Latin()))
    solver = IncrementalContact(of)
    _, found = status_step(solver, of, states_of(guess), 10_000)
    assert found is not None
    return found


def close(found: Array, wanted: Array, share: float = 1e-10) -> bool:
    return bool(np.abs(found - wanted).max() <= share * np.abs(wanted).max())


# Anderson's mixture


class Mixed:
    """A linear iteration on the state of one body, whose images are mixed."""

    def __init__(self, seed: int, motion: Array | None = None) -> None:
        of = on_a_support(np.random.default_rng(seed), 3, 0.3, instants=4)
        blocks = Blocks(of.n_rows, of.n_instants)
        k = np.random.default_rng(seed + 1).uniform(0.5, 2.0, of.n_rows)
        stage = LinearStage(of, k, Full(), blocks, multiscale=False)
        stage.restore(None)
        (self.group,) = stage.groups
        self.shape = self.group.state.shape
        self.state = AndersonState(of, stage, motion, blocks)

    @property
    def field(self) -> Array:
        return self.group.state.copy()

    def step(self, image: Array) -> Array:
        """State that an iteration leads to whose image is given, of the same shape."""
        self.state.start()
        self.group.state[:] = image
        self.state.mix()
        return self.field


@pytest.mark.parametrize("rates", [(0.9,), (0.9, 0.5), (0.95, 0.3, -0.6)])
def test_a_contraction_of_few_rates_ends_after_as_many_mixtures(
    rates: tuple[float, ...],
) -> None:
    random = np.random.default_rng(len(rates))
    mixed = Mixed(0)
    fixed = random.normal(size=mixed.shape)
    rate = random.choice(rates, size=mixed.shape)
    errors = []
    for _ in range(len(rates) + 1):
        image = fixed + rate * (mixed.field - fixed)
        errors.append(np.abs(mixed.step(image) - fixed).max())
    assert errors[-1] <= 1e-5 * np.abs(fixed).max()
    assert min(errors[:-1]) > 1e-2 * np.abs(fixed).max()


def test_a_fixed_point_is_not_left() -> None:
    mixed = Mixed(0)
    random = np.random.default_rng(3)
    fixed = random.normal(size=mixed.shape)
    rate = random.uniform(-0.9, 0.9, size=mixed.shape)
    for _ in range(3):
        mixed.step(fixed + rate * (mixed.field - fixed))
    mixed.group.state[:] = fixed
    assert np.array_equal(mixed.step(fixed), fixed)


def test_weights_of_a_mixture_add_up_to_one() -> None:
    """A shift of all states and images is a shift of the mixture."""
    random = np.random.default_rng(4)
    plain = Mixed(0)
    moved = Mixed(0)
    fixed = random.normal(size=plain.shape)
    more = 10.0 * random.normal(size=plain.shape)
    rate = random.uniform(0.2, 0.9, size=plain.shape)
    moved.group.state[:] = more
    for _ in range(6):
        image = fixed + rate * (plain.field - fixed)
        found = plain.step(image)
        again = moved.step(image + more)
        assert again - more == pytest.approx(found, abs=1e-9)
    assert np.abs(found - image).max() > 1e-3


def test_a_motion_that_the_local_stage_chooses_anew_has_no_weight() -> None:
    random = np.random.default_rng(5)
    motion = random.normal(size=6)
    plain = Mixed(0, motion)
    moved = Mixed(0, motion)
    fixed = random.normal(size=plain.shape)
    rate = random.uniform(0.2, 0.9, size=plain.shape)
    along = motion[plain.group.rows][:, :, None]
    k = plain.group.k[:, None, None]

    def across(field: Array) -> Array:
        shares = (k * along * field).sum(axis=0) / (k * along**2).sum(axis=0)
        return field - shares * along

    for _ in range(5):
        image = fixed + rate * (plain.field - fixed)
        found = plain.step(image)
        chosen = random.normal(size=(1, 1, plain.shape[2]))
        again = moved.step(image + chosen * along)
        assert across(again) == pytest.approx(across(found), abs=1e-9)


# Separated bases


def stages(of: Problem, pgd: PGD) -> tuple[LinearStage, LinearStage, Array]:
    """The linear stage in full and on bases, and their k, (n_rows,)."""
    k = np.random.default_rng(0).uniform(0.5, 2.0) * of.direction
    both = [
        LinearStage(of, k, form, Blocks(of.n_rows, of.n_instants), multiscale=True)
        for form in (Full(), pgd)
    ]
    return both[0], both[1], k


def strands() -> Problem:
    return rubbing_strands(np.random.default_rng(0), 3, 4, instants=20)


EXACT = PGD(modes=1000, tolerance=0.0, pairs=1000, sharing=0.0)


@pytest.mark.parametrize("make", [strands, lambda: scene_problem("bar")])
@pytest.mark.parametrize("relaxation", [0.5, 1.0])
def test_bases_of_full_rank_are_the_full_linear_stage(make, relaxation: float) -> None:
    of = make()
    full, separated, _ = stages(of, EXACT)
    random = np.random.default_rng(1)
    shape = of.n_rows, of.n_instants
    start = Checkpoint(0, 0.0, random.normal(size=shape))
    for stage in (full, separated):
        stage.restore(start)
    for _ in range(3):
        target = np.asfortranarray(random.normal(size=shape))
        for stage in (full, separated):
            stage.read(target)
            stage.advance(relaxation)
        assert close(separated.outgoing(), full.outgoing())
        assert close(separated.incoming(), full.incoming())


def test_from_nothing_modes_are_added_until_the_target_is_met() -> None:
    of = strands()
    full, separated, _ = stages(of, EXACT)
    random = np.random.default_rng(2)
    target = np.asfortranarray(random.normal(size=(of.n_rows, of.n_instants)))
    for stage in (full, separated):
        stage.restore(None)
        stage.read(target)
        stage.advance(1.0)
    assert all(shared.basis.n_modes > 1 for shared in separated.bases())
    assert close(separated.outgoing(), full.outgoing(), 1e-6)


@pytest.mark.parametrize("modes", [1, 2])
def test_bases_keep_no_more_modes_than_allowed_and_only_those_of_the_target(
    modes: int,
) -> None:
    of = strands()
    _, separated, k = stages(of, PGD(modes=modes, tolerance=0.0, pairs=4))
    random = np.random.default_rng(3)
    separated.restore(None)
    target = np.asfortranarray(random.normal(size=(of.n_rows, of.n_instants)))
    separated.read(target)
    separated.advance(1.0)
    for number, shared in enumerate(separated.bases()):
        rows = of.substructures[number].rows
        root = np.sqrt(k[rows])[:, None]
        values = np.linalg.svd(root * target[rows] * np.sqrt(of.time_weights))[1]
        missed = separated.outgoing()[rows] - target[rows]
        found = np.linalg.norm(root * missed * np.sqrt(of.time_weights))
        assert shared.basis.n_modes == modes
        # No basis of as many modes misses less.
        assert found >= np.linalg.norm(values[modes:]) * (1.0 - 1e-9)
        assert found <= np.linalg.norm(values)


# Indicators


def iterate_of(of: Problem, number: int = 3) -> Iterate:
    method = Latin(direction=Paper(1.0), acceleration=None)
    return next(islice(iterations(of, method), number - 1, None))


@pytest.mark.parametrize("scene", SCENES)
def test_the_indicator_is_the_distance_of_both_stages_in_displacements_and_forces(
    scene: str,
) -> None:
    iterate = iterate_of(scene_problem(scene))
    weights = iterate.problem.time_weights

    def squared(displacement: Array, force: Array) -> float:
        k = iterate.k[:, None]
        return float((k * displacement**2 + force**2 / k).sum(axis=0) @ weights)

    linear = iterate.boundary_displacement, iterate.boundary_force
    local = iterate.local_displacement, iterate.boundary_local_force
    apart = squared(linear[0] - local[0], linear[1] - local[1])
    wanted = 2.0 * apart / (squared(*linear) + squared(*local))
    assert iterate.indicator == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("scene", SCENES)
def test_the_indicator_has_no_scale_and_is_zero_where_the_stages_agree(
    scene: str,
) -> None:
    iterate = iterate_of(scene_problem(scene))
    names = "outgoing", "incoming", "local_displacement", "local_incoming"
    larger = replace(iterate, **{name: 1e3 * getattr(iterate, name) for name in names})
    assert larger.indicator == pytest.approx(iterate.indicator, rel=1e-12)
    stiffer = replace(iterate, k=7.0 * iterate.k)
    assert stiffer.indicator == pytest.approx(iterate.indicator, rel=1e-12)
    agreeing = replace(
        iterate,
        local_displacement=iterate.boundary_displacement,
        local_incoming=iterate.incoming,
    )
    assert agreeing.indicator <= 1e-30
    nothing = {name: np.zeros_like(iterate.outgoing) for name in names}
    assert replace(iterate, **nothing).indicator == 0.0


@pytest.mark.parametrize("scene", SCENES)
def test_a_certified_solution_violates_no_law_and_disturbed_ones_do(
    scene: str,
) -> None:
    iterate = certified_answer(
        scene_problem(scene), scene_problem(scene).direction, certificate(scene)
    )
    of = iterate.problem
    displacement = iterate.boundary_displacement
    force = iterate.boundary_force
    assert violation_of(of, displacement, force) <= 1e-6
    noise = np.random.default_rng(0).normal(size=force.shape) * np.abs(force).max()
    little = violation_of(of, displacement, force + 1e-4 * noise)
    more = violation_of(of, displacement, force + 1e-2 * noise)
    assert 1e-5 < little < more


@pytest.mark.parametrize("scene", SCENES)
def test_statuses_of_a_certified_solution_are_those_of_the_reference(
    scene: str,
) -> None:
    found = certificate(scene)
    of = scene_problem(scene)
    iterate = certified_answer(of, of.direction, found)
    status = iterate.status_above(0.0)
    wanted = found.solution.status
    assert len(np.unique(wanted)) > 1
    assert np.mean(status != wanted) <= 0.01


def test_slip_is_judged_without_the_motion_of_open_points() -> None:
    """A slip that stages differ by is one beside the largest of those that touch."""
    of = on_a_support(np.random.default_rng(0), 2, 0.3, instants=1, gap=0.0)
    moved = np.array([[100.0], [1.0], [0.5], [0.0]])
    force = np.array([[0.0], [0.0], [-0.3], [1.0]])
    linear = moved - np.array([[0.0], [0.0], [0.6], [0.0]])
    iterate = Iterate(
        number=1,
        seconds=0.0,
        problem=of,
        k=np.ones(4),
        outgoing=linear + force,
        incoming=linear - force,
        local_displacement=moved,
        local_incoming=moved - force,
    )
    assert iterate.status.tolist() == [[OPEN], [1]]
    assert iterate.status_above(10.0).tolist() == [[OPEN], [0]]


def test_a_ratio_of_nothing_to_nothing_is_zero_and_of_something_infinite() -> None:
    assert ratio(0.0, 0.0) == 0.0
    assert ratio(1.0, 0.0) == np.inf
    assert ratio(1.0, 4.0) == 0.25


# Ends


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
def test_a_certified_solution_is_a_fixed_point_of_the_method_for_every_k(
    scene: str, scale: float
) -> None:
    of = scene_problem(scene)
    iterate = certified_answer(of, scale * of.direction, certificate(scene))
    assert close(iterate.local_displacement, iterate.boundary_displacement, 1e-12)
    method = Latin(direction=Paper(scale), acceleration=None)
    after = next(iterations(of, method, iterate.checkpoint))
    assert np.array_equal(after.k, iterate.k)
    assert close(after.outgoing, iterate.outgoing, 1e-9)
    assert close(after.contact_force, certificate(scene).solution.contact_force, 1e-8)
    assert (iterate.number, after.number) == (1, 2)
    again = certified_answer(of, scale * of.direction, certificate(scene), after)
    assert again.number == 3
    assert np.array_equal(again.outgoing, iterate.outgoing)


@pytest.mark.parametrize("is_beside", [False, True])
def test_an_answer_goes_on_in_full_fields_and_counts_unless_it_stands_beside(
    is_beside: bool,
) -> None:
    of = scene_problem("block")
    last = next(islice(iterations(of, Latin(linear=PGD(modes=3))), 4, None))
    answer = certified_answer(
        of, last.k, certificate("block"), last, is_beside=is_beside
    )
    assert last.checkpoint.bases == last.bases == answer.bases != ()
    assert answer.checkpoint.bases == ()
    assert answer.iterations == last.iterations + (not is_beside)
    assert not isinstance(last, Answer)
    assert answer.boundary_force is answer.boundary_local_force


def test_an_iterate_that_is_a_solution_keeps_its_fields_as_the_answer() -> None:
    last = iterate_of(scene_problem("block"))
    answer = answer_of_iterate(last, 1e-12, is_beside=False)
    assert answer.number == last.number + 1
    assert answer.residual == 1e-12
    assert np.array_equal(answer.boundary_force, last.boundary_force)
    assert np.array_equal(answer.contact_force, last.contact_force)
    assert answer.indicator == last.indicator


def opposite_on_cuts(of: Problem) -> Iterator[np.ndarray]:
    """Yield the matrix that sums forces of both sides of a cut, (n_points, n_rows)."""
    for cut in of.cuts:
        opposite = np.zeros((len(cut.first), of.n_rows))
        points = np.arange(len(cut.first))
        opposite[points, cut.first] = 1.0
        opposite[points, cut.second] = 1.0
        yield opposite


@pytest.mark.parametrize("scene", SCENES)
def test_forces_of_rows_balance_bodies_and_cuts_and_are_the_smallest(
    scene: str,
) -> None:
    of = scene_problem(scene)
    solution = certificate(scene).solution
    deformation = solution.deformation / of.scales.displacement
    contact = solution.contact_force / of.scales.force
    force = row_forces(of, deformation, contact)
    known, is_known = known_forces(of, contact)
    assert np.array_equal(force[is_known], known[is_known])
    balance, needed = balance_of_rows(of, deformation)
    size = np.abs(force).max()
    assert close(balance @ force, needed, 1e-9)
    for cut in of.cuts:
        assert np.abs(force[cut.first] + force[cut.second]).max() <= 1e-9 * size
    system = np.vstack([balance.toarray(), *opposite_on_cuts(of)])
    right = np.zeros((len(system), of.n_instants))
    right[: len(needed)] = needed
    right -= system @ (known * is_known[:, None])
    least = np.linalg.lstsq(system[:, ~is_known], right, rcond=1e-12)[0]
    assert force[~is_known] == pytest.approx(least, abs=1e-8 * size)


# Starts


@pytest.mark.parametrize("scene", ["bar", "strand"])
def test_a_solution_prolonged_to_its_own_mesh_is_a_fixed_point(
    scene: str,
) -> None:
    of = scene_problem(scene)
    solution = reference_of(of)
    k = of.direction
    start = Checkpoint(0, 0.0, prolong(solution, of, k))
    method = Latin(direction=Paper(1.0), acceleration=None)
    first = next(iterations(of, method, start))
    assert close(first.contact_force, solution.contact_force, 1e-7)
    assert close(first.displacement, solution.displacement, 1e-7)


def test_fields_of_a_coarse_mesh_are_prolonged_exactly() -> None:
    """A bar without friction is stretched evenly: on any mesh the same."""
    values = {**SCENES["bar"], "friction": 0.0, "body_force": 0.0}
    fine = discretise(CATALOGUE["bar"].checked({**values, "elements": 40}))
    coarse = discretise(CATALOGUE["bar"].checked({**values, "substructures": 1}))
    k = fine.direction
    outgoing = prolong(reference_of(coarse), fine, k)
    wanted = prolong(reference_of(fine), fine, k)
    assert close(outgoing, wanted, 1e-9)


def test_a_nested_start_refuses_bodies_in_the_plane_and_other_structures() -> None:
    block = discretise(CATALOGUE["block"].checked(SMALL["block"]))
    method = Latin(start=Nested(lambda: [block]))
    with pytest.raises(RefusedError, match="bodies in the plane is refused"):
        solve(block, method, watch=False)
    bar = scene_problem("bar")
    with pytest.raises(RefusedError, match="other interfaces"):
        prolong(reference_of(bar), scene_problem("strand"), bar.direction)
    longer = CATALOGUE["bar"].checked({**SCENES["bar"], "instants": 5})
    with pytest.raises(RefusedError, match="other instants"):
        Nested(lambda: [bar]).of(discretise(longer))


def test_a_start_takes_the_first_mesh_and_none_where_there_is_no_time_or_mesh() -> None:
    of = scene_problem("bar")
    coarse = scene_problem("bar")
    found = Nested(lambda: [coarse]).of(of)
    assert found is not None
    assert found.problem is coarse
    assert Nested(lambda: []).of(of) is None
    assert Nested(lambda: [coarse]).of(of, seconds=-1.0) is None
