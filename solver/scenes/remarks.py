"""Remarks on a run besides its status: before it begins, and on its result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.arrays import Array, Flags
from solver.discrete.drives import describe_loads
from solver.discrete.inside import Inside
from solver.discrete.plane.makers.band import Band
from solver.discrete.plane.rectangles.rigid_stack import is_upright
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.problem import Problem
from solver.discrete.rope.rope import Rope
from solver.discrete.rope.wire_forces import wire_forces
from solver.discrete.structure import Structure
from solver.latin import Iterate
from solver.latin.end.certified import Answer
from solver.laws import OPEN
from solver.reference.other_positions import other_positions
from solver.settings.scene import Settings

MOST_GROWTH = 2
"""Largest number of points by which a contact may grow from an instant to the next: one
at each end. If more points close together, they stick without traction beside points
that were in contact before: with 1, 2 and 4 points at each end, neighbours differ by
0.1, 0.3 and 0.7 of the largest friction (measured on a parabola, 192 elements)."""
SMALL = 0.05
"""Largest strain, or slope of a body, for which the theory of small strains holds."""
AT_ONCE = 2_000_000
"""Number of nodes times instants whose displacements are in memory at once."""


def remarks_before(settings: Settings, assignments: Sequence[str]) -> list[str]:
    """Sentences on settings that do not apply, and on load tables longer than the run.

    `assignments` are `NAME=VALUE` texts.
    """
    remarks = []
    defaults = settings.defaults("paper")
    names = dict.fromkeys(each.partition("=")[0].strip() for each in assignments)
    for name in names:
        is_changed = getattr(settings, name) != defaults[name]
        if is_changed and not settings.applies(name):
            remarks.append(f"{name} does nothing with the other settings as they are")
    duration = settings.duration
    for name, end in ends_of_tables(settings).items():
        if end > duration:
            remarks.append(
                f"{name} goes on to {end:g} s, but the run ends at {duration:g} s: "
                f"set duration={end:g} to run all of it"
            )
    return remarks


def ends_of_tables(settings: Settings) -> dict[str, float]:
    """Last time, s, of every load path that is a table, by the name of its setting."""
    values = settings.values()
    return {
        name: values[name][-1][0]
        for name in settings.paths
        if isinstance(values[name], tuple)
    }


def remarks_on(settings: Settings, iterate: Iterate) -> list[str]:
    """Sentences on an iterate, final or not, in addition to its status.

    They are on points left out of tables, strains beyond small ones, a body that tips,
    a contact that grows too fast for the instants, and bodies that may stand elsewhere.
    """
    remarks = list(settings.left_out())
    # What a support that moves takes along is strained as it is.
    displacement = iterate.problem.absolute(iterate.displacement)
    beyond = beyond_small_strain(settings.structure(), iterate.problem, displacement)
    if beyond is not None:
        remarks.append(beyond)
    standing = _standing_on_an_end(settings, iterate)
    if standing.any():
        remarks.append(_tipping(iterate.problem, int(np.argmax(standing))))
    growth = contact_growth(iterate)
    if growth > MOST_GROWTH:
        remarks.append(
            f"The contact grows by up to {growth} points from an instant to the next, "
            "so that friction jumps from point to point: raise instants until it grows "
            f"by {MOST_GROWTH} at most."
        )
    if isinstance(iterate, Answer):
        others = _one_of_several(iterate)
        if others:
            remarks.append(others)
    return remarks


def _one_of_several(answer: Answer) -> str:
    """Sentence on a certified answer that is one of several; else ""."""
    problem = answer.problem
    others = other_positions(problem, answer.displacement, answer.contact_force)
    if not others:
        return ""
    apart = []
    for instant, other in others.items():
        moved = other - answer.displacement[:, instant]
        apart.append(float(np.abs(moved[~problem.is_turn]).max()))
    first = problem.instants[min(others)]
    return (
        f"This is one of several solutions: at {len(others)} of {problem.n_instants} "
        f"instants, the first at {first:.4g} s, the same contact forces also hold some "
        f"body up to {max(apart):.2g} m away from where it is shown, and which one is "
        "found depends on the start. Forces are determined there, positions are not."
    )


def _tipping(problem: Problem, first: int) -> str:
    """Sentence on a body that tips from an instant on."""
    loads = describe_loads(problem.drives, first)
    time = f"{problem.instants[first]:.4g} s"
    when = f"{time} on"
    if loads:
        when = f"{loads}, at {time},"
    return (
        f"From {when} the body tips: it stands on one end of its base. Take a longer "
        "or lower body, less friction, or a side that keeps it from turning."
    )


def contact_growth(iterate: Iterate) -> int:
    """Largest number of points that a contact gains between two instants.

    The first closing of a contact does not count, nor does a contact of sides that fit:
    what load opens and closes there takes its size at once, with any instants.
    """
    growth = 0
    for law, _, points, _ in iterate.problem.contacts.stacks:
        if law.normal is None:
            continue
        rubs = law.by_point(law.tangential.friction) > 0.0
        is_closed = iterate.status[points] != OPEN
        before = is_closed[:, :-1]
        gained = is_closed[:, 1:] & ~before
        for some, pairs in law.ranges:
            is_curved = np.ptp(law.normal.gap[pairs]) > 0.0
            if is_curved and rubs[some].any():
                counted = gained[some].sum(axis=0) * before[some].any(axis=0)
                growth = max(growth, int(counted.max(initial=0)))
    return growth


def _standing_on_an_end(settings: Settings, iterate: Iterate) -> Flags:
    """Instants at which a body free to turn stands on one end, (n_instants,)."""
    structure = settings.structure()
    none = np.zeros(iterate.problem.n_instants, dtype=bool)
    if not isinstance(structure, Stack) or structure.support is None:
        return none
    if len(structure.rectangles) > 1 or is_upright(structure):
        return none
    closed = iterate.contact("support").status != OPEN
    return np.asarray((closed.sum(axis=0) == 1) & (closed[0] | closed[-1]))


def largest_strain(
    structure: Structure, problem: Problem, displacement: Array
) -> float:
    """Largest strain or rotation of a solution: largest derivative of displacement.

    A translation has none. Along rods it is the strain of an element; in the plane the
    mean derivative over an element, rotation included; of a band on a guide its strain
    and its slope to the guide; of wires the axial strain plus the strain of bending.
    `displacement` is that of the problem's degrees of freedom, absolute,
    (n_dofs, n_instants), m.
    """
    if isinstance(structure, Rope):
        return _of_wires(structure, displacement)
    if isinstance(structure, Band):
        strains = np.abs(structure.strains(problem, displacement))
        lifts = np.abs(structure.lifts(problem, displacement))
        return float(max(strains.max(), lifts.max()))
    if problem.inside is None:
        return _of_rods(problem.positions, displacement)
    return _in_plane(problem.inside, displacement)


def beyond_small_strain(
    structure: Structure, problem: Problem, displacement: Array
) -> str | None:
    """Sentence on strains too large for linear elasticity; None if they are small.

    `displacement` is that of the problem's degrees of freedom, (n_dofs, n_instants), m.
    """
    strain = largest_strain(structure, problem, displacement)
    if strain <= SMALL:
        return None
    return (
        f"this model does not hold: strains or slopes reach {strain:.3g}, and it is "
        f"for small ones, up to {SMALL}; lower the loads, or take a stiffer body"
    )


def _of_rods(positions: Array, displacement: Array) -> float:
    """Largest strain of rods, from positions, (n_nodes,), m, and displacement of nodes.

    `displacement` has shape (n_nodes, n_instants), m.
    """
    lengths = np.diff(positions)
    inside = lengths > 0.0  # not from one rod to the next, nor across a break
    steps = np.diff(displacement, axis=0)[inside]
    return float(np.abs(steps / lengths[inside, None]).max(initial=0.0))


def _of_wires(rope: Rope, displacement: Array) -> float:
    """Largest strain of wires, from the displacement, (n_dofs, n_instants), m."""
    forces = wire_forces(rope, displacement, slice(None))
    largest = 0.0
    for wire, force in zip(rope.wires, forces, strict=True):
        axial = np.abs(force).max(initial=0.0) / wire.layer_data.stiffness
        bent = 0.5 * wire.layer_data.diameter * np.abs(wire.curvature).max(initial=0.0)
        largest = max(largest, float(axial + bent))
    return largest


def _in_plane(inside: Inside, displacement: Array) -> float:
    """Largest derivative in the plane, from displacement, (n_dofs, n_instants), m."""
    corners = inside.nodes[inside.elements]
    diagonals = corners[:, 2:] - corners[:, :2]
    # Of a beam both diagonals are its axis, along which alone there is a derivative.
    inverses = np.linalg.pinv(diagonals)
    # Displacements of all nodes at all instants may exceed the memory.
    step = max(1, AT_ONCE // len(inside.nodes))
    largest = 0.0
    for first in range(0, displacement.shape[1], step):
        moved = inside.displacement(displacement, slice(first, first + step))
        of_corners = moved[inside.elements]
        changes = of_corners[:, 2:] - of_corners[:, :2]
        gradients = np.einsum("eij,ejct->eict", inverses, changes)
        largest = max(largest, float(np.abs(gradients).max()))
    return largest
