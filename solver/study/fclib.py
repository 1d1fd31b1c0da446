"""One instant of a run as a local contact problem in the public FCLIB format.

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

import math
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from typing import IO

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU

from solver.arrays import Array, Indices
from solver.definitions import SettingError
from solver.discrete.problem import Problem
from solver.latin import Iterate
from solver.reference.assembly import assembled_stiffness, external_force, jumps
from solver.reference.condensation import NotHeldError, factored
from solver.reference.rules import rules_of
from solver.refusal import RefusedError

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
    free
        Where displacements are not prescribed, shape (n_free,).
    stiffness
        Rows of the stiffness without contacts there, shape (n_free, n_dofs).
    factor
        Of its columns there.
    """

    problem: Problem
    places: Indices
    friction: Array
    jumps: sparse.csr_array
    compliance: Array
    free: Indices
    stiffness: sparse.csc_array
    factor: SuperLU


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
    own = jumps(problem)[places]
    free = np.setdiff1d(np.arange(problem.n_dofs), problem.prescribed[0])
    stiffness = sparse.csc_array(assembled_stiffness(problem)[free])
    try:
        factor = factored(stiffness[:, free])
    except NotHeldError:
        remedy = "hold a side of every body"
        raise _no_problem("contact alone holds one of its bodies", remedy) from None
    moving = own[:, free]
    whole = moving @ factor.solve(moving.T.toarray())
    compliance = 0.5 * (whole + whole.T)
    return Contacts(problem, places, friction, own, compliance, free, stiffness, factor)


def local_problem(
    contacts: Contacts, iterate: Iterate, instant: int, scene: str, *, certified: bool
) -> dict[str, Array | bytes | int]:
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

    Returns
    -------
    What a file holds, by name as `src/fclib.h` lays it out, SI: W by columns (nz = -1), m/N.
    """
    problem, places, own = contacts.problem, contacts.places, contacts.jumps
    size = problem.scales.displacement
    compliance = contacts.compliance * (size / problem.scales.force)
    free = _free(contacts, instant) * size
    free[::2] += rules_of(problem).gap[places[::2]] * size
    if instant:
        free[1::2] -= (own @ iterate.displacement[:, instant - 1])[1::2]
    matrix = sparse.csc_array(compliance)
    title = f"Slipfront, {scene}, t = {float(problem.instants[instant]):.6g} s"
    description = (
        f"Instant {instant + 1} of {problem.n_instants} of a quasi-static run. u_N: opening at its "
        "end, u_T: slip in it (m); r: nodal forces at its end (N), for a metre of thickness"
    )
    values = {
        "spacedim": SPACEDIM,
        **{"W/nzmax": matrix.nnz, "W/m": len(free), "W/n": len(free), "W/nz": -1},
        "W/p": matrix.indptr.astype(np.int32),
        "W/i": matrix.indices.astype(np.int32),
        "W/x": matrix.data,
        "vectors/q": free,
        "vectors/mu": contacts.friction,
        # As C has it, with a zero at its end.
        "info/title": title.encode("ascii", "replace") + b"\0",
        "info/description": description.encode("ascii", "replace") + b"\0",
    }
    local = {f"fclib_local/{name}": value for name, value in values.items()}
    if certified:
        force = iterate.contact_force[places, instant]
        local |= {"solution/u": compliance @ force + free, "solution/r": force}
    return local


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


def write_fclib(file: IO[bytes], local: Mapping[str, Array | bytes | int]) -> None:
    """Write a local problem as HDF5, whole numbers as arrays of one."""
    import h5py  # an extra

    with h5py.File(file, "w") as whole:
        for name, value in local.items():
            if isinstance(value, bytes):
                whole[name] = np.array(value, dtype=f"S{len(value)}")
            else:
                whole[name] = np.array([value], np.int32) if isinstance(value, int) else value


def _points(problem: Problem) -> tuple[Indices, Array]:
    """The places of all points' components, normal and tangential in turn, and their mu.

    A point whose opening is prescribed is left out: it shares its force with what holds it.
    """
    rules, own = rules_of(problem), jumps(problem)
    opening = [law for law in problem.rubbing.values() if law.opens]
    if len(opening) < len(problem.rubbing):
        raise _no_problem(
            "its friction has a bound that is known beforehand", "take a scene in the plane"
        )
    if rules.compliance.any():
        raise _no_problem("its contact gives way, or is a spring", "set friction_law=coulomb")
    if rules.ages:
        raise _no_problem("its friction changes with slip", "set friction_law=coulomb")
    if not rules.is_linear:
        raise _no_problem("its friction has a cohesion or a cap", "set friction_law=coulomb")
    if len(rules.gap) > MOST:
        raise _no_problem(
            f"it has {len(rules.gap)} components of contact", f"take fewer elements: at most {MOST}"
        )
    pairs = np.concatenate(
        [
            np.stack([np.arange(part.start, part.stop) for part in places], axis=1)
            for places in problem.contact_places.values()
        ]
    )
    free = np.ones(problem.n_dofs)
    free[problem.prescribed[0]] = 0.0
    pairs = pairs[(abs(own) @ free > 0.0)[pairs[:, 0]]]
    return pairs.ravel(), rules.friction[pairs[:, 1]]


def _no_problem(reason: str, remedy: str) -> RefusedError:
    return RefusedError("FCLIB", reason, CAN, remedy)


def _free(contacts: Contacts, instant: int) -> Array:
    """The jumps at an instant without contact forces, shape (2 n_points,), scaled."""
    problem, own, free = contacts.problem, contacts.jumps, contacts.free
    fixed, prescribed = problem.prescribed[0], problem.prescribed[1][:, instant]
    load = external_force(problem)[free, instant] - contacts.stiffness[:, fixed] @ prescribed
    return np.asarray(own[:, free] @ contacts.factor.solve(load) + own[:, fixed] @ prescribed)
