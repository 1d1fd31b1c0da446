"""What a person has to know of a run beside how it ended: before it begins, and of its result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.discrete.drives import loads_at
from solver.discrete.inside import Inside
from solver.discrete.plane.rigid_stack import is_upright
from solver.discrete.plane.stack import Stack
from solver.discrete.problem import Problem
from solver.discrete.rope.rope import Rope
from solver.discrete.rope.wire_forces import wire_forces
from solver.discrete.structure import Structure
from solver.latin import Iterate
from solver.laws import OPEN
from solver.settings.scene import Settings

MOST_GROWTH = 2
"""Points by which a contact may grow from an instant to the next: one at each of its
ends. With more, those that close together stick without traction beside points that
were there before: with 1, 2 and 4 of them at each end, neighbours differ by 0.1, 0.3
and 0.7 of the largest friction (measured on a parabola, 192 elements)."""
SMALL = 0.05
"""Largest strain, or slope of a body, for which small strains hold."""
AT_ONCE = 2_000_000
"""Nodes times instants whose displacements are held together."""


def remarks_before(settings: Settings, assignments: Sequence[str]) -> list[str]:
    """Sentences on what a run does not heed: idle settings, and load tables that go on."""
    idle = settings.defaults("paper")
    duration = settings.duration
    names = dict.fromkeys(assignment.partition("=")[0] for assignment in assignments)
    remarks = [
        f"{name} does nothing with the other settings as they are"
        for name in names
        if not settings.applies(name) and getattr(settings, name) != idle[name]
    ]
    return remarks + [
        f"{name} goes on to {end:g} s, but the run ends at {duration:g} s: "
        f"set duration={end:g} to run all of it"
        for name, end in ends_of_tables(settings).items()
        if end > duration
    ]


def ends_of_tables(settings: Settings) -> dict[str, float]:
    """Last time, s, of every load path that is a table, by the name of its setting."""
    values = settings.values()
    return {
        name: values[name][-1][0]
        for name in settings.paths
        if isinstance(values[name], tuple)
    }


def remarks_on(settings: Settings, iterate: Iterate) -> list[str]:
    """Sentences on what an iterate shows, at the end or on the way, that no status tells."""
    remarks = list(settings.left_out())
    beyond = beyond_small_strain(
        settings.structure(), iterate.problem, iterate.displacement
    )
    if beyond is None:
        remarks += []
    else:
        remarks += [beyond]
    standing = _standing_on_an_end(settings, iterate)
    if standing.any():
        problem = iterate.problem
        first = int(np.argmax(standing))
        loads = loads_at(problem.drives, first)
        time = f"{problem.instants[first]:.4g} s"
        if loads:
            when = f"{loads}, at {time},"
        else:
            when = f"{time} on"
        remarks.append(
            f"From {when} the body tips: it stands on one end of its base. Take a "
            "longer or lower body, less friction, or a side that keeps it from turning."
        )
    growth = contact_growth(iterate)
    if growth > MOST_GROWTH:
        remarks.append(
            f"The contact grows by up to {growth} points from an instant to the next, "
            "so that friction jumps from point to point: raise instants until it grows "
            f"by {MOST_GROWTH} at most."
        )
    return remarks


def contact_growth(iterate: Iterate) -> int:
    """Largest number of points with friction that an existing contact gains between instants."""
    growth = 0
    for name, law in iterate.problem.rubbing.items():
        if law.normal is None or not np.any(law.tangential.friction):
            continue
        closed = iterate.contact(name).status != OPEN
        gained = (closed[:, 1:] & ~closed[:, :-1]).sum(axis=0) * closed[:, :-1].any(
            axis=0
        )
        growth = max(growth, int(gained.max(initial=0)))
    return growth


def _standing_on_an_end(settings: Settings, iterate: Iterate) -> NDArray[np.bool_]:
    """Instants at which a body that is free to turn touches its support at one end alone."""
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
    """Largest strain or slope of a solution: the largest derivative of displacement.

    A motion without rotation counts for nothing. Along rods it is that of an element;
    in the plane the mean over an element, rotation included; of wires the axial strain
    and that of bending. `displacement` is that of the problem's degrees of freedom,
    (n_dofs, n_instants), m.
    """
    if isinstance(structure, Rope):
        return _of_wires(structure, displacement)
    if problem.inside is None:
        return _of_rods(problem.positions, displacement)
    return _in_plane(problem.inside, displacement)


def beyond_small_strain(
    structure: Structure, problem: Problem, displacement: Array
) -> str | None:
    """That an answer is outside of what is modelled, or return None where it is not."""
    strain = largest_strain(structure, problem, displacement)
    if strain <= SMALL:
        return None
    return (
        f"this model does not hold: strains or slopes reach {strain:.3g}, and it is "
        f"for small ones, up to {SMALL}; lower the loads, or take a stiffer body"
    )


def _of_rods(positions: Array, displacement: Array) -> float:
    lengths = np.diff(positions)
    inside = lengths > 0.0  # not from one rod to the next, nor across a break
    steps = np.diff(displacement, axis=0)[inside]
    return float(np.abs(steps / lengths[inside, None]).max(initial=0.0))


def _of_wires(rope: Rope, displacement: Array) -> float:
    forces = wire_forces(rope, displacement, slice(None))
    largest = 0.0
    for wire, force in zip(rope.wires, forces, strict=True):
        axial = np.abs(force).max(initial=0.0) / wire.made.stiffness
        bent = 0.5 * wire.made.diameter * np.abs(wire.curvature).max(initial=0.0)
        largest = max(largest, float(axial + bent))
    return largest


def _in_plane(inside: Inside, displacement: Array) -> float:
    corners = inside.nodes[inside.elements]
    width, height = (corners[:, 2] - corners[:, 0]).T[:, :, None, None]
    step = max(1, AT_ONCE // len(inside.nodes))
    largest = 0.0
    for first in range(0, displacement.shape[1], step):
        moved = inside.displacement(displacement, slice(first, first + step))
        a, b, c, d = (moved[corner] for corner in inside.elements.T)
        along = 0.5 * (b - a + c - d) / width
        up = 0.5 * (d - a + c - b) / height
        largest = max(largest, float(np.abs([along, up]).max()))
    return largest
