"""What the catalogue knows of a scene beside its settings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

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
    sizes
        Numbers over which costs are measured, by setting.
    grows
        Settings by which the structure becomes larger as it is, all of them together.
    """

    title: str
    source: str
    emblem: Emblem
    settings: type[SceneSettings]
    kind: Kind
    sizes: Mapping[str, tuple[int, ...]]
    grows: tuple[str, ...]
