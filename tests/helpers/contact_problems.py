"""Small contact problems made by hand, shared by tests."""

import numpy as np

from solver.discrete.plane.rectangles.bricks import Brick
from solver.discrete.plane.rectangles.sides import Side, SideComponent, Support
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.problem import Problem
from solver.discrete.substructure import Elasticity, Scales, Substructure
from solver.laws import (
    BodyStiffness,
    Component,
    Contact,
    Dirichlet,
    Friction,
    Unilateral,
)

COURSES = ("random", "reversal", "open and close", "wander")


def stiffness(rng, size, softest=1e-2):
    """A random symmetric positive definite matrix whose parts are strongly coupled."""
    factor = rng.normal(size=(size, size))
    return factor @ factor.T / size + softest * np.eye(size)


def course(rng, name, size, instants):
    """Loads, shape (size, instants), that make the contacts change their states."""
    steps = rng.normal(size=(size, instants))
    if name == "reversal":
        return np.outer(
            rng.normal(size=size), np.where(np.arange(instants) % 2, 1.0, -1.0)
        )
    if name == "open and close":
        normal = np.arange(size) % 2 == 1
        steps[normal] += np.where(np.arange(instants) % 2, 2.0, -2.0)
    if name == "wander":
        return np.cumsum(steps, axis=1) * 0.3
    return steps


def substructure(matrix, first, force, rows_of_each=1):
    """A body whose every degree of freedom has a row, or several."""
    size = len(matrix)
    trace = np.tile(np.arange(size), rows_of_each)
    dofs = first[0] + np.arange(size)
    rows = first[1] + np.arange(len(trace))
    return Substructure(
        Elasticity(matrix, trace, np.ones(len(trace))), dofs, rows, force
    )


def problem(parts, interfaces, instants):
    """A problem in which every scaled unit is one."""
    size = sum(len(part.dofs) for part in parts)
    return Problem(
        tuple(parts),
        interfaces,
        np.zeros((size, 2)),
        np.arange(instants, dtype=float),
        Scales(1.0, 1.0, 1.0),
    )


def friction_of(component, *, bound=0.0, friction=0.0):
    """Coulomb's friction of a known bound, or of mu."""
    none = np.zeros(len(component.above))
    return Friction(
        component=component, bound=(none + bound)[:, None], friction=none + friction
    )


def contact(normal, tangent, below, gap, friction):
    """A contact of as many points as there are normal rows."""
    count = len(normal)
    points = np.arange(count)
    ones = np.ones(count)
    below = below or (None, None)
    return Contact(
        normal=Unilateral(component=Component(normal, below[0]), gap=gap),
        tangential=friction_of(Component(tangent, below[1]), friction=friction * ones),
        points=points,
        positions=1.0 * points,
        weights=ones,
        stiffness_beside=BodyStiffness(),
    )


def rubbing_points(seed, *, opens, two):
    """Random numbers, sliders, and the rest of a contact: a normal law or none."""
    random = np.random.default_rng(seed)
    pairs = 4
    rows = random.permutation(4 * pairs).reshape(4, pairs)
    across, along = (Component(rows[n], rows[n + 2] if two else None) for n in (0, 1))
    if opens:
        normal = Unilateral(component=across, gap=np.zeros(pairs))
        sliders = friction_of(along, friction=np.full(pairs, 0.4))
    else:
        normal = None
        sliders = friction_of(along, bound=random.uniform(0.0, 0.5, pairs))
    common = {
        "normal": normal,
        "points": np.arange(pairs),
        "positions": np.arange(float(pairs)),
        "weights": random.uniform(0.5, 2.0, pairs),
    }
    return random, sliders, common


def local_stage(law, random, *, rows=16, times=20):
    """Displacements and forces by a law along random search directions, and these."""
    k = 10.0 ** random.uniform(-1.0, 1.0, rows)
    incoming = random.normal(size=(rows, times))
    moved = incoming.copy()
    law.rule(k, times)(incoming, moved, slice(None))
    return moved, k[:, None] * (moved - incoming)


def on_a_support(rng, points, friction, *, load="random", instants=6, gap=None):
    """A body on a support: tangential and normal displacement of each point in turn."""
    size = 2 * points
    part = substructure(stiffness(rng, size), (0, 0), course(rng, load, size, instants))
    if gap is None:
        gap = rng.choice([0.0, 0.1], size=points)
    else:
        gap = np.full(points, gap)
    law = contact(np.arange(1, size, 2), np.arange(0, size, 2), None, gap, friction)
    return problem([part], {"support": law}, instants)


def two_bodies(rng, points, friction, *, load="random", instants=6):
    """A body on another that is clamped at its first two degrees of freedom."""
    size = 2 * points
    below = substructure(stiffness(rng, size + 2), (0, 0), None)
    force = course(rng, load, size, instants)
    above = substructure(stiffness(rng, size), (size + 2, size + 2), force)
    normal = np.arange(1, size, 2)
    tangent = np.arange(0, size, 2)
    law = contact(
        normal + size + 2,
        tangent + size + 2,
        (normal + 2, tangent + 2),
        np.zeros(points),
        friction,
    )
    clamp = Dirichlet(np.arange(2), np.zeros((2, instants)))
    return problem([below, above], {"contact 1-2": law, "clamp": clamp}, instants)


def rubbing_strands(rng, strands, points, *, ring=False, instants=8):
    """Bodies that rub on their neighbours with a known bound; the ring closes it."""
    pairs = [(one + 1, one) for one in range(strands - 1)] + [(0, strands - 1)] * ring
    met = np.bincount(np.ravel(pairs), minlength=strands)
    first = points * np.concatenate([[0], np.cumsum(met)])
    parts = [
        substructure(
            stiffness(rng, points),
            (points * one, first[one]),
            rng.normal(size=(points, instants)),
            rows_of_each=met[one],
        )
        for one in range(strands)
    ]
    along = np.arange(points)
    taken = first[:-1].copy()
    laws = {}
    for above, below in pairs:
        component = Component(taken[above] + along, taken[below] + along)
        taken[[above, below]] += points
        laws[f"strand {above}-{below}"] = Contact(
            tangential=friction_of(component, bound=rng.uniform(0.0, 0.5, size=points)),
            points=along,
            positions=1.0 * along,
            weights=np.ones(points),
        )
    return problem(parts, laws, instants)


def block(
    *,
    elements=(12, 8),
    cuts=(2, 2),
    bodies=1,
    friction=0.3,
    shear=0.2,
    slope=0.0,
    **given,
):
    """A block pressed on a rough support, then sheared back and forth on its top.

    Shear and its change along the top are shares of the pressure, 1e-3 E.
    """
    instants = given.pop("instants", 17)
    time = np.linspace(0.0, 1.0, instants)
    pressure = -1e6 * np.minimum(4.0 * time, 1.0)
    swing = (
        1e6
        * shear
        * np.where(time > 0.25, np.sin(2.0 * np.pi * (time - 0.25) / 0.75), 0.0)
    )
    tilt = (
        slope
        * pressure
        * np.where(time > 0.25, np.sin(np.pi * (time - 0.25) / 0.75), 0.0)
    )
    top = Side(SideComponent(False, swing), SideComponent(False, pressure, tilt))
    return Stack(
        length=1.0,
        height=given.pop("height", 0.6),
        bricks=[Brick(0, body * elements[1], *elements) for body in range(bodies)],
        elements=elements,
        substructures=cuts,
        young=1e9,
        poisson=0.3,
        friction=friction,
        support=Support(np.zeros(elements[0] + 1), friction),
        sides={"top": top, **given},
        instants=time,
        duration=1.0,
    )
