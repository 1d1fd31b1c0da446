"""One instant of a run as a local contact problem in the public FCLIB format, and its command.

FCLIB is a collection of frictional contact problems, and the layout of their HDF5 files, which
siconos among others reads: V. Acary, M. Brémond, T. Koziara, F. Pérignon, "FCLIB: a collection of
discrete 3D frictional contact problems", INRIA RT-444, 2014; layout and mathematics as in
`src/fclib.h` of https://github.com/FrictionalContactLibrary/fclib. It seeks u and r with

    u = W r + q,    0 <= u_N  perpendicular to  r_N >= 0,    |r_T| <= mu r_N, against u_T.

Contact points come one after the other, each with its normal and then its tangential component.
FCLIB's u is a velocity, or for quasi-static problems, as here, a displacement: u_N is the opening
at the end of the instant, and u_T the slip in it, m; r are the nodal forces at its end, N, for a
metre of thickness. So W = J K^-1 J' is in m/N, with the jumps J of the contacts and the stiffness K
of the structure without them, and q is what opening and slip would be without contact forces. What
slipped before the instant is in q.
"""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU

from solver.arrays import Array, Indices
from solver.definitions import SettingError
from solver.discrete.problem import Problem
from solver.disk import check_place, whole_file, why
from solver.files import settings_from_command
from solver.latin import Ending, Iterate, solve
from solver.reference.assembly import assembled_stiffness, external_force
from solver.reference.condensation import NotHeldError, factored
from solver.reference.glued import jumps
from solver.reference.rules import rules_of
from solver.refusal import RefusedError
from solver.remarks import prepared
from solver.scenes.method import method_of

SPACEDIM = 2
MOST = 4000
"""Components of contact at most: their W, which is full, takes 190 MB on disk."""
CAN = "a problem in the plane with unilateral contact and Coulomb's friction"


@dataclass(frozen=True, eq=False)
class Contacts:
    """The contacts of a problem as local problems of all its instants have them, scaled.

    Attributes
    ----------
    problem
        What they are of.
    places
        Where their components stand in a stack of contact forces, normal and tangential in turn,
        shape (2 n_points,).
    friction
        Coefficient mu of every point, shape (n_points,).
    jumps
        J at these places, shape (2 n_points, n_dofs).
    compliance
        W, shape (2 n_points, 2 n_points).
    factor
        Of the stiffness without contacts, where displacements are not prescribed.
    """

    problem: Problem
    places: Indices
    friction: Array
    jumps: sparse.csr_array
    compliance: Array
    factor: SuperLU


@dataclass(frozen=True, eq=False)
class LocalProblem:
    """A local contact problem in the plane, in SI.

    Attributes
    ----------
    compliance
        W, shape (2 n_points, 2 n_points), m/N.
    free
        q, shape (2 n_points,), m.
    friction
        Coefficient mu of every point, shape (n_points,).
    move, force
        u and r as the run has them, shape (2 n_points,), m and N; None unless it is certified.
    title, description
        What it is, in words.
    """

    compliance: Array
    free: Array
    friction: Array
    move: Array | None
    force: Array | None
    title: str
    description: str


def can_write() -> bool:
    """Whether there is what writes HDF5: the extra `peers`."""
    return find_spec("h5py") is not None


def contacts_of(problem: Problem) -> Contacts:
    """Condense a structure onto its contacts.

    Raises
    ------
    RefusedError
        If no local problem says what this one does: known bounds, contact that gives way, friction
        that changes with slip, bodies that contact alone holds; or if it is too large.
    """
    places, friction = _points(problem)
    own, (free, stiffness) = jumps(problem)[places], _without_contacts(problem)
    try:
        factor = factored(stiffness[:, free])
    except NotHeldError:
        remedy = "hold a side of every body"
        raise _no_problem("contact alone holds one of its bodies", remedy) from None
    moving = own[:, free]
    whole = moving @ factor.solve(moving.T.toarray())
    return Contacts(problem, places, friction, own, 0.5 * (whole + whole.T), factor)


def local_problem(
    contacts: Contacts, iterate: Iterate, instant: int, scene: str, *, certified: bool
) -> LocalProblem:
    """The contact problem of one instant, from where the instant before has left the contacts.

    Parameters
    ----------
    contacts
        Those of the problem of the run.
    iterate
        Its displacement at the instant before says how far contacts have slipped.
    instant
        Number of the instant, from 0; before the first nothing has moved.
    scene
        What the structure is called.
    certified
        Whether its forces are the solution, which then stands beside the problem.
    """
    problem, places, own = contacts.problem, contacts.places, contacts.jumps
    size, force_size = problem.scales.displacement, problem.scales.force
    compliance = contacts.compliance * (size / force_size)
    free = _free(contacts, instant) * size
    free[::2] += rules_of(problem).gap[places[::2]] * size
    if instant:
        free[1::2] -= (own @ iterate.displacement[:, instant - 1])[1::2]
    force = iterate.contact_force[places, instant]
    return LocalProblem(
        compliance=compliance,
        free=free,
        friction=contacts.friction,
        move=compliance @ force + free if certified else None,
        force=force if certified else None,
        title=f"Slipfront, {scene}, t = {float(problem.instants[instant]):.6g} s",
        description=(
            f"Instant {instant + 1} of {problem.n_instants} of a quasi-static run. u_N: opening at "
            "its end, u_T: slip in it (m); r: nodal forces at its end (N), for a metre of thickness"
        ),
    )


def instant_at(time: float, instants: Array) -> int:
    """The number of the instant that is nearest to a time, s.

    Raises
    ------
    SettingError
        For a time outside of the run.
    """
    last = float(instants[-1])
    if not (math.isfinite(time) and 0.0 <= time <= last):
        raise SettingError("--instant", time, f"a time from 0 to {last:g} s", "choose one of these")
    return int(np.abs(instants - time).argmin())


