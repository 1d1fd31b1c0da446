"""Bodies of any shape, and what holds, pulls and loads them, as data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from solver.arrays import Array, Indices
from solver.checks import (
    ANY_NUMBER,
    NON_NEGATIVE,
    POSITIVE,
    ROWS,
    Count,
    InstanceOf,
    Number,
    Numbers,
    check,
    check_value,
    checked_copies,
)
from solver.discrete.elements import MOST_POISSON
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.lattice import Lattice
from solver.discrete.plane.meshes import Mesh
from solver.refusal import RefusedError, Words

Shape = Mesh | Lattice | Beam
SHAPE = InstanceOf(Mesh, Lattice, Beam)
POISSON = Number(-1.0, MOST_POISSON, above=True)
POINT = Numbers(((2,),))


def turned_by(angles: Array) -> Array:
    """Matrices that turn counter-clockwise, (n, 2, 2), by angles, (n,), rad."""
    c = np.cos(angles)
    s = np.sin(angles)
    rows = np.stack([c, -s], axis=1), np.stack([s, c], axis=1)
    return np.asarray(np.stack(rows, axis=1))


@dataclass(frozen=True, eq=False)
class Body:
    """An elastic body: its shape, turned by the angle and put at the origin.

    Bodies with the same shape object and material, which are cut and joined alike in
    their own axes, share operators.

    Attributes
    ----------
    name
        Name in messages.
    shape
        Mesh or lattice, one metre thick, or line of beams.
    young, poisson
        Young's modulus, Pa, and Poisson's ratio, which beams do not read.
    origin
        Position of the origin of the shape's axes, shape (2,), m.
    angle
        Counter-clockwise angle by which the shape is turned, rad.
    weight
        Force per volume along x and y, shape (2, n_instants), N/m^3, or None.
    substructures
        Number of parts into which the body is cut along edges of its elements.
    parts
        Index of the part of every element, (n_elements,); None: parts are found by
        bisection.

    Raises
    ------
    RefusedError
        For fields out of range, elements of no or negative area, a mesh of several
        pieces, and parts without elements.
    """

    name: str
    shape: Shape
    young: float
    poisson: float = 0.0
    origin: Array = field(default_factory=lambda: np.zeros(2))
    angle: float = 0.0
    weight: Array | None = None
    substructures: int = 1
    parts: Indices | None = None

    def __post_init__(self) -> None:
        check(
            self,
            shape=SHAPE,
            young=POSITIVE,
            poisson=POISSON,
            origin=POINT,
            angle=ANY_NUMBER,
        )
        if self.shape.flaw:
            raise RefusedError(
                f"{self}.shape",
                Words(self.shape.flaw),
                "one piece of elements whose corners run counter-clockwise round them",
                "mend the mesh there",
            )
        n_elements = len(self.shape.centres)
        check(
            self,
            substructures=Count(1, n_elements),
            parts=Numbers(((n_elements,),), 0, self.substructures - 1, whole=True),
        )
        if self.parts is not None and len(np.unique(self.parts)) < self.substructures:
            raise RefusedError(
                f"{self}.parts",
                Words(f"{len(np.unique(self.parts))} different ones"),
                f"all from 0 to {self.substructures - 1}",
                "lower substructures",
            )

    def __str__(self) -> str:
        return f"Body {self.name!r}"

    def placed(self, names: Sequence[str], origins: Array, angles: Array) -> list[Body]:
        """Bodies like this one with other names, origins and angles.

        `origins` have the shape (n, 2), m, and `angles` (n,), rad.
        """
        count = len(names)
        check_value("Body.origin", origins, Numbers(((count, 2),)))
        check_value("Body.angle", angles, Numbers(((count,),)))
        return checked_copies(
            self, count, name=names, origin=list(origins), angle=angles.tolist()
        )

    @property
    def cut_key(self) -> tuple[int, int, int]:
        """Key of the shape and its parts: bodies of one key are cut alike."""
        return id(self.shape), self.substructures, id(self.parts)

    @cached_property
    def rotation(self) -> Array:
        """Matrix from the axes of the shape to the global ones, shape (2, 2)."""
        (rotation,) = turned_by(np.array([self.angle]))
        return np.asarray(rotation)

    @cached_property
    def nodes(self) -> Array:
        """Global coordinates of the nodes of the shape, shape (n_nodes, 2), m."""
        return np.asarray(self.shape.nodes @ self.rotation.T + self.origin)

    def outward(self, chain: Indices) -> Array:
        """Unit normals out of the body along a chain of nodes, shape (n, 2)."""
        normals = self.shape.outward(chain) @ self.rotation.T
        return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


@dataclass(frozen=True, eq=False)
class Held:
    """Nodes of a body whose displacement is prescribed along one axis.

    Holds of one name, which may be of several bodies, are one interface.

    Attributes
    ----------
    name, body, nodes
        Name, index of the body, and indices of its nodes, (n,).
    axis
        0 along x, 1 along y, 2 turn of a beam.
    displacement
        Displacement over time, m (rad of a turn), of all nodes, shape (n_instants,), or
        of each, (n, n_instants).
    """

    name: str
    body: int
    nodes: Indices
    axis: int
    displacement: Array

    def __post_init__(self) -> None:
        check(
            self,
            nodes=ROWS,
            axis=Count(0, 2),
            displacement=Numbers(((None,), (len(self.nodes), None))),
        )

    def __str__(self) -> str:
        return f"Held {self.name!r}"

    @property
    def mean(self) -> Array:
        """Mean displacement of the nodes over time, shape (n_instants,), m or rad."""
        return np.asarray(np.atleast_2d(self.displacement).mean(axis=0))


@dataclass(frozen=True, eq=False)
class NodeSpring:
    """A spring that pulls a node of a body to the right, along x.

    Attributes
    ----------
    name, body, node
        Name, index of the body, and index of its node.
    slack
        Distance by which the node may move to the left before the spring pulls, m.
    stiffness
        Stiffness, N/m.
    length
        Length of the side of the body that belongs to the node, m.
    """

    name: str
    body: int
    node: int
    slack: float
    stiffness: float
    length: float

    def __post_init__(self) -> None:
        check(self, slack=NON_NEGATIVE, stiffness=POSITIVE, length=POSITIVE)

    def __str__(self) -> str:
        return f"NodeSpring {self.name!r}"


@dataclass(frozen=True, eq=False)
class Load:
    """Nodal forces on a body, shape (n, 2, n_instants), N, at its nodes, (n,).

    A `pressure`, (n_instants,), Pa, is what drawings show in place of the force.
    """

    name: str
    body: int
    nodes: Indices
    force: Array
    pressure: Array | None = None

    def __post_init__(self) -> None:
        check(self, nodes=ROWS, force=Numbers(((len(self.nodes), 2, None),)))
        if self.pressure is not None:
            check(self, pressure=Numbers(((self.force.shape[-1],),)))

    def __str__(self) -> str:
        return f"Load {self.name!r}"

    @classmethod
    def of_traction(
        cls, name: str, number: int, body: Body, chain: Indices, traction: Array
    ) -> Load:
        """Load of a uniform traction along a chain of nodes of a body.

        `traction` is along x and y, shape (2, n_instants), Pa.
        """
        force = np.multiply.outer(body.shape.shares(chain), traction)
        return cls(name, number, chain, force)

    @classmethod
    def of_pressure(
        cls, name: str, number: int, body: Body, chain: Indices, pressure: Array
    ) -> Load:
        """Load of a pressure, (n_instants,), Pa, against the edges along a chain.

        On beams, whose line has no inside, from its left.
        """
        inward = -body.shape.outward(chain) @ body.rotation.T
        return cls(name, number, chain, np.multiply.outer(inward, pressure))

    @cached_property
    def pattern(self) -> Array:
        """Forces at the instant at which they are largest, shape (n, 2), N."""
        sizes = np.abs(self.force).sum(axis=(0, 1))
        return self.force[:, :, int(sizes.argmax())]
