"""Any instant is a local contact problem in FCLIB's layout, with the reactions of our reference."""

from __future__ import annotations

import importlib
import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from solver.cli import main
from solver.reference.choice import reference_of
from solver.reference.condensation import Condensation
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise
from solver.study.other_programs import fclib
from solver.study.other_programs.fclib import contacts_of, local_problem, write_fclib

SMALL = {
    "block": {"elements": 16, "elements_up": 6, "instants": 21},
    "layers": {"layers": 3, "elements": 6, "elements_up": 2, "instants": 21},
}
INSTANTS = (0, 6, 13)


def problem_of(scene, **changes):
    return discretise(CATALOGUE[scene].settings.checked(SMALL.get(scene, {}) | changes))


def gauss_seidel(compliance, free, friction, most=50_000):
    """Solve point by point: r_N from its opening, and r_T from its slip, cut to the cone."""
    force = np.zeros_like(free)
    for _ in range(most):
        before = force.copy()
        for normal, mu in zip(range(0, len(free), 2), friction, strict=True):
            for row in (normal, normal + 1):
                move = compliance[row] @ force + free[row]
                force[row] -= move / compliance[row, row]
                bound = mu * force[normal]
                low, high = (0.0, np.inf) if row == normal else (-bound, bound)
                force[row] = min(max(force[row], low), high)
        if np.abs(force - before).max() <= 1e-13 * np.abs(force).max():
            return force
    raise AssertionError("no solution is found")


def siconos(compliance, free, friction):
    """Solve by siconos, whose tolerances are absolute: so its problem has ordinary sizes."""
    try:
        numerics = importlib.import_module("siconos.numerics")
    except ImportError:
        pytest.skip("siconos is not installed")
    size, soft = np.abs(free).max(), np.diagonal(compliance).mean()
    matrix = np.asfortranarray(compliance / soft)
    problem = numerics.FrictionContactProblem(2, matrix, free / size, friction)
    options = numerics.SolverOptions(numerics.SICONOS_FRICTION_2D_LEMKE)
    force, move = np.zeros_like(free), np.zeros_like(free)
    assert numerics.fc2d_driver(problem, force, move, options) == 0
    return force * size / soft


