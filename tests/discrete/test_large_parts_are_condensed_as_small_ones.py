"""Large parts are condensed by one factor, small ones by their own: to one result."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from solver.arrays import Array, Indices
from solver.discrete import Lattice, schur_complement
from solver.discrete.elements import dofs_of, elastic_matrix
from solver.discrete.schur_complement import (
    FewEliminated,
    ManyEliminated,
    SchurComplement,
)

BODY = Lattice(26, 18, 0.04, 0.06)
STIFFNESS = BODY.stiffness(elastic_matrix(1.0, 0.3, "strain"), np.arange(26 * 18))
WHOLE = sparse.csc_array(STIFFNESS)
SIDES = [("bottom",), ("left", "top"), ("left", "right", "bottom", "top")]


def kept_on(sides: tuple[str, ...]) -> Indices:
    return dofs_of(np.unique(np.concatenate([BODY.side(side) for side in sides])))


def close(found: Array, wanted: Array) -> bool:
    return bool(np.abs(found - wanted).max() <= 1e-11 * np.abs(wanted).max())


def by_both(
    monkeypatch: pytest.MonkeyPatch, kept: Indices
) -> tuple[SchurComplement, SchurComplement]:
    large = SchurComplement(WHOLE, kept)
    monkeypatch.setattr(schur_complement, "MANY", 10**9)
    return large, SchurComplement(WHOLE, kept)


@pytest.mark.parametrize("sides", SIDES)
def test_both_ways_condense_and_recover_alike(
    sides: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = kept_on(sides)
    large, small = by_both(monkeypatch, kept)
    assert isinstance(large._eliminated, ManyEliminated)
    assert isinstance(small._eliminated, FewEliminated)
    random = np.random.default_rng(3)
    forces = random.normal(size=(2, 2 * BODY.grid.size, 3))
    moved = random.normal(size=(len(kept), 3))
    every = np.eye(len(kept))
    assert close(large.stiffness, small.stiffness)
    assert close(large.condense(forces), small.condense(forces))
    for force in (forces[0], None):
        assert close(large.recover(moved, force), small.recover(moved, force))
    assert close(large.recover(every, None), small.recover(every, None))
    signs = np.where(np.arange(len(kept)) % 3, 1.0, -1.0)
    turned = large.with_signs(signs).recover(moved, forces[1])
    assert close(turned, small.with_signs(signs).recover(moved, forces[1]))


@pytest.mark.parametrize("sides", SIDES)
def test_a_large_body_moves_freely_as_a_rigid_one(sides: tuple[str, ...]) -> None:
    kept = kept_on(sides)
    x, y = BODY.nodes.T
    motions = np.zeros((BODY.grid.size, 2, 3))
    motions[:, 0] = np.stack([np.ones_like(x), np.zeros_like(x), -y], axis=1)
    motions[:, 1] = np.stack([np.zeros_like(x), np.ones_like(x), x], axis=1)
    rigid = motions.reshape(-1, 3)
    condensed = SchurComplement(WHOLE, kept)
    size = np.abs(condensed.stiffness).max()
    assert np.abs(condensed.stiffness @ rigid[kept]).max() <= 1e-12 * size
    assert close(condensed.recover(rigid[kept], None), rigid)


def test_few_entries_are_multiplied_as_among_all_zeros(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    outline = kept_on(SIDES[-1])
    monkeypatch.setattr(schur_complement, "MANY", 10**9)
    dense = SchurComplement(WHOLE, outline)
    monkeypatch.setattr(schur_complement, "DENSE", 0)
    assert close(SchurComplement(WHOLE, outline).stiffness, dense.stiffness)


def test_few_of_many_are_condensed_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Degrees of freedom that are kept come last in the factor where they are many."""
    corner = dofs_of(BODY.side("bottom")[:3])
    assert ManyEliminated.of(WHOLE, corner) is None
    monkeypatch.setattr(schur_complement, "SOME", 0)
    monkeypatch.setattr(schur_complement, "WIDE", 1)
    assert ManyEliminated.of(WHOLE, corner) is None
