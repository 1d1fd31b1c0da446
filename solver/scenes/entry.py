"""What the catalogue knows of a scene, and what a scene has under its present settings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

if TYPE_CHECKING:
    from solver.scenes.base import SceneSettings

Kind = Literal["rod", "wires", "helices", "plane"]


class Emblem(NamedTuple):
    """A small picture by which a scene is known: paths as in SVG, on a field of 48 times 32.

    Attributes
    ----------
    ground, body, load
        What holds and supports it, what is deformed, and what acts on it.
    """

    ground: str
    body: str
    load: str


@dataclass(frozen=True)
class Entry:
    """One scene of the catalogue.

    Attributes
    ----------
    title, source
        What it is called, and where it comes from.
    emblem
        Its small picture.
    settings
        Its settings, which make its structure.
    kind
        What there is to see: a rod on its support, wires beside each other, wires around a core, or
        plane bodies.
    grows
        Settings by which the structure becomes larger as it is, all of them together.
    """

    title: str
    source: str
    emblem: Emblem
    settings: type[SceneSettings]
    kind: Kind
    grows: tuple[str, ...]


class Features(NamedTuple):
    """What a scene has under its present settings, for whoever shows or measures it.

    Attributes
    ----------
    opens
        Whether contact may open, so that what presses is an unknown.
    has_spring
        Whether a spring holds a body.
    has_break
        Whether a body is broken.
    jumps
        Components of all contacts, which a reference condenses; none on a rigid support of known
        bound.
    bricks
        Bodies that touch each other at joints, 0 where a body lies on the next all along.
    loop_is_over_displacement
        Whether the force of its loop stands over a displacement, m.
    """

    opens: bool = False
    has_spring: bool = False
    has_break: bool = False
    jumps: int = 0
    bricks: int = 0
    loop_is_over_displacement: bool = True
