"""Branches of solutions of an instant: followed in parts, and left where they end.

A branch is the solution that continues the instant before while the load of the instant
grows. It ends where friction that softens lets the structure snap: then another
solution is sought beyond.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from solver.arrays import Array
from solver.reference.newton import Newton
from solver.reference.rules import InstantSolution, RightSides, Rules, States

FIRST_PART = 0.25
"""Share of the load of an instant that is tried first where it is followed in parts."""
SHORTEST_PART = 2.0**-12
"""Share of the load of an instant within which the solution is lost, where it jumps."""
SLIDES = 100
"""Largest number of slips up to the next solution, each with the friction that the slip
before has left."""
AT_REST = 1e-9
"""Change of slips, as a share of the largest, at which they have come to rest."""


def followed(
    newton_at: Callable[[float], Newton],
    at: InstantSolution,
    right_sides: tuple[RightSides, RightSides],
    known: list[States],
    shortest: float = SHORTEST_PART,
) -> tuple[InstantSolution, float]:
    """Follow a solution from some right-hand sides to others in steps.

    Parameters
    ----------
    newton_at
        Newton's method at a share of the change from one to the other.
    at
        Solution with the first right-hand sides.
    right_sides
        The right-hand sides at both ends.
    known
        States to try, shape (n,) each.
    shortest
        Length of a step, as a share, at which the solution is given up.

    Returns
    -------
    The last solution found, and at which share.
    """
    begin, end = right_sides
    # Parts grow while they succeed and shrink where they fail.
    share = 0.0
    length = FIRST_PART
    while share < 1.0:
        target = min(share + length, 1.0)
        part = begin.towards(end, target)
        following = newton_at(target).follow(at, part, at.guesses(known))
        if following is not None:
            at = following
            share = target
            length = 2.0 * length
        elif length > shortest:
            length *= 0.25
        else:
            break
    return at, share


def beyond(
    newton: Newton,
    rules: Rules,
    at: InstantSolution,
    right_sides: tuple[RightSides, RightSides],
    known: list[States],
) -> tuple[InstantSolution | None, bool]:
    """Seek a stable solution beyond the end of a branch.

    With the friction that slip so far has left the next slip is larger, and so on
    up to the nearest solution; Newton's method is tried once the same contacts slip
    again. Where the bound is known each slip lowers the energy (convex-concave
    procedure: Yuille, Rangarajan, Neural Comput. 15, 2003), so slips come to rest.
    They may come to rest where the structure is not stable, as on a ridge between
    two slopes: then the solution is left down one of them. The last resort is the
    solution with the friction that is left after any slip.

    Parameters
    ----------
    newton, rules
        Newton's method, and the rules of the jumps.
    at
        Solution with the first right-hand sides, where the branch ends.
    right_sides
        The right-hand sides at both ends.
    known
        States to try, shape (n,) each.

    Returns
    -------
    The solution, or None; and whether another one was met, which is not stable.
    """
    has_others = False
    begin, end = right_sides
    fallen = np.abs(at.slip)
    for number in range(SLIDES + 1):
        is_last = number == SLIDES
        before = at
        falls = np.abs(at.slip)
        # The last resort: friction as after any slip.
        if is_last:
            falls = np.full_like(falls, rules.slip_factor.slips[-1])
        slid = _slid(newton, at, (begin, end), (fallen, falls), known)
        if slid is None:
            return None, has_others
        at = slid
        begin = end
        fallen = falls
        if not is_last and not np.array_equal(at.states, before.states):
            continue
        near = newton.seek(newton.system, at, end)
        if near is None:
            continue
        # A solution is stable where its own branch continues to it.
        if newton.stability.continues(near, near, end):
            return near, has_others
        has_others = True
        if _are_equal(at.slip, before.slip):
            at = newton.stability.leave(near, end)
    return None, has_others


def _slid(
    newton: Newton,
    at: InstantSolution,
    right_sides: tuple[RightSides, RightSides],
    fallen: tuple[Array, Array],
    known: list[States],
) -> InstantSolution | None:
    """Follow a solution to other right-hand sides with friction of given slips.

    Parameters
    ----------
    newton
        Newton's method.
    at
        Solution with the first right-hand sides.
    right_sides
        The right-hand sides at both ends.
    fallen
        Slips up to which friction has fallen at both ends, shape (n,) each, scaled.
    known
        States to try, shape (n,) each.
    """
    before, after = fallen
    at_end = newton.with_friction_left(after)
    slid = at_end.follow(at, right_sides[1], at.guesses(known))
    if slid is not None:
        return slid

    def newton_at(share: float) -> Newton:
        return newton.with_friction_left(before + share * (after - before))

    slid, share = followed(newton_at, at, right_sides, known)
    if share == 1.0:
        return slid
    return at_end.follow(at, right_sides[1], at_end.approach(at, right_sides[1]))


def _are_equal(slip: Array, other: Array) -> bool:
    """Check whether slips, (n,), are equal up to the accuracy of a solution."""
    size = np.abs(other).max(initial=0.0)
    return bool(np.abs(slip - other).max(initial=0.0) <= AT_REST * size)
