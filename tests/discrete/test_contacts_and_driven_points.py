"""Contacts put together show what each shows; driven points obey their law."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from contact_problems import block, friction_of

from solver.arrays import Array
from solver.discrete import discretise
from solver.discrete.contact_groups import NO_SLIP, ContactGroup
from solver.discrete.contacts import Contacts
from solver.discrete.driven_friction import DrivenFriction, driven_friction
from solver.discrete.drives import Drive, describe_limit, describe_loads
from solver.laws import OPEN, Component, Contact, SlipFactor, Unilateral
from solver.laws.play import play

# Contacts


def interface(first: int, sizes: int, *, opens: bool, start: float = 0.0) -> Contact:
    rows = first + np.arange(2 * sizes)
    along = friction_of(Component(rows[:sizes]), bound=0.0 if opens else 0.4)
    along = replace(along, start=np.full(sizes, start))
    across = Unilateral(component=Component(rows[sizes:]), gap=np.full(sizes, 0.2))
    return Contact(
        tangential=along,
        normal=across if opens else None,
        points=np.arange(sizes),
        positions=np.arange(float(sizes)),
        weights=np.ones(sizes),
    )


@pytest.mark.parametrize("opens", [False, True])
def test_contacts_put_together_show_what_each_shows(opens: bool) -> None:
    random = np.random.default_rng(5)
    laws = [
        interface(0, 3, opens=opens, start=0.1),
        interface(100, 2, opens=opens),
        interface(6, 4, opens=opens, start=-0.2),
    ]
    stacks = Contacts(dict(zip("abc", laws, strict=True))).stacks
    both = ContactGroup([stacks[0], stacks[2]])
    alone = [ContactGroup([stacks[number]]) for number in (0, 2)]
    assert both.numbers.tolist() == [0, 2]
    assert both.points.tolist() == [0, 1, 2, 5, 6, 7, 8]
    displacement = random.normal(size=(14, 6))
    displacement[6:] *= 1e-10
    force = random.normal(size=(14, 6))
    assert np.array_equal(
        both.slip(displacement, force),
        np.concatenate([one.slip(displacement, force) for one in alone]),
    )
    assert np.array_equal(
        both.status(displacement, force),
        np.concatenate([one.status(displacement, force) for one in alone]),
    )
    first = both.slip(displacement, force)[:, 0]
    start = np.repeat([0.1, -0.2], [3, 4])
    sliders = displacement[[0, 1, 2, 6, 7, 8, 9], 0]
    assert first == pytest.approx(sliders - start, abs=1e-15)
    values = random.normal(size=(7, 6))
    parts = values[:3], values[3:]
    assert both.largest(values) == pytest.approx([part.max() for part in parts])
    assert both.sums(values[:, 0]) == pytest.approx(
        [part[:, 0].sum() for part in parts]
    )


def test_status_is_the_sign_of_slip_beyond_rounding_and_open_without_force() -> None:
    group = ContactGroup(Contacts({"one": interface(0, 2, opens=True)}).stacks)
    displacement = np.zeros((4, 4))
    displacement[0] = [1.0, 1.0, 0.5, 0.5 + 0.1 * NO_SLIP]
    displacement[1] = [0.0, -1.0, -1.0, -1.0]
    force = np.ones((4, 4))
    force[3, 2:] = 0.0
    status = group.status(displacement, force)
    assert status[0].tolist() == [1, 0, -1, 0]
    assert status[1].tolist() == [0, -1, OPEN, OPEN]
    still = group.status(displacement, force, still=0.7)
    assert still[0].tolist() == [1, 0, 0, 0]


def test_fields_of_a_contact_are_its_forces_jumps_and_gap_in_si() -> None:
    problem = discretise(block(elements=(6, 4), cuts=(2, 1), bodies=2))
    random = np.random.default_rng(6)
    (name,) = [name for name in problem.contacts if name != "support"]
    law = problem.contacts[name]
    # One displacement above and one below, all along.
    displacement = np.zeros((problem.n_rows, problem.n_instants))
    displacement[law.tangent.above] = 3e-3
    displacement[law.tangent.below] = 1e-3
    assert law.normal is not None
    displacement[law.normal.component.above] = 5e-3
    contacts = problem.contacts
    force = random.normal(size=(contacts.n_forces, problem.n_instants))
    status = random.integers(-1, 3, size=(contacts.n_points, problem.n_instants))
    scale = problem.scales.displacement
    fields = contacts.fields(force, displacement, status.astype(np.int8), scale)[name]
    shape = len(law.positions), problem.n_instants
    assert fields.slip == pytest.approx(np.full(shape, 2e-3 * scale))
    assert fields.opening == pytest.approx(np.full(shape, 5e-3 * scale))
    assert np.array_equal(fields.status, status[contacts.points[name]])
    across, along = problem.contacts.forces[name]
    assert np.array_equal(fields.normal_force, force[across])
    assert np.array_equal(fields.tangential_force, force[along])


# Driven points


def driven(**along: Any) -> tuple[DrivenFriction, Array]:
    """Two points of three whose displacement is given, and that, (2, n_instants)."""
    random = np.random.default_rng(7)
    values = np.cumsum(random.normal(size=(2, 30)), axis=1)
    values[:, 10:14] = values[:, 10:11]
    bound = friction_of(Component(np.arange(3)), bound=np.array([0.2, 0.3, 0.5]))
    law = Contact(
        tangential=replace(bound, **along),
        points=np.arange(3),
        positions=np.array([0.0, 1.0, 2.0]),
        weights=np.array([0.5, 1.0, 0.5]),
    )
    prescribed = np.array([0, 2]), values
    found = driven_friction(law, (slice(0, 3),), np.arange(3), prescribed, 1.0)
    assert found is not None
    return found, values


def test_driven_points_rub_against_their_slip_and_else_as_their_neighbour() -> None:
    found, values = driven()
    forces = np.random.default_rng(8).uniform(-1.0, 1.0, size=(3, 30))
    friction = found.force(forces, np.zeros((3, 30)))
    slip = np.diff(values, axis=1, prepend=0.0)
    bound = np.array([[0.2], [0.5]])
    slips = slip != 0.0
    assert friction[slips] == pytest.approx((-bound * np.sign(slip))[slips])
    # Both have half of the area of the point between them.
    even = np.clip(0.5 * forces[1], -bound, bound)
    assert friction[~slips] == pytest.approx(even[~slips])
    assert np.count_nonzero(~slips) == 6
    assert found.tangential.tolist() == [0, 2]


def test_driven_points_on_springs_lag_like_play_and_on_stiff_ones_not() -> None:
    soft = np.array([0.4, 1.0, 0.6])
    found, values = driven(compliance=soft)
    still = np.zeros((3, 30))
    friction = found.force(still, still)
    bound = np.array([0.2, 0.5])
    slider = play(values, bound * soft[[0, 2]])
    assert friction == pytest.approx((slider - values) / soft[[0, 2], None])
    stiff, _ = driven(compliance=np.full(3, 1e-9))
    rigid, _ = driven()
    slips = np.diff(values, axis=1, prepend=0.0) != 0.0
    assert stiff.force(still, still)[slips] == pytest.approx(
        rigid.force(still, still)[slips]
    )


def test_friction_of_driven_points_changes_with_the_slip_that_has_gone_by() -> None:
    slip_factor = SlipFactor((0.0, 5.0, 10.0), (1.0, 0.5, 0.8))
    found, values = driven(slip_factor=slip_factor)
    still = np.zeros((3, 30))
    slip = np.diff(values, axis=1, prepend=0.0)
    wanted = np.array([[0.2], [0.5]]) * slip_factor(np.cumsum(np.abs(slip), axis=1))
    assert np.abs(found.force(still, still))[slip != 0.0] == pytest.approx(
        wanted[slip != 0.0]
    )


def test_where_nothing_is_prescribed_no_point_is_driven() -> None:
    law = interface(0, 3, opens=False)
    nothing = np.zeros(0, dtype=int), np.zeros((0, 4))
    assert driven_friction(law, (slice(0, 3),), np.arange(6), nothing, 0.0) is None


# Drives

VALUES = np.array([0.0, 2.0, 2.0, -4.0, -1.0, 3.0])
PEAK = Drive("peak", "N", VALUES)


def test_the_end_of_a_step_of_a_drive_is_the_beginning_of_the_next() -> None:
    for instant in range(5):
        assert PEAK.describe(instant, 1.0) == PEAK.describe(instant + 1, 0.0)
        assert PEAK.before(instant + 1) == VALUES[instant]
    changes = [PEAK.changes(instant) for instant in range(6)]
    assert changes == [False, True, False, True, True, True]
    assert [PEAK.falls(instant) for instant in range(6)] == [False] * 4 + [True, False]
    assert PEAK.largest == 4.0


def test_a_load_is_told_with_its_share_of_the_largest_of_its_sign() -> None:
    assert PEAK.describe(1, 0.75) == "peak = 1.5 N (0.5 times its largest value)"
    assert PEAK.describe(4) == "peak = -1 N (0.25 times its largest value)"
    assert PEAK.describe(0) == "peak = 0 N"
    doubled = replace(PEAK, values=2.0 * VALUES)
    words = [of.describe(3).partition(" (")[2] for of in (PEAK, doubled)]
    assert words[0] == words[1]


def test_only_what_changes_is_told_and_what_falls_is_passed_downwards() -> None:
    falling = Drive("pressure", "Pa", np.array([8.0, 8.0, 8.0, 4.0, 4.0, 4.0]))
    assert describe_loads([PEAK, falling], 2) == ""
    assert describe_limit([PEAK, falling], 2, 0.5) == ""
    assert describe_loads([PEAK, falling], 1) == PEAK.describe(1)
    both = describe_limit([PEAK, falling], 3, 0.5)
    assert (
        both == f"beyond {PEAK.describe(3, 0.5)} and below {falling.describe(3, 0.5)}"
    )
    assert describe_limit([PEAK], 1, 0.0) == f"with {PEAK.describe(1)}"
    assert PEAK.during(slice(2, 4)).values.tolist() == [2.0, -4.0]
