"""Ends of contacts and corners of sides have one answer, and iterations do not grow with cuts."""

from __future__ import annotations

import numpy as np
import pytest
from plane import lengths, solved

SMALL = {"elements": 16, "elements_up": 8, "instants": 11}


def test_a_contact_ends_before_a_side_that_holds_its_normal_displacement():
    for left, right, first, last in (("free", "roller", 0, 16), ("clamped", "dragged", 1, 15)):
        iterate = solved("block", left=left, right=right, violation=1e-4, **SMALL)
        x = iterate.problem.rubbing["support"].positions / 0.1 * 16
        np.testing.assert_allclose(x, np.arange(first, last + 1), atol=1e-9)


@pytest.mark.parametrize("left", ["roller", "clamped", "displacement"])
def test_a_corner_that_two_sides_prescribe_follows_the_top(left):
    iterate = solved("block", left=left, **SMALL)
    inside = iterate.problem.inside
    moved = inside.displacement(iterate.displacement, [4])[:, :, 0]
    top = inside.nodes[:, 1] > 0.0499
    corner = top & (inside.nodes[:, 0] < 1e-9)
    assert corner.sum() == 1
    np.testing.assert_allclose(moved[corner][0], moved[top][-1], atol=1e-12)


def test_tractions_of_a_nearly_incompressible_rough_block_do_not_alternate_from_node_to_node():
    sizes = []
    for elements in (24, 48):
        iterate = solved(
            "block",
            violation=1e-7,
            gap="flat",
            poisson=0.4999,
            friction=10.0,
            interpolation="biquadratic",
            elements=elements,
            elements_up=elements // 2,
            instants=1,
        )
        fields, along = iterate.contact("support"), lengths(iterate)[:, 0]
        tractions = np.stack([fields.normal_force[:, -1], fields.tangential_force[:, -1]]) / along
        alternating = np.diff(tractions, 4)[:, elements // 3 : -elements // 3] / 16.0
        sizes.append(np.abs(alternating).max() / np.median(tractions[0]))
    assert sizes[1] < 0.5 * sizes[0] < 1e-3