def write_fclib(file: IO[bytes], local: LocalProblem) -> None:
    """Write HDF5 as `src/fclib.h` lays it out: numbers as arrays of one, W by columns (nz = -1)."""
    import h5py  # an extra

    matrix = sparse.csc_array(local.compliance)
    sizes = {"nzmax": matrix.nnz, "m": matrix.shape[0], "n": matrix.shape[1], "nz": -1}
    arrays: dict[str, Any] = {"spacedim": np.array([SPACEDIM], np.int32)}
    arrays |= {f"W/{name}": np.array([size], np.int32) for name, size in sizes.items()}
    arrays |= {"W/p": matrix.indptr.astype(np.int32), "W/i": matrix.indices.astype(np.int32)}
    arrays |= {"W/x": matrix.data, "vectors/q": local.free, "vectors/mu": local.friction}
    for name in ("title", "description"):
        text = getattr(local, name).encode("ascii", "replace")
        # As C has it, with a zero at its end.
        arrays[f"info/{name}"] = np.array(text, dtype=f"S{len(text) + 1}")
    with h5py.File(file, "w") as whole:
        for name, value in arrays.items():
            whole[f"fclib_local/{name}"] = value
        if local.move is not None and local.force is not None:
            whole["solution/u"], whole["solution/r"] = local.move, local.force


def _points(problem: Problem) -> tuple[Indices, Array]:
    """The places of all points' components, normal and tangential in turn, and their mu.

    A point whose opening is prescribed is left out: it shares its force with what holds it.
    """
    rules, own = rules_of(problem), jumps(problem)
    opening = [law for law in problem.rubbing.values() if law.opens]
    if len(opening) < len(problem.rubbing) or rules.bounded.any():
        raise _no_problem(
            "its friction has a bound that is known beforehand", "take a scene in the plane"
        )
    if rules.compliance.any():
        raise _no_problem("its contact gives way, or is a spring", "set friction_law=coulomb")
    if not rules.is_linear:
        raise _no_problem("its friction changes with slip", "set friction_law=coulomb")
    if len(rules.gap) > MOST:
        raise _no_problem(
            f"it has {len(rules.gap)} components of contact", f"take fewer elements: at most {MOST}"
        )
    pairs = np.concatenate(
        [
            np.stack([np.arange(one.start, one.stop) for one in places], axis=1)
            for places in problem.contact_places.values()
        ]
    )
    fixed, _ = problem.prescribed
    free = np.ones(problem.n_dofs)
    free[fixed] = 0.0
    pairs = pairs[(abs(own) @ free > 0.0)[pairs[:, 0]]]
    return pairs.ravel(), rules.friction[pairs[:, 1]]


def _no_problem(reason: str, remedy: str) -> RefusedError:
    return RefusedError("FCLIB", reason, CAN, remedy)


def _without_contacts(problem: Problem) -> tuple[Indices, sparse.csc_array]:
    """What no displacement is prescribed of, and its rows of the stiffness."""
    free = np.setdiff1d(np.arange(problem.n_dofs), problem.prescribed[0])
    return free, sparse.csc_array(assembled_stiffness(problem)[free])


def _free(contacts: Contacts, instant: int) -> Array:
    """The jumps at an instant without contact forces, shape (2 n_points,), scaled."""
    problem, own = contacts.problem, contacts.jumps
    free, stiffness = _without_contacts(problem)
    fixed, prescribed = problem.prescribed[0], problem.prescribed[1][:, instant]
    load = external_force(problem)[free, instant] - stiffness[:, fixed] @ prescribed
    return np.asarray(own[:, free] @ contacts.factor.solve(load) + own[:, fixed] @ prescribed)


def add_fclib(commands: Any) -> None:
    """Add the command."""
    parser = commands.add_parser("fclib", help="one instant as a contact problem for others")
    parser.add_argument("scene", help="a name of the catalogue, or a saved settings file (.toml)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FILE.hdf5", help="write it here"
    )
    parser.add_argument(
        "--instant", type=float, metavar="SECONDS", help="the nearest one; the last without"
    )
    parser.set_defaults(command=_fclib)


def _fclib(chosen: argparse.Namespace) -> int:
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    if not can_write():
        remedy = "install it: pip install 'slipfront[peers]'"
        raise RefusedError("FCLIB", "a file in HDF5", "where h5py is installed", remedy)
    try:
        check_place(chosen.out)
    except OSError as problem_there:
        raise _no_place(chosen.out, problem_there) from None
    problem = prepared(settings, chosen.changes, tables)
    instants = problem.instants
    time = float(instants[-1]) if chosen.instant is None else chosen.instant
    contacts, instant = contacts_of(problem), instant_at(time, instants)
    solution = solve(problem, method_of(settings))
    is_sure = solution.is_certified
    local = local_problem(contacts, solution.iterate, instant, settings.scene, certified=is_sure)
    try:
        with whole_file(chosen.out, "wb") as file:
            write_fclib(file, local)
    except OSError as problem_there:
        raise _no_place(chosen.out, problem_there) from None
    if not is_sure:
        print(
            "slipfront: the run is not certified: where contacts stood before is what it has "
            "found, and no solution stands in the file",
            file=sys.stderr,
        )
    print(f"t = {instants[instant]:.6g} s, {len(local.friction)} points: {chosen.out}")
    return 0 if solution.status.ending is Ending.CONVERGED else 1


def _no_place(path: Path, problem: OSError) -> SettingError:
    return SettingError(
        "--out", str(path), "a file in an existing folder that can be written", why(problem)
    )