def read(path):
    """Read W, q, mu and what stands under a solution, with no other knowledge than the layout."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path) as file:
        group = file["fclib_local"]
        own = {name: group[f"W/{name}"][()] for name in ("nzmax", "m", "n", "nz", "p", "i", "x")}
        assert own["nz"] == -1
        assert group["spacedim"][()] == 2
        assert own["nzmax"][0] == len(own["x"]) == own["p"][-1]
        shape = own["m"][0], own["n"][0]
        matrix = sparse.csc_array((own["x"], own["i"], own["p"]), shape=shape).toarray()
        vectors = group["vectors/q"][()], group["vectors/mu"][()]
        solution = {name: one[()] for name, one in file.get("solution", {}).items()}
        words = {name: one[()] for name, one in group["info"].items()}
        kinds = {group[name].dtype for name in ("spacedim", "W/p", "W/i", "W/nz")}
    assert kinds == {np.dtype(np.int32)}
    return matrix, *vectors, solution, words


@pytest.mark.parametrize("solve", [gauss_seidel, siconos])
@pytest.mark.parametrize("scene", SMALL)
def test_a_solver_of_the_file_alone_finds_the_reactions_of_the_reference(scene, solve, tmp_path):
    problem = problem_of(scene)
    reference, contacts = reference_of(problem), contacts_of(problem)
    for instant in INSTANTS:
        local = local_problem(contacts, reference, instant, scene, certified=True)
        pytest.importorskip("h5py")
        path = tmp_path / f"{instant}.hdf5"
        with path.open("wb") as file:
            write_fclib(file, local)
        compliance, free, friction, solution, words = read(path)
        force = solve(compliance, free, friction) if free.any() else np.zeros_like(free)
        wanted = reference.contact_force[contacts.places, instant]
        assert np.linalg.norm(force - wanted) <= 1e-8 * np.linalg.norm(wanted)
        np.testing.assert_array_equal(solution["r"], wanted)
        assert f"t = {problem.instants[instant]:.6g} s".encode() in words["title"]


@pytest.mark.parametrize(
    ("scene", "changes", "points"),
    [
        ("block", {}, 17),
        ("layers", {}, 10),
        # The corner's opening is free, its slip prescribed: W has a row of zeros.
        ("block", {"left": "roller"}, 17),
        # The corner is held: it shares its force with what holds it, and is left out.
        ("block", {"left": "clamped"}, 16),
    ],
    ids=str,
)
def test_the_solution_in_it_obeys_signorini_and_coulomb(scene, changes, points):
    problem = problem_of(scene, **changes)
    reference, contacts = reference_of(problem), contacts_of(problem)
    assert len(contacts.friction) == points
    for instant in INSTANTS:
        local = local_problem(contacts, reference, instant, scene, certified=True)
        opening, slip = local.move[::2], local.move[1::2]
        pressing, along = local.force[::2], local.force[1::2]
        far = 1e-9 * max(np.abs(local.free).max(), 1e-300)
        large = 1e-9 * max(np.abs(local.force).max(), 1e-300)
        assert opening.min() >= -far
        assert pressing.min() >= -large
        assert np.abs(opening * pressing).max() <= far * np.abs(local.force).max()
        bound = local.friction * pressing
        assert np.all(np.abs(along) <= bound + large)
        against = np.abs(along * slip + bound * np.abs(slip))
        assert against.max() <= 1e-9 * np.abs(local.force).max() * np.abs(local.free).max()


@pytest.mark.parametrize("scene", SMALL)
def test_its_compliance_is_the_inverse_of_what_the_reference_condenses(scene):
    problem = problem_of(scene)
    contacts, condensed = contacts_of(problem), Condensation(problem)
    assert len(condensed.base) == len(condensed.moving)
    place = np.full(len(condensed.compliance), -1)
    place[condensed.moving] = np.arange(len(condensed.moving))
    own = place[contacts.places]
    stiffness = condensed.stiffness[np.ix_(own, own)]
    np.testing.assert_allclose(stiffness @ contacts.compliance, np.eye(len(own)), atol=1e-8)


@pytest.mark.parametrize(
    ("scene", "changes", "why"),
    [
        ("bar", {}, "bound that is known beforehand"),
        ("strand", {}, "bound that is known beforehand"),
        ("incline", {}, "is a spring"),
        ("block", {"friction_law": "compliant"}, "gives way"),
        ("block", {"friction_law": "slip-dependent"}, "changes with slip"),
    ],
    ids=str,
)
def test_what_fclib_cannot_say_is_refused_with_its_reason(scene, changes, why):
    with pytest.raises(RefusedError, match=why):
        contacts_of(problem_of(scene, **changes))


def test_a_body_that_contact_alone_holds_has_no_compliance():
    problem = problem_of("block", top="traction")
    with pytest.raises(RefusedError, match=r"contact alone holds.*hold a side"):
        contacts_of(problem)


def test_a_problem_that_is_too_large_is_refused(monkeypatch):
    monkeypatch.setattr(fclib, "MOST", 10)
    with pytest.raises(RefusedError, match=r"34 components.*at most 10"):
        contacts_of(problem_of("block"))


def test_the_command_writes_the_instant_that_is_nearest(tmp_path, capsys):
    pytest.importorskip("h5py")
    path = tmp_path / "one.hdf5"
    sizes = [f"--set={name}={json.dumps(value)}" for name, value in SMALL["block"].items()]
    assert main(["fclib", "block", *sizes, "--out", str(path), "--instant", "0.31"]) == 0
    assert "t = 0.296875 s, 17 points" in capsys.readouterr().out
    compliance, free, friction, solution, _ = read(path)
    assert set(solution) == {"u", "r"}
    force = gauss_seidel(compliance, free, friction)
    assert np.linalg.norm(force - solution["r"]) <= 1e-8 * np.linalg.norm(force)


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (["--instant", "7"], "--instant = 7.0 is refused"),
        (["--instant", "nan"], "a time from 0 to 1 s"),
        (["--out", "/no/such/folder/one.hdf5"], "No such file or directory"),
    ],
)
def test_the_command_refuses_in_words_before_it_runs(options, why, tmp_path, capsys):
    pytest.importorskip("h5py")
    out = ["--out", str(tmp_path / "one.hdf5")]
    assert main(["fclib", "block", *out, *options]) == 2
    assert why in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_without_h5py_it_says_what_to_install(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(fclib, "find_spec", lambda name: None)
    assert main(["fclib", "block", "--out", str(tmp_path / "one.hdf5")]) == 2
    assert "slipfront[peers]" in capsys.readouterr().err


def test_a_run_that_is_not_certified_claims_no_solution():
    problem = problem_of("block")
    reference = replace(reference_of(problem))
    local = local_problem(contacts_of(problem), reference, 5, "block", certified=False)
    assert local.move is None
    assert local.force is None
