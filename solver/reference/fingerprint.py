"""What the solution of a problem depends on, in a few bytes: equal ones have the same reference."""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force
from solver.reference.glued import jumps
from solver.reference.rules import rules_of


def fingerprint(problem: Problem) -> bytes:
    """Digest all that the incremental solvers read of a problem, and nothing that they do not.

    So cuts count where degrees of freedom depend on them, as in the plane, and do not along a rod;
    the method never does. Problems that differ by rounding count as two.
    """
    digest = blake2b(digest_size=16)
    for name, law in problem.rubbing.items():
        digest.update(f"{name} {law.opens} {law.is_on_support}".encode())
    for array in _arrays(problem):
        digest.update(f"{array.dtype.str} {array.shape}".encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.digest()


def _arrays(problem: Problem) -> Iterator[NDArray[np.generic]]:
    scales, rules = problem.scales, rules_of(problem)
    yield np.array([scales.displacement, scales.force, scales.time])
    yield problem.instants
    yield problem.positions
    yield external_force(problem)
    yield from problem.prescribed
    yield from (
        rules.normal,
        rules.gap,
        rules.partner,
        rules.friction,
        rules.bound,
        rules.compliance,
        rules.cap,
        rules.strength,
        *(np.array([strength.slips, strength.factors]) for strength in rules.strengths),
    )
    for matrix in (assembled_stiffness(problem), jumps(problem)):
        matrix.sort_indices()
        yield from (matrix.indptr, matrix.indices, matrix.data)
    for law in problem.rubbing.values():
        yield law.positions
    if problem.rest is not None:
        yield problem.rest
