"""Free hinges: bodies move as rigid ones, and the search gets there."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from runs import assert_goes_on, distance_of, errors, iterates, settings_of

from solver.latin import iterations
from solver.latin.stages import rigid_balance
from solver.latin.stages.rigid_bodies import PATIENCE, RigidBodies, moves_rigidly
from solver.scenes import discretise
from solver.scenes.method import method_of

MOVED = {"voussoirs": 15, "instants": 21, "displacement": 2e-3}
APART = [[0.0, 0.0], [0.25, 0.0], [1.0, 0.002]]
POINTED = {"centres": 1.0, "friction": 0.9}
ENOUGH = 60
"""Iterations within which all default scenes are to be at 1 %."""


def arch(**changes):
    return settings_of("arch", **(MOVED | changes))


def shifts_of(problem, settings, *, from_rest=True):
    k = method_of(settings).direction.of(problem)
    if not moves_rigidly(problem):
        return k, None
    return k, RigidBodies(problem, k, from_rest=from_rest)


def unbalanced(problem, force):
    """Sum of the forces of rows and body forces on every body, and their sizes."""
    sums = []
    sizes = []
    for part in problem.substructures:
        of_dofs = problem.inside.rigid_modes(part.dofs)
        of_rows = of_dofs[part.elasticity.trace]
        total = of_rows.T @ force[part.rows]
        if part.body_force is not None:
            total += of_dofs.T @ part.body_force
        sums.append(total)
        sizes.append(np.abs(of_rows).T @ np.abs(force[part.rows]))
    return np.concatenate(sums), np.concatenate(sizes)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"displacement": -2e-3},
        {"displacement": 0.1},
        {"voussoirs": 61, "displacement": 0.02},
        {"abutment": "down"},
        {"span": 100.0, "friction": 0.9},
        POINTED,
        {"elements": 4, "substructures": 2},
        {"abutment_load": APART, "instants": 5},
        {"method": "paper"},
        {"acceleration": "none"},
    ],
    ids=str,
)
def test_the_search_reaches_one_percent_on_free_hinges(changes):
    found = errors(arch(**changes), ENOUGH)
    assert found.min() <= 0.01
    assert found[-1] <= 1e-4


def test_more_voussoirs_take_hardly_more_iterations():
    for voussoirs in (15, 61):
        found = errors(arch(voussoirs=voussoirs), 25)
        assert found[-1] <= 0.01


def test_without_shifts_the_search_does_not_converge():
    assert errors(arch(multiscale=False), ENOUGH).min() > 0.1


def test_every_body_is_in_balance_after_a_local_stage():
    last = iterates(arch(), 5)[-1]
    missing, size = unbalanced(last.problem, last.boundary_local_force)
    assert np.abs(missing).max() <= 1e-8 * size.max()


def test_rigid_motions_of_the_fields_hardly_change_forces():
    settings = arch()
    problem = discretise(settings)
    latin = replace(method_of(settings), acceleration=None)
    (start,) = islice(iterations(problem, latin), 4, 5)
    moved = start.outgoing.copy(order="F")
    amounts = 1e-8 * np.random.default_rng(1).standard_normal(3)
    for part in problem.substructures:
        modes = problem.inside.rigid_modes(part.dofs)[part.elasticity.trace]
        moved[part.rows] += (modes @ amounts)[:, None]
    after = []
    for outgoing in (start.outgoing, moved):
        again = replace(start.checkpoint, outgoing=outgoing)
        after.append(next(iterations(problem, latin, again)))
    one, other = [each.boundary_local_force for each in after]
    np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-4 * np.abs(one).max())


def test_steps_of_all_instants_together_lead_where_one_by_one_they_do(monkeypatch):
    settings = arch()
    last = iterates(settings, 8)[-1]
    _, shifts = shifts_of(last.problem, settings, from_rest=False)
    together = shifts.balanced(last.incoming)
    monkeypatch.setattr(rigid_balance, "NEAR", 0.0)
    walked = shifts.balanced(last.incoming)
    change = np.abs(walked - last.incoming).max()
    assert change > 0.0
    np.testing.assert_allclose(together, walked, rtol=0.0, atol=1e-2 * change)


@pytest.mark.parametrize(
    "changes",
    [
        {"voussoirs": 39, "friction": 0.49, "thickness": 0.29, "instants": 9},
        {"voussoirs": 36, "friction": 0.58, "thickness": 0.34, "centres": 0.5},
    ],
    ids=str,
)
def test_thick_rings_of_a_quarter_circle_are_in_balance_after_each_local_stage(changes):
    moved = {"span": 90.0, "displacement": 7e-4, "instants": 15}
    settings = settings_of("arch", **(moved | changes))
    problem = discretise(settings)
    distance = distance_of(problem)
    found = []
    for one in islice(iterations(problem, method_of(settings)), 30):
        if one.number <= 6:
            missing, size = unbalanced(problem, one.boundary_local_force)
            assert np.abs(missing).max() <= 1e-8 * size.max()
        found.append(distance.of_friction_force(one))
        if one.number >= 6 and min(found) <= 0.01:
            break
    assert min(found) <= 0.01


def test_paths_from_instant_to_instant_lead_to_balance_without_newtons_steps(
    monkeypatch,
):
    settled = rigid_balance.Balance.solve_instant
    ends = []

    def followed(self, loading, sliders, guesses, before, last):
        is_pressed = last is not None and last[0].load.any()
        if not is_pressed:
            return settled(self, loading, sliders, guesses, before, last)
        end = self._follow_path(last, loading, sliders)
        assert end.error <= self.enough
        ends.append(end)
        return end

    monkeypatch.setattr(rigid_balance.Balance, "solve_instant", followed)
    assert errors(arch(instants=13), 25)[-1] <= 0.01
    assert len(ends) > 10


def test_bodies_that_move_far_are_in_balance_up_to_rounding(monkeypatch):
    settings = settings_of("arch", displacement=0.1)
    problem = discretise(settings)
    _, shifts = shifts_of(problem, settings)

    def never(*_):
        raise AssertionError("Rounding was taken for want of balance.")

    monkeypatch.setattr(rigid_balance.Balance, "_follow_path", never)
    field = np.zeros((problem.n_rows, problem.n_instants), order="F")
    assert np.abs(shifts.balanced(field)).max() > 0.0


def test_a_run_that_is_resumed_goes_on_exactly():
    assert_goes_on(arch(acceleration="none"), 8, 4)


def test_rigid_bodies_on_springs_thrust_as_statics_says():
    settings = arch(elements=4)
    (first,) = iterates(settings, 1)
    force = first.boundary_local_force
    modes = first.problem.inside.rigid_modes
    # What the moved abutment is pushed with along x, by the joints beside it.
    part = first.problem.substructures[-1]
    held = first.problem.is_held[part.rows]
    along = modes(part.dofs)[part.elasticity.trace][:, 0]
    pushed = -(along[~held] @ force[part.rows[~held]])
    weight = settings.structure().downwards[-1] / first.problem.scales.force
    thrust = np.abs(pushed[settings.path("abutment_load") == 2e-3]) / weight
    least, _ = settings.statics.thrusts()
    np.testing.assert_allclose(thrust, least, rtol=0.02)


@pytest.mark.parametrize(
    "changes",
    [{"displacement": 5e-5}, {"unit_weight": 0.0, "displacement": 1e-6}],
    ids=str,
)
def test_bodies_that_hardly_move_are_not_shifted(changes):
    settings = arch(**changes)
    problem = discretise(settings)
    assert shifts_of(problem, settings)[1] is None


@pytest.mark.parametrize("scene", ["block", "layers", "wall", "bundle", "mesh", "belt"])
def test_no_other_scene_is_shifted_by_default(scene):
    settings = settings_of(scene)
    problem = discretise(settings)
    assert shifts_of(problem, settings)[1] is None


def test_bricks_of_a_wall_are_not_shifted_however_far_it_moves():
    settings = settings_of("wall", pressure=1e3, displacement=2e-3)
    problem = discretise(settings)
    assert shifts_of(problem, settings)[1] is None


def test_bodies_without_any_balance_are_left_alone_at_last():
    settings = arch(thickness=0.1, friction=0.6, instants=2)
    problem = discretise(settings)
    _, shifts = shifts_of(problem, settings)
    assert isinstance(shifts, RigidBodies)
    field = np.zeros((problem.n_rows, problem.n_instants), order="F")
    for _ in range(PATIENCE):
        assert np.all(np.isfinite(shifts.balanced(field)))
    assert shifts.balanced(field) is field
