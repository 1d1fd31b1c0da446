"""A body of any shape is cut into parts that hang together."""

from __future__ import annotations

import numpy as np
import pytest
from shaped_bodies import grid, in_triangles

from solver.arrays import Flags, Indices
from solver.discrete import Beam, Bodies, Body, Joint, Load, Mesh, discretise
from solver.discrete.plane.cut_shapes import CutShape, bisected
from solver.reference.incremental import reference_of


def horseshoe() -> Mesh:
    """Two tall arms on a foot."""
    whole = grid(np.linspace(0.0, 0.05, 6), np.linspace(0.0, 0.1, 11))
    x, y = whole.centres.T
    elements = whole.elements[(np.abs(x - 0.025) > 0.006) | (y < 0.02)]
    used = np.unique(elements)
    return Mesh(whole.corners[used], np.searchsorted(used, elements))


@pytest.mark.parametrize("count", [2, 3, 5, 8])
@pytest.mark.parametrize("kind", ["quadrilaterals", "triangles"])
def test_each_part_of_a_horseshoe_is_one_piece(kind: str, count: int) -> None:
    mesh = horseshoe()
    if kind == "triangles":
        mesh = in_triangles(mesh)
    cut = CutShape(mesh, count)
    assert len(np.unique(cut.labels)) == count
    assert mesh.pieces(cut.labels).max() + 1 == count


def test_halves_of_a_horseshoe_by_bisection_alone_are_not() -> None:
    mesh = horseshoe()
    assert mesh.pieces(bisected(mesh.centres, 2)).max() + 1 > 2


def row(mesh: Mesh, is_wanted: Flags) -> Indices:
    """Chain of nodes from left to right through the corners that are wanted."""
    corners = np.flatnonzero(is_wanted)
    return mesh.along(corners[np.argsort(mesh.corners[corners, 0])])


def pressed_horseshoe(parts: int) -> Bodies:
    """A horseshoe on the ground, pressed on its left tip and cut into parts."""
    mesh = horseshoe()
    x, y = mesh.corners.T
    foot = row(mesh, y == 0.0)
    t = np.linspace(0.0, 1.0, 4)
    body = Body("horseshoe", mesh, 1e10, 0.3, substructures=parts)
    tip = row(mesh, np.isclose(y, 0.1) & (x < 0.025))
    press = Load.of_traction("tip", 0, body, tip, np.outer([5e4, -1e6], t))
    up = np.tile([0.0, 1.0], (len(foot), 1))
    ground = Joint("ground", 0, foot, None, None, up, friction=0.4)
    return Bodies([body], [ground], [], [press], t, 1.0)


def test_a_horseshoe_has_one_answer_however_it_is_cut() -> None:
    wanted = reference_of(discretise(pressed_horseshoe(1)))
    assert wanted.converged.all()
    size = np.abs(wanted.contact_force).max()
    for parts in (2, 5):
        found = reference_of(discretise(pressed_horseshoe(parts)))
        assert found.contact_force == pytest.approx(
            wanted.contact_force, abs=1e-9 * size
        )


def test_a_line_that_winds_back_is_cut_along_itself() -> None:
    angles = np.linspace(0.0, 6.0 * np.pi, 61)
    line = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    labels = CutShape(Beam(line, 1e-4, 1e-10), 6).labels
    assert np.array_equal(labels, np.repeat(np.arange(6), 10))
