"""Unilateral contact with Coulomb friction holds pointwise on any input (solver/README.md, 2)."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.laws import Component, Contact, Sliders, Unilateral

ANY = settings(max_examples=100)
ROUNDING = 1e-12


@st.composite
def contacts(draw):
    """Interfaces with rows in any order, search directions and fields z."""
    seed = draw(st.integers(0, 2**31))
    two_bodies = draw(st.booleans())
    random = np.random.default_rng(seed)
    pairs, times = draw(st.integers(1, 6)), draw(st.integers(1, 12))
    rows = random.permutation(4 * pairs if two_bodies else 2 * pairs).reshape(-1, pairs)
    across, along = (Component(rows[n], rows[n + 2] if two_bodies else None) for n in (0, 1))
    gap = random.normal(size=pairs) * draw(st.sampled_from([0.0, 0.5]))
    friction = random.uniform(0.0, draw(st.sampled_from([0.0, 0.3, 10.0])) + 1e-300, pairs)
    law = Contact(
        normal=Unilateral(component=across, gap=gap),
        tangential=Sliders.of_contact(along, friction),
        points=np.arange(pairs),
        positions=np.arange(pairs, dtype=float),
        weights=np.ones(pairs),
    )
    k = 10.0 ** random.uniform(-2.0, 2.0, rows.size)
    return law, k, random.normal(size=(rows.size, times))


def local_stage(law, k, incoming):
    """Give displacements and forces of the local stage."""
    found = np.zeros_like(incoming)
    law.rule(k, incoming.shape[1])(incoming, found, slice(None))
    return found, k[:, None] * (found - incoming)


@ANY
@given(contacts())
def test_nothing_overlaps_nothing_pulls_and_what_is_open_carries_nothing(case):
    law, k, incoming = case
    moved, force = local_stage(law, k, incoming)
    opening = law.normal.opening(moved, force)
    pressing = force[law.normal.component.above]
    size = np.abs(incoming).max() * k.max()
    assert np.all(pressing >= 0.0)
    assert np.all(opening >= -ROUNDING * np.abs(incoming).max())
    assert np.all(np.minimum(opening * k.max(), pressing) <= ROUNDING * size)


@ANY
@given(contacts())
def test_friction_stays_in_the_cone_and_opposes_slip(case):
    law, k, incoming = case
    moved, force = local_stage(law, k, incoming)
    position = law.tangent.jump(moved)
    slip = np.diff(position, axis=1, prepend=0.0)
    bound = law.tangential.friction[:, None] * force[law.normal.component.above]
    held = force[law.tangent.above]
    size = np.abs(incoming).max()
    tight = ROUNDING * size * k.max()
    assert np.all(np.abs(held) <= bound + tight)
    slips = np.abs(slip) > ROUNDING * size * 10.0
    assert np.all(np.abs(held + np.sign(slip) * bound)[slips] <= 100.0 * tight)


@ANY
@given(contacts())
def test_forces_between_two_bodies_are_opposite(case):
    law, k, incoming = case
    _, force = local_stage(law, k, incoming)
    if not law.is_on_support:
        for above, below in law.components:
            size = np.abs(k[:, None] * incoming).max()
            np.testing.assert_allclose(force[above], -force[below], atol=ROUNDING * size, rtol=1e-9)
