"""What the catalogue knows of a scene."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Generic, Literal, NamedTuple, TypeVar

from solver.discrete.loops import LoopFields
from solver.discrete.problem import Problem
from solver.discrete.structure import Structure
from solver.reference.closed_forms import ExactCurve
from solver.scenes.base import SceneSettings

S = TypeVar("S", bound=SceneSettings)
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
class Entry(Generic[S]):
    """One scene of the catalogue, and what it can.

    Attributes
    ----------
    title, source
        What it is called, and where it comes from.
    emblem
        Its small picture.
    settings
        Its settings.
    kind
        What there is to see: a rod on its support, wires beside each other, wires around a core, or
        plane bodies.
    structure
        Makes what the scene is made of.
    words
        Say of settings what there is, what acts on it, and what rubs, in a sentence for whoever
        sees it for the first time.
    coarser
        Makes the problems of the same scene, uncut, on ever coarser meshes, the finest first; None
        where no run starts from them.
    exact
        Give what is known of it without a mesh, for its settings, its problem, and what an
        incremental solver has found, if it has: closed forms of contact are for the forces there.
    sizes
        Numbers over which costs are measured, by setting.
    grows
        Settings by which the structure becomes larger as it is, all of them together.
    """

    title: str
    source: str
    emblem: Emblem
    settings: type[S]
    kind: Kind
    structure: Callable[[S], Structure]
    words: Callable[[S], str]
    sizes: Mapping[str, tuple[int, ...]]
    grows: tuple[str, ...]
    coarser: Callable[[S], Iterable[Problem]] | None = None
    exact: Callable[[S, Problem, LoopFields | None], Iterable[ExactCurve]] | None = None
