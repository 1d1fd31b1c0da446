"""Pairs of a point share its force; cuts change neither that nor k."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from contact_problems import friction_of

from solver.laws import (
    BodyStiffness,
    Component,
    Contact,
    RodStiffness,
    Unilateral,
)

# Pairs of points


def cut_contact(normal: bool = False, **rest) -> Contact:
    """Three points of which the middle one has two pairs, as where a cut crosses."""
    points = np.array([0, 1, 1, 2])
    rows = np.arange(4)
    return Contact(
        tangential=friction_of(Component(rows), bound=np.array([0.2, 0.3, 0.5, 0.1])),
        normal=Unilateral(component=Component(rows + 4), gap=np.zeros(4))
        if normal
        else None,
        points=points,
        positions=np.array([0.0, 1.0, 2.0]),
        weights=np.array([0.5, 0.5, 0.5, 0.5]),
        **rest,
    )


def whole_contact(normal: bool = False, **rest) -> Contact:
    rows = np.arange(3)
    return Contact(
        tangential=friction_of(Component(rows), bound=np.array([0.2, 0.8, 0.1])),
        normal=Unilateral(component=Component(rows + 4), gap=np.zeros(3))
        if normal
        else None,
        points=rows,
        positions=np.array([0.0, 1.0, 2.0]),
        weights=np.array([0.5, 1.0, 0.5]),
        **rest,
    )


def test_a_point_without_friction_does_not_change_the_shares_of_others() -> None:
    """Pairs share by their bounds wherever these are, and by their areas elsewhere."""
    law = cut_contact()
    bound = np.array([0.0, 0.3, 0.5, 0.1])
    rows = np.arange(4)
    some = replace(law, tangential=friction_of(Component(rows), bound=bound))
    assert some.shares == pytest.approx([1.0, 0.3 / 0.8, 0.5 / 0.8, 1.0])
    none = replace(law, tangential=friction_of(Component(rows), bound=0.0 * bound))
    assert none.shares == pytest.approx([1.0, 0.5, 0.5, 1.0])


def test_pairs_of_a_point_share_its_force_and_are_springs_in_parallel() -> None:
    law = cut_contact()
    assert law.by_point(law.shares) == pytest.approx(np.ones(3))
    assert law.shares[1:3] == pytest.approx([0.3 / 0.8, 0.5 / 0.8])
    values = np.array([1.0, 2.0, 4.0, 8.0])
    assert law.by_point(values) == pytest.approx([1.0, 6.0, 8.0])
    assert law.mean_by_point(values) == pytest.approx([1.0, 3.0, 8.0])
    soft = law.in_parallel(values)
    assert soft == pytest.approx([1.0, 1.0 / (0.5 + 0.25), 8.0])
    assert not law.in_parallel(None).any()


# Search directions


@pytest.mark.parametrize(
    "stiffness_beside", [RodStiffness(), BodyStiffness(), BodyStiffness(depth=0.01)]
)
def test_cuts_change_no_k_of_a_point(
    stiffness_beside: RodStiffness | BodyStiffness,
) -> None:
    opens = isinstance(stiffness_beside, BodyStiffness)
    cut = cut_contact(normal=opens, stiffness_beside=stiffness_beside)
    whole = whole_contact(normal=opens, stiffness_beside=stiffness_beside)
    found, wanted = np.full((2, 8), np.nan)
    stiffness_beside.choose(cut, found, 3.0, math.inf)
    stiffness_beside.choose(whole, wanted, 3.0, math.inf)
    for first in (0, 4)[: 1 + opens]:
        of_points = cut.by_point(found[first : first + 4])
        assert of_points == pytest.approx(wanted[first : first + 3])


def two_sided(stiffness_beside: BodyStiffness) -> Contact:
    rows = np.arange(12).reshape(4, 3)
    return Contact(
        tangential=friction_of(Component(rows[0], rows[1])),
        normal=Unilateral(component=Component(rows[2], rows[3]), gap=np.zeros(3)),
        points=np.arange(3),
        positions=np.array([0.0, 1.0, 2.0]),
        weights=np.array([0.5, 1.0, 0.5]),
        stiffness_beside=stiffness_beside,
    )


def test_k_of_a_body_is_in_proportion_to_its_modulus_and_to_area() -> None:
    found, wanted = np.zeros((2, 12))
    BodyStiffness(3.0, 5.0).choose(
        two_sided(BodyStiffness(3.0, 5.0)), found, 1.0, math.inf
    )
    BodyStiffness(1.0, 1.0).choose(
        two_sided(BodyStiffness(1.0, 1.0)), wanted, 1.0, math.inf
    )
    factors = np.repeat([3.0, 5.0, 3.0, 5.0], 3)
    assert found == pytest.approx(factors * wanted)
    assert wanted.reshape(4, 3)[:, 1] == pytest.approx(2.0 * wanted.reshape(4, 3)[:, 0])


def test_k_of_a_rod_grows_with_its_stiffness_and_the_number_of_contacts() -> None:
    law = whole_contact()
    plain, more, stiff = np.zeros((3, 3))
    RodStiffness().choose(law, plain, 1.0, math.inf)
    RodStiffness().choose(law, more, 4.0, math.inf)
    modulus = np.array([1.0, 2.0, 3.0])
    RodStiffness(modulus).choose(law, stiff, 1.0, math.inf)
    assert more == pytest.approx(4.0 * plain)
    assert stiff == pytest.approx(modulus * plain)


def test_bodies_that_stick_are_never_softer_and_as_stiff_as_their_depth() -> None:
    stiffness_beside = BodyStiffness(2.0, 3.0, depth=1e-3)
    law = two_sided(stiffness_beside)
    before = np.zeros(12)
    stiffness_beside.choose(law, before, 1.0, math.inf)
    after = before.copy()
    stiffness_beside.choose_sticking(law, after)
    assert np.all(after >= before)
    assert after == pytest.approx(np.tile(2.0 * law.weights / 1e-3, 4))
    thick = BodyStiffness(2.0, 3.0, depth=1e3)
    same = before.copy()
    thick.choose_sticking(law, same)
    assert np.array_equal(same, before)


def test_a_thin_body_on_a_support_is_squeezed_with_its_modulus_over_its_depth() -> None:
    stiffness_beside = BodyStiffness(depth=1e-3)
    law = whole_contact(normal=True, stiffness_beside=stiffness_beside)
    k = np.zeros(8)
    stiffness_beside.choose(law, k, 1.0, math.inf)
    assert k[:3] == pytest.approx(law.weights / 1e-3)
    assert k[4:7] == pytest.approx(law.weights / 1e-3)
