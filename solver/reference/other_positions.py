"""Other positions of bodies in equilibrium under the same contact forces.

Bodies that contact alone holds may move as rigid ones, which costs no elastic force, so
that the same contact forces balance the loads. These obey all laws there, too, if
contacts that press stay closed, those that stick stay where they are, those that slip
have slipped the same way, and no others overlap. Hinges that turn freely move so, a
body that slides on friction all along, or one that nothing presses. A motion with room
proves that a solution is one of several with the same history.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, Flags
from solver.discrete.problem import Problem
from solver.reference.assembly import jumps
from solver.reference.distance import VANISHING, are_independent
from solver.reference.rules import Rules, rules_of

FREE = 1e-10
"""Jumps of a motion, or singular value, over the largest, up to which they are none:
rounding leaves 1e-15."""
MOST_MOTIONS = 400
"""Rigid motions of all bodies up to which an instant takes some tenths of a second."""
FELT = 1e-6
"""Motion, over the largest displacement, from which on positions are others."""
INSIDE = 0.5
"""Share of its room that a body is moved by, so that it touches nothing."""


def other_positions(
    problem: Problem, displacement: Array, force: Array
) -> dict[int, Array]:
    """Displacement of another solution at some instants of a known one, (n_dofs,), m.

    Both are equal up to the instant before. No other solution is sought where slip
    changes friction, contacts are compliant or were bonded, or bodies are too many.
    Until contacts first carry a force bodies are at rest.

    Parameters
    ----------
    problem
        The problem.
    displacement
        Displacement of a solution, shape (n_dofs, n_instants), m.
    force
        Its contact forces, stacked, shape (n_forces, n_instants), N.
    """
    motions = problem.rigid_motions
    if motions is None or motions.shape[1] > MOST_MOTIONS:
        return {}
    rules = rules_of(problem)
    if rules.changes_with_slip or rules.compliance.any() or len(rules.bonds):
        return {}
    all_jumps = jumps(problem)
    moved = all_jumps @ motions
    scale = problem.scales.displacement
    hinders, room = _contacts(
        rules, all_jumps @ displacement / scale, force / problem.scales.force
    )
    has_acted = np.logical_or.accumulate(force.any(axis=0))
    # Mostly what hinders motions at all instants hinders all motions already.
    if are_independent(moved[hinders[:, has_acted].all(axis=1)]):
        return {}
    largest = float(np.abs(displacement).max(initial=0.0)) / scale
    # Few patterns of contact occur, each at many instants.
    known = dict[bytes, Array]()
    found = dict[int, Array]()
    for instant in np.flatnonzero(has_acted).tolist():
        pattern = hinders[:, instant]
        key = pattern.tobytes()
        if key not in known:
            known[key] = motions @ _free_motions(moved[pattern])
        way = _free_direction(
            known[key], all_jumps @ known[key], room[..., instant], largest
        )
        if way is not None:
            found[instant] = displacement[:, instant] + scale * way
    return found


def _free_direction(
    free: Array, jumped: Array, room: Array, largest: float
) -> Array | None:
    """First free motion that contacts allow, scaled, (n_dofs,); None without any.

    Parameters
    ----------
    free, jumped
        The motions, shape (n_dofs, n_free), and the jumps that they make, (n, n_free).
    room
        How far jumps may go down and up, scaled, shape (2, n).
    largest
        Largest displacement, scaled, beyond which no body is moved.
    """
    for motion, jump in zip(free.T, jumped.T, strict=True):
        longest = largest / float(np.abs(motion).max())
        length = INSIDE * min(_longest_step(jump, room), longest, key=abs)
        if abs(length) > FELT * longest:
            return np.asarray(length * motion)
    return None


def _contacts(rules: Rules, jumped: Array, force: Array) -> tuple[Flags, Array]:
    """Jumps that hinder motions, (n, n_instants), and the gaps that limit jumps.

    Jumps and forces are scaled, (n, n_instants). The room, (2, n, n_instants), is how
    far a jump may go down and up; motions that nothing hinders leave the others alone.
    """
    small = VANISHING * np.abs(force).max(initial=0.0)
    normal = rules.normal[:, None]
    pressing = np.where(normal & (force > small), force, 0.0)
    bound = rules.bounds(pressing, np.zeros_like(force))
    rubs = ~normal & (bound > small)
    slip = np.diff(jumped, axis=1, prepend=0.0)
    # Friction that is used up leaves slip against it free, and back to where it began.
    slips = rubs & (np.abs(force) >= (1.0 - VANISHING) * bound)
    opening = jumped + rules.gap[:, None]
    goes_down = slips & (force > 0.0)
    down = np.where(normal, opening, np.where(slips & (force < 0.0), slip, np.inf))
    up = np.where(goes_down, -slip, np.inf)
    return (pressing > 0.0) | (rubs & ~slips), np.maximum([down, up], 0.0)


def _free_motions(moved: Array) -> Array:
    """Basis of motions without some jumps, (n_motions, n_free).

    `moved` are the jumps that motions make, (n, n_motions).
    """
    if are_independent(moved):
        return np.zeros((moved.shape[1], 0))
    _, sizes, ways = np.linalg.svd(moved, full_matrices=True)
    count = int(np.count_nonzero(sizes > FREE * sizes.max(initial=0.0)))
    return np.asarray(ways[count:].T)


def _longest_step(jump: Array, room: Array) -> float:
    """Longest step along a motion that the gaps allow; negative if backwards.

    The motion makes a jump each, (n,); they have room down and up, (2, n).
    """
    moves = np.abs(jump) > FREE * np.abs(jump).max(initial=0.0)
    rate = np.abs(jump[moves])
    down, up = room[:, moves]
    falls = jump[moves] < 0.0
    forth = (np.where(falls, down, up) / rate).min(initial=np.inf)
    back = (np.where(falls, up, down) / rate).min(initial=np.inf)
    if back > forth:
        return -float(back)
    return float(forth)
