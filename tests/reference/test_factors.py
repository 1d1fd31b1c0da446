"""Factors that follow a change of few rows and columns are those of the new matrix."""

from __future__ import annotations

import numpy as np
import pytest

from solver.arrays import Array, Indices
from solver.reference.factors import Factors, UpdatedFactors

SEEDS = range(8)
SIZE = 30


def parts(seed: int) -> tuple[Array, Indices, Indices, Indices]:
    """A matrix of all rows, (n, n); rows of before, removed and added, (m,) each."""
    random = np.random.default_rng(seed)
    matrix = random.normal(size=(SIZE, SIZE)) + 4.0 * np.eye(SIZE)
    before = np.sort(random.choice(SIZE, 20, replace=False))
    removed = np.sort(random.choice(before, 1 + seed % 4, replace=False))
    others = np.setdiff1d(np.arange(SIZE), before)
    added = np.sort(random.choice(others, seed % 3, replace=False))
    return matrix, before, removed, added


def updated(
    matrix: Array, changed: Array, before: Indices, removed: Indices, added: Indices
) -> tuple[UpdatedFactors, Array]:
    """Factors that are updated, and the matrix that they are of, (n_now, n_now).

    Rows that are removed and added are those of the changed matrix.
    """
    now = np.union1d(np.setdiff1d(before, removed), added)
    factors = UpdatedFactors(
        Factors(matrix[np.ix_(before, before)]),
        np.searchsorted(before, removed),
        np.searchsorted(now, added),
        columns=matrix[np.ix_(before, added)],
        rows=changed[np.ix_(added, before)],
        corner=changed[np.ix_(added, added)],
    )
    whole = matrix.copy()
    whole[added] = changed[added]
    return factors, whole[np.ix_(now, now)]


@pytest.mark.parametrize("seed", SEEDS)
def test_updated_factors_solve_as_new_ones_do(seed: int) -> None:
    matrix, before, removed, added = parts(seed)
    factors, wanted = updated(matrix, matrix, before, removed, added)
    right = np.random.default_rng(seed).normal(size=len(wanted))
    assert factors.solve(right) == pytest.approx(np.linalg.solve(wanted, right))
    sign, _ = np.linalg.slogdet(wanted)
    assert factors.has_negative_determinant == (sign < 0.0)
    assert not factors.is_doubtful


@pytest.mark.parametrize("seed", SEEDS)
def test_an_equation_that_changes_is_removed_and_added(seed: int) -> None:
    matrix, before, removed, added = parts(seed)
    random = np.random.default_rng(seed)
    changed = random.normal(size=(SIZE, SIZE))
    factors, wanted = updated(
        matrix, changed, before, removed, np.union1d(removed, added)
    )
    right = random.normal(size=len(wanted))
    assert factors.solve(right) == pytest.approx(np.linalg.solve(wanted, right))
    sign, _ = np.linalg.slogdet(wanted)
    assert factors.has_negative_determinant == (sign < 0.0)


def test_updates_that_lose_digits_are_doubtful() -> None:
    matrix, before, removed, added = parts(3)
    changed = matrix.copy()
    place = before[~np.isin(before, removed)][0]
    changed[removed[0]] = matrix[place]
    factors, wanted = updated(
        matrix, changed, before, removed[:1], np.union1d(removed[:1], added)
    )
    assert np.linalg.matrix_rank(wanted) == len(wanted) - 1
    assert factors.is_doubtful


@pytest.mark.parametrize("seed", SEEDS)
def test_the_smallest_best_solution_counts_where_nothing_else_does(seed: int) -> None:
    random = np.random.default_rng(seed)
    thin = random.normal(size=(12, 9))
    matrix = thin @ random.normal(size=(9, 12))
    factors = Factors(matrix)
    right = random.normal(size=12)
    assert factors.singular
    wanted = np.linalg.pinv(matrix, rcond=1e-12) @ right
    assert factors.solve(right) == pytest.approx(wanted)
