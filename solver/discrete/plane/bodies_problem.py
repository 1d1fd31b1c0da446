"""Discrete problem of bodies of any shape: interface laws at joints, cuts and holds.

Parts of one body are glued where they were cut. Contact forces are lumped at the nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.elements import legendre_basis
from solver.discrete.inside import Inside
from solver.discrete.loose_bodies import LooseBodiesError, loose_bodies
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body_parts import ShapePart
from solver.discrete.plane.cut_bodies import CutBodies
from solver.discrete.plane.cut_shapes import Seam
from solver.discrete.plane.joint_laws import laws_of
from solver.discrete.plane.makers.band import Band
from solver.discrete.problem import Problem
from solver.discrete.substructure import Scales
from solver.laws import (
    BodyStiffness,
    Component,
    Contact,
    Dirichlet,
    FrictionLaw,
    Interface,
    Perfect,
    Unilateral,
)

RestOf = Callable[[Inside, Scales], Array | None]


def _nowhere(_: Inside, __: Scales) -> None:
    """No displacement to start from: bodies that need none."""


def problem_of(structure: Bodies, rest_of: RestOf = _nowhere) -> Problem:
    """Discrete problem of bodies: their parts, interfaces and inside.

    Parameters
    ----------
    structure
        The bodies.
    rest_of
        Function of the inside and the scales that returns a displacement to start
        from, scaled, (n_dofs, n_instants), or None.

    Raises
    ------
    RefusedError
        If bodies can move though all contacts are closed and stick.
    """
    cut = CutBodies(structure)
    scales = cut.scales
    nodes = structure.nodes / cut.length
    inside = Inside(cut.parts, nodes, scales, len(structure.instants))
    order = [joint.name for joint in structure.joints]
    order += [spring.name for spring in structure.springs]
    problem = Problem(
        substructures=inside.substructures(),
        interfaces=dict(_interfaces(cut)),
        positions=inside.positions * scales.displacement,
        instants=structure.instants,
        scales=scales,
        inside=inside,
        rest=rest_of(inside, scales),
        has_short_joints=not np.all(cut.frames.has_pair | cut.frames.is_held),
        order=tuple(order),
    )
    loose = loose_bodies(problem)
    if len(loose):
        raise LooseBodiesError.of([structure.bodies[number].name for number in loose])
    return problem


def problem_of_band(band: Band) -> Problem:
    """Discrete problem of a band on a guide.

    A band that slides as a whole goes far beyond its elongation against friction alone,
    and a search from zero with it, by a share of the elongation an iteration: so it
    starts where the band has slid to.
    """
    slide = band.slide()

    def rest_of(inside: Inside, _: Scales) -> Array | None:
        if slide is None:
            return None
        # The guide turns clockwise about the origin.
        every = np.arange(len(inside.positions))
        turn = inside.rigid_modes(every, np.zeros(2))[:, 2]
        return np.outer(turn, -slide / band.guide.radius)

    return problem_of(band, rest_of)


def _interfaces(cut: CutBodies) -> Iterator[tuple[str, Interface]]:
    """All interfaces by name: contacts, then cuts, then prescribed displacements."""
    yield from laws_of(cut)
    for number, spring in enumerate(cut.structure.springs):
        yield spring.name, _spring(cut, number)
    yield from _cuts_inside(cut)
    by_name = dict[str, list[int]]()
    for number, held in enumerate(cut.structure.held):
        by_name.setdefault(held.name, []).append(number)
    for name, numbers in by_name.items():
        yield name, _prescribed(cut, numbers)


def _cuts_inside(cut: CutBodies) -> Iterator[tuple[str, Perfect]]:
    """Yield the interfaces inside bodies by name; equal bodies share macro bases."""
    known = dict[Hashable, Array]()
    for body, of_body in enumerate(cut.structure.bodies):
        for number, seam in enumerate(cut.cuts[body].seams):
            first, second = seam.parts
            own = cut.shape_parts[cut.owner(body, first)]
            key = id(own), id(seam)
            if key not in known:
                known[key] = _basis_on(seam, own, cut.structure.macro_degree)
            name = f"cut {first + 1} to {second + 1} of {of_body.name}"
            yield name, _glued(cut, body, number, known[key])


def _basis_on(seam: Seam, part: ShapePart, degree: int) -> Array:
    """Macro basis of one component along a seam beside a part, (n_nodes, n_macro)."""
    if part.n_axes > 2:
        # Beams are cut at a node, whose three components all balance.
        return np.ones((1, 1))
    reach = np.abs(seam.positions).max()
    slenderness = part.slenderness(seam.nodes, seam.weights.sum())
    return legendre_basis(seam.positions / reach, slenderness, degree)


def _glued(cut: CutBodies, body: int, number: int, basis: Array) -> Perfect:
    """Perfect interface of two parts of one body.

    Macro forces are polynomials along the seam, by the basis of one component,
    (n_nodes, n_macro), in both directions of the body's axes, and in its rotation.
    """
    seam = cut.cuts[body].seams[number]
    first, second = [cut.parts[cut.owner(body, part)] for part in seam.parts]
    rows = first.rows(("first", body, number))
    opposite = second.rows(("second", body, number))
    frames = cut.local_frames(body, seam.nodes)
    if rows.shape[1] > 2:
        # A beam is cut at one node, whose degrees of freedom stand for themselves.
        frames = np.eye(3)[None]
    macro = frames[:, :, None, :] * basis[:, None, :, None]
    return Perfect(rows.ravel(), opposite.ravel(), macro.reshape(rows.size, -1))


def _spring(cut: CutBodies, number: int) -> Contact:
    """Contact law of a spring, which pushes its node as if it stood on the left."""
    structure = cut.structure
    spring = structure.springs[number]
    (part,) = [part for part in cut.parts if ("spring", number) in part.traces]
    rows = part.rows(("spring", number))
    body = structure.bodies[spring.body]
    scales = cut.scales
    compliance = scales.force / scales.displacement / spring.stiffness
    return Contact(
        normal=Unilateral(
            component=Component(rows[:, 0]),
            gap=np.array([spring.slack / scales.displacement]),
            compliance=np.array([compliance]),
        ),
        tangential=FrictionLaw().at(Component(rows[:, 1]), np.ones(1), (1.0, 1.0)),
        points=np.zeros(1, dtype=np.intp),
        positions=body.nodes[[spring.node], 0] - structure.box[0][0],
        weights=np.array([spring.length]),
        stiffness_beside=BodyStiffness(above=cut.moduli[spring.body]),
        is_spring=True,
    )


def _prescribed(cut: CutBodies, numbers: Sequence[int]) -> Dirichlet:
    """Dirichlet law of prescribed displacements, by the indices of holds."""
    rows = list[Indices]()
    values = list[Array]()
    for number in numbers:
        held = cut.structure.held[number]
        shape = len(held.nodes), len(cut.structure.instants)
        given = np.broadcast_to(held.displacement, shape)
        _, signs = cut.frames.axes_held(held, held.nodes)
        scaled = signs[:, None] * given / cut.length
        for part in range(cut.structure.bodies[held.body].substructures):
            owner = cut.owner(held.body, part)
            own = cut.parts[owner]
            if ("held", number) in own.traces:
                rows.append(own.rows(("held", number)).ravel())
                values.append(scaled[cut.shape_parts[owner].has(held.nodes)])
    return Dirichlet(np.concatenate(rows), np.concatenate(values))
