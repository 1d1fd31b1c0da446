"""Rigid motions of all bodies in the local stage: a coarse problem with contact.

Where hinges are free next to nothing resists the motions of bodies, and E+ alone holds
them: an iteration moves a body by about (unbalanced force over k), which is thousands
of times less than the way that it has to go. So k is taken as zero along all rigid
motions: at every instant the local stage shifts the bodies to where contacts, with all
that opens and slips there, and springs of k balance the loads on each body
(`solver.latin.stages.rigid_balance`; MATHEMATICS.md, 2). A shift costs no elastic
force, so that the linear stage does not see it. What remains is the same iteration for
the deformation of each body, whatever the hinges.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from solver.arrays import Array, largest_size, ones_at, sparse_factor
from solver.discrete.problem import Problem
from solver.latin.stages.rigid_balance import Balance
from solver.latin.stages.rigid_forces import Loading, RigidForces
from solver.latin.stages.rigid_stiffness import RigidContacts
from solver.laws import Contact, Unilateral
from solver.laws.interface import Component, Springs

FAR = 100.0
"""Largest displacement of a side, over that of a body of stiffness E under all loads,
from which bodies that contact alone holds are shifted. Nine arches, round and pointed,
of 31 and 61 voussoirs, take as much time in sum with shifts as without between 90 and
130 of these, in 8 to 15 iterations instead of 22 to more than 100 (measured)."""
LOST = 1e-3
"""Unbalanced force, over the largest load of a body, from which bodies stay where they
are, at this instant and at those after it, which depend on it."""
PATIENCE = 10
"""Successive iterations with such an instant after which bodies are shifted no more. An
arch of 61 voussoirs moved by 20 mm has 2 in the first three (measured)."""


def moves_rigidly(problem: Problem) -> bool:
    """Check whether prescribed motions of a chain of bodies open free hinges.

    A law of contact may do no more than open, slip and be compliant. Bricks of a wall,
    which touch more than two others, seldom find a balance as rigid bodies where
    friction alone holds them, and take minutes to seek it (measured).
    """
    inside = problem.inside
    if inside is None or problem.user_laws or not problem.contacts:
        return False
    if not _moves_far(problem) or problem.rigid_motions is None:
        return False
    if len(problem.contacts) >= len(np.unique(inside.body_of_dofs)):
        return False
    return all(_is_plain(law) for law in problem.contacts.laws.values())


def _moves_far(problem: Problem) -> bool:
    """Check whether sides move much further than loads deform bodies."""
    moved = largest_size(problem.prescribed[1])
    load = largest_size(_load_sizes(problem).sum(axis=0))
    # Without any load the motion itself makes all forces.
    return 0.0 < FAR * load < moved


def _load_sizes(problem: Problem) -> Array:
    """Sums of the sizes of the forces of each load, (n_loads, n_instants), scaled."""
    sizes = [np.zeros(problem.n_instants)]
    for given in problem.prescribed_forces:
        sizes.append(np.abs(given.values).sum(axis=0))
    for part in problem.substructures:
        if part.body_force is not None:
            sizes.append(np.abs(part.body_force).sum(axis=0))
    return np.array(sizes)


def _is_plain(law: Contact) -> bool:
    """Check whether a contact opens, and slips at mu times the pressing force."""
    friction = law.tangential
    if law.normal is None or law.incremental_form() is None:
        return False
    if friction.cap is not None or friction.slip_factor is not None:
        return False
    return not friction.bound.any()


class RigidBodies:
    """Shifts of all bodies to positions of balanced forces in the local stage.

    Parameters
    ----------
    problem
        The problem to be solved, of bodies in the plane.
    k
        Search direction of the rows, shape (n_rows,), scaled.
    from_rest
        Whether the iteration begins here, so that bodies are not near their places.

    Attributes
    ----------
    motion
        None: residuals along shifts count, as they are errors of positions.
    """

    motion: Array | None = None

    def __init__(self, problem: Problem, k: Array, *, from_rest: bool) -> None:
        self._modes, self._centres, body_load = _motions(problem, k)
        laws = [law for law in problem.laws if isinstance(law, Contact)]
        self._jumps = _jumps(laws, problem.n_rows)
        self._sliders = np.concatenate([_start(law) for law in laws])
        body_load += self._modes.T @ _prescribed_forces(problem)
        extension, stiffness, load = _springs(problem, k)
        stretched = sparse.csr_array(extension @ self._modes)
        pulled = stretched.T @ sparse.diags_array(stiffness)
        self._held = sparse.csr_array(pulled @ extension)
        self._load = body_load + self._modes.T @ load
        contacts = RigidContacts(
            jumps=sparse.csr_array(self._jumps @ self._modes),
            compliance=_compliance(laws, k),
            gap=np.concatenate([_normal(law).gap for law in laws]),
            friction=np.concatenate([law.tangential.friction for law in laws]),
        )
        holding = np.asarray((self._modes * self._modes).T @ k)
        self._forces = RigidForces(
            contacts,
            sparse.csr_array(pulled @ stretched),
            holding,
            load_size=largest_size(_load_sizes(problem)),
            start=self._sliders,
            n_instants=problem.n_instants,
        )
        self._balance = Balance(self._forces, largest_size(problem.prescribed[1]))
        self._is_near = not from_rest
        self._times_lost = 0

    def balanced(self, incoming: Array) -> Array:
        """Shift z = W - F/k of all rows, instant by instant.

        Both z have shape (n_rows, n_instants), scaled. Where bodies find no balance
        again and again, they are not shifted.
        """
        if self._times_lost >= PATIENCE:
            return incoming
        loading = Loading(self._jumps @ incoming, self._load - self._held @ incoming)
        shifts = np.zeros_like(loading.load)
        first = 0
        if self._is_near:
            state = self._balance.solve_together(loading)
            is_wrong = ~(state.error <= self._balance.enough)
            first = len(is_wrong)
            if is_wrong.any():
                first = int(np.argmax(is_wrong))
            shifts[:, :first] = state.position[:, :first]
        is_lost = self._walk(loading, self._centres @ incoming, shifts, first)
        self._is_near = True
        self._count(is_lost=is_lost)
        shifted: Array = np.asfortranarray(self._modes @ shifts)
        shifted += incoming
        return shifted

    def _walk(
        self, loading: Loading, centres: Array, shifts: Array, first: int
    ) -> bool:
        """Shift bodies instant by instant; return whether some instant has no balance.

        Parameters
        ----------
        loading
            Loading of all instants.
        centres
            Mean motions of the bodies without shifts, shape (n_motions, n_instants),
            scaled.
        shifts
            Shifts, same shape, which are found in place from the instant `first` on.
        first
            Number of the first instant; one beyond the last finds nothing.
        """
        n_instants = centres.shape[1]
        if first == n_instants:
            return False
        sliders = self._sliders[:, None]
        before = np.zeros((len(centres), 1))
        if first > 0:
            last = slice(first - 1, first)
            sliders = self._forces.at(shifts, loading).sliders[:, last]
            before = centres[:, last] + shifts[:, last]
        is_lost = False
        for instant in range(first, n_instants):
            here = slice(instant, instant + 1)
            centre = centres[:, here]
            stay = before - centre
            if self._is_near:
                stay = np.zeros_like(centre)
            state = None
            if not is_lost:
                guesses = self._guesses(shifts, instant)
                state = self._balance.solve_instant(
                    loading.part(here),
                    sliders,
                    guesses,
                    before - centre,
                    _instant_before(loading, shifts, instant),
                )
                is_lost = not state.error <= LOST
            if state is None or is_lost:
                state = self._forces.at(stay, loading.part(here), sliders)
            sliders = state.sliders
            shifts[:, here] = state.position
            before = centre + state.position
        return is_lost

    def _guesses(self, shifts: Array, instant: int) -> list[Array]:
        """Guesses of the shifts of an instant, (n_motions, 1) each.

        Those before it, (n_motions, n_instants), continue as they did: from rest an
        arch of 31 voussoirs takes a fifth of the time so (measured).
        """
        guesses = []
        if self._is_near:
            guesses.append(np.zeros((len(shifts), 1)))
        if instant > 1:
            last = shifts[:, instant - 1 : instant]
            guesses.append(2.0 * last - shifts[:, instant - 2 : instant - 1])
        return guesses

    def _count(self, *, is_lost: bool) -> None:
        """Count successive iterations in which some instant had no balance."""
        if is_lost:
            self._times_lost += 1
        else:
            self._times_lost = 0


def _instant_before(
    loading: Loading, shifts: Array, instant: int
) -> tuple[Loading, Array] | None:
    """Loading and shifts, (n_motions, 1), before an instant; None before the first."""
    if instant == 0:
        return None
    before = slice(instant - 1, instant)
    return loading.part(before), shifts[:, before]


def _motions(
    problem: Problem, k: Array
) -> tuple[sparse.csr_array, sparse.csr_array, Array]:
    """Rigid motions of all bodies, with their jumps and forces.

    Returned are the motions of rows, shape (n_rows, n_motions); the map from a field of
    rows to its mean motions, weighted by k, (n_motions, n_rows); and the body forces
    along the motions, (n_motions, n_instants), scaled.
    """
    inside = problem.inside
    assert inside is not None
    bodies = inside.body_of_dofs
    by_dofs = sparse.lil_array((problem.n_dofs, 3 * (int(bodies.max()) + 1)))
    for body in np.unique(bodies):
        dofs = np.flatnonzero(bodies == body)
        by_dofs[dofs, 3 * body : 3 * body + 3] = inside.rigid_modes(dofs)
    of_dofs = sparse.csr_array(by_dofs)
    of_rows = of_dofs[problem.row_dofs]
    load = np.zeros((of_dofs.shape[1], problem.n_instants))
    for part in problem.substructures:
        if part.body_force is not None:
            load += of_dofs[part.dofs].T @ part.body_force
    weighted = sparse.csr_array((of_rows * k[:, None]).T)
    products = sparse_factor(sparse.csc_array(weighted @ of_rows))
    means = sparse.csr_array(products.solve(weighted.toarray()))
    return of_rows, means, load


def _normal(law: Contact) -> Unilateral:
    """Normal law of a contact that may open."""
    assert law.normal is not None
    return law.normal


def _jumps(laws: list[Contact], n_rows: int) -> sparse.csr_array:
    """Jumps across all pairs of all contacts, then along them: (2 n_pairs, n_rows)."""
    across = [_difference(_normal(law).component, n_rows) for law in laws]
    along = [_difference(law.tangent, n_rows) for law in laws]
    return sparse.csr_array(sparse.vstack(across + along))


def _difference(component: Component, n_rows: int) -> sparse.csr_array:
    """Jump of a component from fields of rows, shape (n_pairs, n_rows)."""
    pairs = np.arange(len(component.above))
    shape = len(pairs), n_rows
    above = ones_at(pairs, component.above, shape)
    if component.below is None:
        return above
    return above - ones_at(pairs, component.below, shape)


def _compliance(laws: list[Contact], k: Array) -> Array:
    """Compliance of k and of springs of the laws, (2 n_pairs,), stacked as `_jumps`."""
    across = []
    along = []
    for law in laws:
        normal = _normal(law)
        across.append(_in_series(normal.component, k, normal.compliance))
        along.append(_in_series(law.tangent, k, law.tangential.compliance))
    return np.concatenate(across + along)


def _in_series(component: Component, k: Array, compliance: Array | None) -> Array:
    """Compliance of k of both sides, and of a spring, (n_pairs,) or None."""
    soft = Springs(component, k).soft[:, 0]
    if compliance is None:
        return soft
    return soft + compliance


def _start(law: Contact) -> Array:
    """Positions of sliders before the first instant, (n_pairs,), scaled."""
    start = law.tangential.start
    if start is None:
        return np.zeros(len(law.points))
    return start


def _springs(problem: Problem, k: Array) -> tuple[sparse.csr_array, Array, Array]:
    """Springs of k where rows are held or glued.

    Returned are their extension by fields of rows, (n_springs, n_rows), their
    stiffness, (n_springs,), and their forces on rows that do not move, (n_rows,
    n_instants), scaled.
    """
    extensions = [sparse.csr_array((0, problem.n_rows))]
    stiffnesses = [np.zeros(0)]
    load = np.zeros((problem.n_rows, problem.n_instants))
    for held in problem.prescribed_displacements:
        stiffness = k[held.rows]
        load[held.rows] = stiffness[:, None] * held.values
        extensions.append(_difference(Component(held.rows), problem.n_rows))
        stiffnesses.append(stiffness)
    for cut in problem.cuts:
        both = Component(cut.first, cut.second)
        extensions.append(_difference(both, problem.n_rows))
        stiffnesses.append(1.0 / Springs(both, k).soft[:, 0])
    springs = sparse.csr_array(sparse.vstack(extensions))
    return springs, np.concatenate(stiffnesses), load


def _prescribed_forces(problem: Problem) -> Array:
    """Forces that are prescribed at rows, shape (n_rows, n_instants), scaled."""
    force = np.zeros((problem.n_rows, problem.n_instants))
    for given in problem.prescribed_forces:
        force[given.rows] = given.values
    return force
