"""Between bodies that nowhere slip k becomes that of one body; between those that do it stays."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from solver.latin import iterations, solve
from solver.latin.directions import LOOK
from solver.latin.iterate import Checkpoint
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

THIN = {"length": 2.0, "thickness": 0.01, "elements": 24, "instants": 13, "finish": "none"}
SLIPPING = {"instants": 13, "elements": 24, "finish": "none"}


def problem_of(**values):
    settings = CATALOGUE["layers"].settings.checked(values)
    return discretise(settings), method_of(settings)


def iterates(number, start=None, **values):
    problem, latin = problem_of(**values)
    return list(islice(iterations(problem, latin, start), number))


@pytest.mark.parametrize("ratio", [200, 500, 1000])
@pytest.mark.parametrize("layers", [4, 10])
def test_thin_layers_that_stick_come_within_one_percent_in_thirty_iterations(ratio, layers):
    problem, latin = problem_of(**{**THIN, "length": 0.01 * ratio, "layers": layers})
    distance = distance_to(reference_of(problem), problem)
    errors = [distance.of_friction_force(one) for one in islice(iterations(problem, latin), 33)]
    assert max(errors[-4:]) <= 0.01


def test_k_changes_once_and_only_on_what_touches():
    found = iterates(LOOK + 9, **THIN)
    before, after = found[LOOK - 1].k, found[LOOK].k
    assert all(one.k is before for one in found[:LOOK])
    assert all(one.k is after for one in found[LOOK:])
    law = found[0].problem.rubbing["contact 1-2"]
    for component in law.components:
        # E / d per area, scaled: the length of the contact over the depth of a layer
        np.testing.assert_allclose(after[component.above], law.weights / 0.01, rtol=1e-12)
    rubs = np.concatenate([law.rows for law in found[0].problem.rubbing.values()])
    apart = np.setdiff1d(np.arange(len(before)), rubs)
    assert np.array_equal(after[apart], before[apart])


def test_k_stays_where_anything_slips():
    found = iterates(LOOK + 9, **SLIPPING)
    assert np.any(np.abs(found[LOOK - 1].contact("contact 1-2").status) == 1)
    assert all(one.k is found[0].k for one in found)


def test_k_stays_in_a_run_from_the_fields_of_another():
    near = iterates(30, **THIN)[-1]
    found = iterates(LOOK + 3, Checkpoint(0, 0.0, near.outgoing), **THIN)
    assert all(one.k is found[0].k for one in found)


@pytest.mark.parametrize("place", [LOOK - 2, LOOK - 1, LOOK, LOOK + 4])
def test_such_a_run_goes_on_from_any_checkpoint_to_the_bit(place):
    straight = iterates(LOOK + 8, **THIN)
    again = iterates(len(straight) - place - 1, straight[place].checkpoint, **THIN)
    for one, other in zip(again, straight[place + 1 :], strict=True):
        assert np.array_equal(one.k, other.k)
        assert np.array_equal(one.outgoing, other.outgoing)


def test_what_nowhere_slips_is_solved_by_a_status_step_at_once():
    solution = solve(*problem_of(**{**THIN, "instants": 81, "finish": "at-once"}))
    assert solution.is_certified
    assert solution.iterate.number <= LOOK
