"""Joints of bodies of any shape as data: pairs of nodes in contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.checks import (
    ANY_NUMBER,
    FLAG,
    NON_NEGATIVE,
    AnyOf,
    Kind,
    Numbers,
    check,
    check_value,
    checked_copies,
)
from solver.refusal import RefusedError, Words


@cache
def _kinds_of_joint(size: int) -> dict[str, Kind]:
    """Kinds of the fields of a joint with `size` pairs."""
    return {
        # Only the bodies know how many nodes they have.
        "nodes": Numbers(((size,),), whole=True),
        "normals": Numbers(((size, 2),)),
        "gap": AnyOf(ANY_NUMBER, Numbers(((size,),))),
        "friction": AnyOf(NON_NEGATIVE, Numbers(((size,),), low=0.0)),
        "start": ANY_NUMBER,
        "is_left_handed": FLAG,
        "strength": Numbers(((size, None),), low=0.0),
        "is_image": FLAG,
    }


@dataclass(frozen=True, eq=False)
class Joint:
    """Pairs of nodes of two bodies in contact, or of a body and a rigid support.

    Attributes
    ----------
    name
        Name of the interface.
    above, nodes
        Index of the body above, and a chain of its nodes, (n,).
    below, nodes_below
        Index of the body below and the chain of its nodes opposite, (n,); None for a
        rigid rough support.
    normals
        Unit normals out of what is below into the body above, shape (n, 2), in global
        axes. The tangent is the normal turned clockwise by a right angle.
    gap
        Opening of each pair, shape (n,), m, negative where the bodies overlap; or one.
    friction
        Coefficient of friction, or that of each pair, shape (n,).
    start
        Position of the first node, m: positions of contact points are along the joint
        from there.
    is_left_handed
        Whether the tangent is the normal turned counter-clockwise.
    paired
        Mask of the nodes that have a pair, shape (n,); None: all of them. The length of
        another node goes to its nearest neighbour.
    strength
        Largest friction force per area where it is known, shape (n, n_instants), Pa:
        friction is not read, and nothing presses or opens. None where the contact force
        decides.
    is_image
        Whether below a support lies the image of the body, turned by half a turn, which
        moves along as much the other way: slip is between both, twice the displacement
        of the body, and the friction law is one of this slip. The strength has to be
        known.

    Raises
    ------
    RefusedError
        For fields out of range, and an image without a known strength.
    """

    name: str
    above: int
    nodes: Indices
    below: int | None
    nodes_below: Indices | None
    normals: Array
    gap: Array | float = 0.0
    friction: Array | float = 0.0
    start: float = 0.0
    is_left_handed: bool = False
    paired: Flags | None = None
    strength: Array | None = None
    is_image: bool = False

    def __post_init__(self) -> None:
        kinds = _kinds_of_joint(len(self.nodes))
        check(self, **kinds)
        if self.below is not None:
            check(self, nodes_below=kinds["nodes"])
        if self.paired is not None and np.shape(self.paired) != (len(self.nodes),):
            raise RefusedError(
                f"{self}.paired",
                Words(f"of shape {np.shape(self.paired)}"),
                f"a mask of its {len(self.nodes)} nodes",
                "give one flag for each node",
            )
        if self.is_image and (self.strength is None or self.below is not None):
            raise RefusedError(
                f"{self}.is_image",
                self.is_image,
                "a support of known strength",
                "give the strength, as slip changes nothing across a plane of symmetry",
            )

    def __str__(self) -> str:
        return f"Joint {self.name!r}"

    def placed(
        self,
        names: Sequence[str],
        above: Sequence[int],
        below: Sequence[int | None],
        normals: Array | None = None,
        starts: Sequence[float] | None = None,
    ) -> list[Joint]:
        """Joints like this one with other names, bodies, normals and starts.

        `above` and `below` are the numbers of their bodies, (n,); `normals` have the
        shape (n, n_nodes, 2), and starts are in m: by default those of this joint.
        """
        count = len(names)
        changed: dict[str, Sequence[object]] = {}
        if normals is not None:
            shape = count, len(self.nodes), 2
            check_value("Joint.normals", normals, Numbers((shape,)))
            changed["normals"] = list(normals)
        if starts is not None:
            check_value("Joint.start", np.asarray(starts), Numbers(((count,),)))
            changed["start"] = starts
        return checked_copies(
            self, count, name=names, above=above, below=below, **changed
        )

    @cached_property
    def along(self) -> int:
        """Component along the joint where the directions are x and y: else 0."""
        is_upright = self.is_left_handed and np.all(self.normals == [1.0, 0.0])
        return int(is_upright)

    @cached_property
    def sides(self) -> list[tuple[int, Indices]]:
        """Bodies and their chains of nodes; the body above comes first."""
        sides = [(self.above, self.nodes)]
        if self.below is not None and self.nodes_below is not None:
            sides.append((self.below, self.nodes_below))
        return sides
