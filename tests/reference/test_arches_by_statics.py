"""Statics of an arch of voussoirs has the published numbers, and balances."""

import numpy as np
import pytest
from scipy.integrate import quad

from solver.reference.closed_forms.arch import VoussoirArch


@pytest.mark.parametrize(
    ("voussoirs", "known"),
    [(9, 0.10213), (15, 0.10627), (31, 0.10717), (61, 0.10741), (401, 0.10748)],
)
def test_the_thinnest_semicircle_tends_to_that_of_milankovitch(voussoirs, known):
    # 0.10748: M. Milankovitch, Z. Math. Phys. 55, 1907.
    thinnest = VoussoirArch(voussoirs, 0.2).thinnest()
    assert thinnest == pytest.approx(known, abs=6e-6)


@pytest.mark.parametrize(
    ("thickness", "known"), [(0.12, 0.3817), (0.15, 0.3517), (0.2, 0.3092)]
)
def test_a_thicker_semicircle_needs_less_friction(thickness, known):
    # Known numbers are those of joints that are ever closer.
    least = VoussoirArch(401, thickness).least_friction()
    assert least == pytest.approx(known, abs=1e-4)


def test_abutments_move_the_thrust_between_two_bounds():
    least, largest = VoussoirArch(25, 0.15).thrusts()
    assert least == pytest.approx(0.17474, abs=6e-6)
    assert largest == pytest.approx(0.22722, abs=6e-6)


@pytest.mark.parametrize("span", [np.pi, 2.0, 1.0])
def test_an_arch_stands_where_its_thrusts_meet(span):
    arch = VoussoirArch(31, 0.2, span)
    thinnest = arch.thinnest()
    thicker = VoussoirArch(31, 1.0001 * thinnest, span)
    thinner = VoussoirArch(31, 0.9999 * thinnest, span)
    least, largest = thicker.thrusts()
    assert largest == pytest.approx(least, rel=0.01)
    assert thinner.reserve < 0.0 <= thicker.reserve
    assert thinner.thrusts() is None


def test_a_flat_arch_may_be_a_strut_of_any_thrust():
    strut = VoussoirArch(9, 0.2, 0.4)
    least, largest = strut.thrusts()
    assert 0.0 < least < np.inf
    assert largest == np.inf
    # Friction of the ends bounds what statics without slip does not.
    assert VoussoirArch(9, 0.2, 0.4, friction=0.15).thrusts()[1] < np.inf


def test_a_semicircle_of_smooth_joints_never_stands():
    assert VoussoirArch(15, 0.2, friction=0.1).thinnest() is None
    assert VoussoirArch(15, 0.1).least_friction() is None


@pytest.mark.parametrize("span", [np.pi, 2.0])
@pytest.mark.parametrize("centres", [0.3, 1.0, 3.0])
def test_a_pointed_arch_thrusts_at_most_as_its_half_leans_on_the_other(span, centres):
    """The half turns about its outer foot, and presses at the lowest of the crown."""
    arch = VoussoirArch(30, 0.15, span, fill=0.4, cover=0.2, centres=centres)
    inner, outer = arch.radii
    offset = arch.offset
    foot = 0.5 * span
    clear = 2.0 * (inner * np.sin(foot) - offset)
    assert 2.0 * offset == pytest.approx(centres * clear)

    def width(radius):
        return radius * (foot - np.arcsin(offset / radius))

    def moment(radius):
        # About the centre, of an arc from the crown on.
        return radius**2 * (np.sqrt(1.0 - (offset / radius) ** 2) - np.cos(foot))

    def column(along):
        highest = np.sqrt(outer**2 - offset**2) + 0.2
        return 0.4 * (highest - np.sqrt(outer**2 - along**2))

    ends = offset, outer * np.sin(foot)
    filled = quad(column, *ends)[0]
    half = quad(width, inner, outer)[0] + filled
    assert arch.weight == pytest.approx(2.0 * half)
    turning = quad(moment, inner, outer)[0]
    turning += quad(lambda along: along * column(along), *ends)[0]
    lever = outer * np.sin(foot) * half - turning
    rise = np.sqrt(inner**2 - offset**2) - outer * np.cos(foot)
    _, largest = arch.thrusts()
    assert largest == pytest.approx(lever / rise / arch.weight)


def test_a_more_pointed_ring_may_be_thinner():
    thinnest = [
        VoussoirArch(400, 0.15, centres=centres).thinnest()
        for centres in (0.0, 0.5, 1.0)
    ]
    # The numbers of MATHEMATICS.md.
    assert thinnest == pytest.approx([0.1075, 0.0546, 0.0399], abs=5e-5)


def test_the_fill_weighs_as_its_columns_do():
    arch = VoussoirArch(16, 0.2, 2.0, fill=0.7, cover=0.3)
    outer = 1.1

    def column(angle):
        height = outer + 0.3 - outer * np.cos(angle)
        return 0.7 * height * outer * np.cos(angle)

    ring = 2.0 * 0.2
    assert arch.weight == pytest.approx(ring + 2.0 * quad(column, 0.0, 1.0)[0])
    # Turned about the springing, half of the arch balances the thrust at the crown: of
    # a flat, thin ring that is W l / 8 f.
    flat = VoussoirArch(101, 0.0002, 0.02, fill=1.0, cover=1.0)
    rise = 1.0 - np.cos(0.01)
    least, _ = flat.thrusts()
    assert least == pytest.approx(0.02 / (8.0 * (rise + 0.0002)), rel=0.01)
