"""Local stages obey their laws along E+; compliant laws tend to rigid ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contact_problems import friction_of, local_stage, rubbing_points

from solver.arrays import Array
from solver.laws import (
    Component,
    Contact,
    Dirichlet,
    Friction,
    FrictionLaw,
    Neumann,
    Perfect,
    SlipFactor,
)
from solver.laws.friction import compliance_of, is_intact
from solver.laws.play import play
from solver.refusal import RefusedError

ROWS = 16
TIMES = 20
PAIRS = 4
SEEDS = range(4)
ALL = slice(None)


def squares(law, displacement: Array, force: Array, k: Array) -> Array:
    return np.array(law.gaps(displacement, force, 1e-13, k))


# Linear laws


def given_law(kind, random: np.random.Generator):
    rows = random.permutation(ROWS)[:PAIRS]
    values = random.normal(size=(PAIRS, TIMES))
    if kind is Neumann:
        return Neumann(rows, values, np.ones((PAIRS, 1)))
    return Dirichlet(rows, values)


def glued(random: np.random.Generator) -> Perfect:
    rows = random.permutation(ROWS)[: 2 * PAIRS]
    return Perfect(rows[:PAIRS], rows[PAIRS:], np.ones((PAIRS, 1)))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", [Dirichlet, Neumann, Perfect])
def test_a_linear_law_holds_after_its_local_stage_only(kind, seed: int) -> None:
    random = np.random.default_rng(seed)
    if kind is Perfect:
        law = glued(random)
    else:
        law = given_law(kind, random)
    displacement, force = local_stage(law, random)
    if kind is Dirichlet:
        assert np.array_equal(displacement[law.rows], law.values)
    elif kind is Neumann:
        assert force[law.rows] == pytest.approx(law.values, abs=1e-13)
    else:
        assert np.array_equal(displacement[law.first], displacement[law.second])
        assert force[law.first] == pytest.approx(-force[law.second], abs=1e-13)
    others = np.setdiff1d(np.arange(ROWS), law.rows)
    assert not force[others].any()
    k = np.ones(ROWS)
    assert squares(law, displacement, force, k).sum() == 0.0
    if kind is not Neumann:
        assert squares(law, displacement + noise(random), force, k).sum() > 0.0
    if kind is not Dirichlet:
        assert squares(law, displacement, force + noise(random), k).sum() > 0.0


def noise(random: np.random.Generator) -> Array:
    return 1e-6 * random.normal(size=(ROWS, TIMES))


@pytest.mark.parametrize("kind", [Dirichlet, Neumann])
def test_a_law_restricted_to_instants_agrees_with_the_whole_law(kind) -> None:
    random = np.random.default_rng(0)
    law = given_law(kind, random)
    some = slice(5, 11)
    k = random.uniform(0.5, 2.0, ROWS)
    incoming = random.normal(size=(ROWS, TIMES))
    whole = incoming.copy()
    law.rule(k, TIMES)(incoming, whole, ALL)
    part = incoming[:, some].copy()
    short = law.during(some)
    short.rule(k, 6)(incoming[:, some], part, ALL)
    assert short.n_instants == 6
    assert np.array_equal(part, whole[:, some])


def test_a_side_that_is_very_stiff_prescribes_the_other_of_a_glued_cut() -> None:
    random = np.random.default_rng(1)
    law = glued(random)
    k = random.uniform(0.5, 2.0, ROWS)
    k[law.second] = 1e12
    incoming = random.normal(size=(ROWS, TIMES))
    moved = incoming.copy()
    law.rule(k, TIMES)(incoming, moved, ALL)
    assert moved[law.first] == pytest.approx(incoming[law.second], abs=1e-11)


def test_joined_cuts_act_as_separate_ones() -> None:
    random = np.random.default_rng(2)
    rows = random.permutation(ROWS).reshape(4, 4)
    laws = [Perfect(rows[n], rows[n + 1], np.ones((4, 1))) for n in (0, 2)]
    k = random.uniform(0.5, 2.0, ROWS)
    incoming = random.normal(size=(ROWS, TIMES))
    each = incoming.copy()
    for law in laws:
        law.rule(k, TIMES)(incoming, each, ALL)
    (together,) = Perfect.join(laws)
    moved = incoming.copy()
    together.rule(k, TIMES)(incoming, moved, ALL)
    assert np.array_equal(moved, each)


def test_macro_forces_of_a_load_are_its_resultants_and_those_of_a_cut_cancel() -> None:
    random = np.random.default_rng(3)
    load = given_law(Neumann, random)
    (part,) = load.macro_parts()
    assert part.load == pytest.approx(load.values.sum(axis=0)[None])
    cut = glued(random)
    (part,) = cut.macro_parts()
    opposite = np.zeros(ROWS)
    opposite[cut.first] = 1.0
    opposite[cut.second] = -1.0
    assert part.load is None
    assert not (np.asarray(part.basis).T @ opposite[part.rows]).any()


# Friction and contact

FALLING = SlipFactor((0.0, 0.5, 2.0), (1.0, 0.6, 0.4))
RISING = SlipFactor((0.0, 1.0, 5.0), (1.0, 1.2, 1.5))
ALONG = {
    "plain": {},
    "spring": {"compliance": np.full(PAIRS, 0.7)},
    "cap": {"cap": np.linspace(0.05, 0.3, PAIRS)},
    "falling": {"slip_factor": FALLING},
    "rising, spring": {"slip_factor": RISING, "compliance": np.full(PAIRS, 0.2)},
    "cap, spring": {"cap": np.full(PAIRS, 0.1), "compliance": np.full(PAIRS, 2.0)},
    "start": {"start": np.linspace(-1.0, 1.0, PAIRS)},
}


def contact_of(
    seed: int, *, opens: bool, two: bool, across: Array | None = None, **along
) -> tuple[np.random.Generator, Contact]:
    random, sliders, common = rubbing_points(seed, opens=opens, two=two)
    if common["normal"] is not None:
        common["normal"] = replace(common["normal"], compliance=across)
    return random, Contact(tangential=replace(sliders, **along), **common)


@pytest.mark.parametrize("along", ALONG)
@pytest.mark.parametrize("two", [False, True])
@pytest.mark.parametrize("opens", [False, True])
def test_a_local_stage_obeys_coulombs_law_and_action_is_reaction(
    along: str, two: bool, opens: bool
) -> None:
    soft = None
    if opens and along != "plain":
        soft = np.full(PAIRS, 0.3)
    random, law = contact_of(7, opens=opens, two=two, across=soft, **ALONG[along])
    displacement, force = local_stage(law, random)
    tangential = law.tangential
    friction = force[law.tangent.above]
    before = tangential.start
    if before is None:
        before = np.zeros(PAIRS)
    slider = tangential.slider(displacement, force)
    slip = np.diff(slider, axis=1, prepend=before[:, None])
    pressing = None
    if law.normal is not None:
        pressing = force[law.normal.component.above]
        opening = law.normal.opening(displacement, force)
        assert pressing.min() >= -1e-12
        assert opening.min() >= -1e-12
        assert np.abs(pressing * opening).max() <= 1e-12
        assert (pressing > 0.1).any()
        assert (opening > 0.1).any()
    bound = tangential.bound_after_slip(pressing, slip)
    assert np.all(np.abs(friction) <= bound + 1e-12)
    if tangential.cap is not None:
        assert np.all(np.abs(friction) <= tangential.cap[:, None] + 1e-12)
    # What slips carries its bound, against the slip.
    assert bound * np.abs(slip) + friction * slip == pytest.approx(
        np.zeros((PAIRS, TIMES)), abs=1e-11
    )
    assert (np.abs(slip) > 1e-3).any()
    for component in law.components:
        if component.below is not None:
            assert force[component.above] == pytest.approx(
                -force[component.below], abs=1e-12
            )
    violation = law.violation(displacement, force, 1e-13)
    assert violation.energy(1.0, 1.0).max() <= 1e-11
    if two:
        assert squares(law, displacement, force, np.ones(ROWS)).sum() <= 1e-20


@pytest.mark.parametrize("two", [False, True])
@pytest.mark.parametrize("opens", [False, True])
def test_fields_off_the_local_stage_violate_the_law(two: bool, opens: bool) -> None:
    random, law = contact_of(3, opens=opens, two=two)
    displacement, force = local_stage(law, random)
    against = force.copy()
    against[law.tangent.above] *= -1.0
    assert law.violation(displacement, against, 0.0).energy(1.0, 1.0).max() > 0.01
    weaker = force.copy()
    weaker[law.tangent.above] *= 0.5
    assert law.violation(displacement, weaker, 0.0).energy(1.0, 1.0).max() > 0.01
    still = law.violation(np.zeros_like(displacement), 3.0 * force, 0.0)
    assert not still.slip.any()
    if law.normal is None:
        excess = np.maximum(np.abs(still.friction) - still.bound, 0.0)
        assert still.energy(2.0, 1.0) == pytest.approx(2.0 * excess)
        assert excess.max() > 0.01
    if law.normal is not None:
        pulled = force.copy()
        pulled[law.normal.component.above] -= 0.5
        found = law.violation(displacement, pulled, 0.0).energy(1.0, 1.0)
        assert found.max() > 0.01


@pytest.mark.parametrize("opens", [False, True])
def test_springs_in_series_that_stiffen_come_to_coulombs_law(opens: bool) -> None:
    apart = []
    random, rigid = contact_of(5, opens=opens, two=True)
    wanted = local_stage(rigid, random)[0]
    for soft in (1e-2, 1e-4, 1e-6):
        none = np.full(PAIRS, soft)
        random, law = contact_of(5, opens=opens, two=True, across=none, compliance=none)
        apart.append(np.abs(local_stage(law, random)[0] - wanted).max())
    # Of first order: a hundredth of the compliance, a hundredth of the difference.
    assert apart[0] > 1e-4
    assert np.array(apart[1:]) / np.array(apart[:-1]) == pytest.approx(
        np.full(2, 1e-2), rel=0.2
    )


def test_known_friction_along_stiff_springs_is_the_play_operator() -> None:
    random, law = contact_of(11, opens=False, two=False)
    k = random.uniform(0.5, 2.0, ROWS)
    incoming = np.cumsum(random.normal(size=(ROWS, TIMES)), axis=1)
    moved = incoming.copy()
    law.rule(k, TIMES)(incoming, moved, ALL)
    above = law.tangent.above
    slack = law.tangential.bound[:, 0] / k[above]
    assert moved[above] == pytest.approx(play(incoming[above], slack), abs=1e-13)


def test_a_law_started_at_half_time_continues_the_whole() -> None:
    random, law = contact_of(13, opens=True, two=True)
    k = random.uniform(0.5, 2.0, ROWS)
    incoming = random.normal(size=(ROWS, TIMES))
    whole = incoming.copy()
    law.rule(k, TIMES)(incoming, whole, ALL)
    first = whole[:, :9]
    force = k[:, None] * (first - incoming[:, :9])
    begun = law.with_start(law.tangential.slider(first, force)[:, -1])
    rest = incoming[:, 9:].copy()
    begun.rule(k, TIMES - 9)(incoming[:, 9:], rest, ALL)
    assert rest == pytest.approx(whole[:, 9:], abs=1e-14)
    assert begun.is_moved
    with pytest.raises(RefusedError):
        contact_of(13, opens=True, two=True, slip_factor=FALLING)[1].with_start(
            np.zeros(PAIRS)
        )


def test_a_bond_that_opens_once_has_friction_of_pressure_alone_from_then_on() -> None:
    bound = np.full((PAIRS, 1), 0.5)
    random, law = contact_of(17, opens=True, two=True, bound=bound)
    normal = law.normal
    assert normal is not None
    k = np.ones(ROWS)
    incoming = random.normal(size=(ROWS, TIMES))
    # Pressed at first.
    incoming[normal.component.above, :8] = -5.0
    displacement = incoming.copy()
    law.rule(k, TIMES)(incoming, displacement, ALL)
    force = displacement - incoming
    pressing = force[normal.component.above]
    opening = normal.opening(displacement, force)
    intact = is_intact(opening, pressing)
    assert set(np.unique(intact)) == {0.0, 1.0}
    assert np.all(np.diff(intact, axis=1) <= 0.0)
    friction = np.abs(force[law.tangent.above])
    most = intact * 0.5 + 0.4 * np.maximum(pressing, 0.0)
    assert np.all(friction <= most + 1e-12)
    slips = np.abs(np.diff(law.tangent.jump(displacement), axis=1)) > 1e-9
    assert friction[:, 1:][slips] == pytest.approx(most[:, 1:][slips], abs=1e-12)
    assert (slips & (intact[:, 1:] == 1.0)).any()


@pytest.mark.parametrize(
    "law",
    [
        FrictionLaw(),
        FrictionLaw(stiffness=3.0),
        FrictionLaw(slip_factor=FALLING),
        FrictionLaw(stiffness=2.0, cohesion=0.1, cap=0.3, slip_factor=RISING),
    ],
)
def test_a_body_on_its_image_rubs_as_one_of_two_that_move_the_opposite_way(
    law: FrictionLaw,
) -> None:
    random = np.random.default_rng(19)
    weights = random.uniform(0.5, 1.0, PAIRS)
    known = random.uniform(0.1, 0.4, PAIRS)
    k = np.tile(random.uniform(0.5, 2.0, PAIRS), 2)
    motion = np.cumsum(random.normal(size=(PAIRS, TIMES)), axis=1)
    above = np.arange(PAIRS)

    def moved(law: FrictionLaw, below: Array | None) -> Array:
        component = Component(above, below)
        along = law.at(component, weights, (1.0, 1.0), known=known)
        contact = Contact(
            tangential=along, points=above, positions=1.0 * above, weights=weights
        )
        incoming = np.concatenate([motion, -motion])
        result = incoming.copy()
        contact.rule(k, TIMES)(incoming, result, ALL)
        return result[:PAIRS]

    both = moved(law, above + PAIRS)
    assert moved(law.of_one_side(), None) == pytest.approx(both, abs=1e-12)
    assert np.abs(both - motion).max() > 0.05


def test_friction_of_a_law_has_no_units_but_those_of_its_scales() -> None:
    law = FrictionLaw(stiffness=2e9, cohesion=3e3, cap=4e3, slip_factor=FALLING)
    weights = np.array([0.1, 0.2, 0.3, 0.4])
    length = 1e-3
    force = 1e2
    along = law.at(
        Component(np.arange(4)), weights, (length, force), friction=np.full(4, 0.3)
    )
    pressing = np.full((4, 2), 5e2)
    slip = np.array([[0.0, 1e-3]]).repeat(4, axis=0)
    found = along.bound_after_slip(pressing / force, slip / length) * force
    before = np.minimum(3e3 * weights[:, None] + 0.3 * pressing, 4e3 * weights[:, None])
    assert found == pytest.approx(before * FALLING(np.cumsum(slip, axis=1)))
    assert law.bound_before_slip(0.3 * 5e2, weights[0]) == pytest.approx(before[0, 0])
    spring = compliance_of(law.stiffness, weights, (length, force))
    assert spring is not None
    assert spring * length / force == pytest.approx(1.0 / (2e9 * weights))
    assert compliance_of(np.inf, weights, (length, force)) is None


def test_friction_of_a_kind_is_a_value_that_begins_as_it_was_made() -> None:
    along = friction_of(Component(np.arange(2)), bound=0.5)
    assert isinstance(along, Friction)
    assert along.during(slice(1, 2)) is along
    changing = replace(along, bound=np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]))
    assert np.array_equal(changing.during(slice(1, 3)).bound, changing.bound[:, 1:])
    falls = replace(changing, slip_factor=FALLING)
    assert falls.softens
    assert not changing.softens
    assert falls.steepest_fall == pytest.approx([0.3 * 0.8, 0.6 * 0.8])
    assert replace(changing, slip_factor=RISING).largest_bound == pytest.approx(
        1.5 * changing.bound
    )


@pytest.mark.parametrize("opens", [False, True])
def test_concatenated_interfaces_act_as_separate_ones(opens: bool) -> None:
    _, first = contact_of(23, opens=opens, two=False)
    _, second = contact_of(29, opens=opens, two=False)
    random = np.random.default_rng(31)
    rows = random.permutation(ROWS).reshape(4, 4)
    laws = []
    for number, law in enumerate((first, second)):
        along = Component(rows[2 * number])
        law = replace(law, tangential=replace(law.tangential, component=along))
        if law.normal is not None:
            across = Component(rows[2 * number + 1])
            law = replace(law, normal=replace(law.normal, component=across))
        laws.append(law)
    assert laws[0].kind == laws[1].kind
    k = random.uniform(0.5, 2.0, ROWS)
    incoming = random.normal(size=(ROWS, TIMES))
    each = incoming.copy()
    for law in laws:
        law.rule(k, TIMES)(incoming, each, ALL)
    both = Contact.concatenated(laws)
    moved = incoming.copy()
    both.rule(k, TIMES)(incoming, moved, ALL)
    assert np.array_equal(moved, each)
    assert len(both.positions) == 2 * PAIRS
    assert len(set(both.points.tolist())) == 2 * PAIRS
