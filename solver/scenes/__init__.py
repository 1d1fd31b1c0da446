"""The catalogue of scenes, and what is asked of a scene by its settings alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from solver.definitions import Pairs
from solver.discrete.loops import Loop, LoopFields
from solver.discrete.problem import Problem
from solver.discrete.structure import Structure
from solver.reference.closed_forms import ExactCurve
from solver.scenes.bar import BAR
from solver.scenes.base import SceneSettings
from solver.scenes.block import BLOCK
from solver.scenes.entry import Entry, Kind
from solver.scenes.fault import FAULT
from solver.scenes.incline import INCLINE
from solver.scenes.layers import LAYERS
from solver.scenes.rope import ROPE
from solver.scenes.strand import STRAND
from solver.settings import Settings

CATALOGUE: dict[str, Entry[Any]] = {
    "bar": BAR,
    "block": BLOCK,
    "fault": FAULT,
    "incline": INCLINE,
    "layers": LAYERS,
    "rope": ROPE,
    "strand": STRAND,
}


def entry_of(settings: Settings) -> Entry[Any]:
    """Give the entry of the scene that settings belong to."""
    return CATALOGUE[settings.scene]


def kind_of(settings: Settings) -> Kind:
    """Tell what there is to see of a scene."""
    return entry_of(settings).kind


def structure_of(settings: Settings) -> Structure:
    """Make what checked settings describe: bodies, with all that acts on them."""
    return entry_of(settings).structure(settings)


def words_of(settings: Settings) -> str:
    """Say what checked settings describe, in a sentence."""
    return entry_of(settings).words(settings)


def discretise(settings: Settings) -> Problem:
    """Make the discrete problem that checked settings describe."""
    return structure_of(settings).discretise()


def coarser_problems(settings: Settings) -> list[Problem]:
    """Make the discrete problems of the same scene, uncut, on ever coarser meshes.

    Returns
    -------
    The finest first; none where the scene's own mesh is as coarse as makes sense.
    """
    coarser = entry_of(settings).coarser
    return [] if coarser is None else list(coarser(settings))


def loop_of(settings: Settings, problem: Problem) -> Loop:
    """Give the loop of a scene; forces of plane bodies are those on a metre of thickness."""
    return structure_of(settings).loop(problem)


def exact_of(
    settings: Settings, problem: Problem, found: LoopFields | None = None
) -> list[ExactCurve]:
    """Give what is known of a scene without a mesh, as `Entry.exact`; often that is nothing."""
    exact = entry_of(settings).exact
    return [] if exact is None else list(exact(settings, problem, found))


def points_of(settings: Settings, name: str) -> Pairs:
    """Give points that stand for the preset of a curve setting: where a table of one's own begins.

    They are linear in between.
    """
    assert isinstance(settings, SceneSettings)
    return settings.points(name)


def left_out(settings: Settings) -> list[str]:
    """Return what a run does not see of the tables of its settings, a sentence each."""
    assert isinstance(settings, SceneSettings)
    return list(settings.left_out())


def chief_of(settings: type[Settings]) -> Sequence[str]:
    """Name the settings that a scene is about, in the order in which one thinks of them."""
    assert issubclass(settings, SceneSettings)
    return settings.chief()


def loads_of(settings: Settings) -> Sequence[str]:
    """Name the settings that say how much a scene is loaded; the first that applies counts."""
    assert isinstance(settings, SceneSettings)
    return settings.LOADS


def mesh_of(settings: Settings) -> Sequence[str]:
    """Name the settings that say how many elements there are."""
    assert isinstance(settings, SceneSettings)
    return settings.MESH


def ends_of(settings: Settings) -> Mapping[str, int]:
    """Give the largest numbers of parts that other settings leave, by the name of their setting."""
    assert isinstance(settings, SceneSettings)
    return settings.ends


def behind(settings: Settings) -> Mapping[str, str]:
    """Name the settings that place or scale what acts on a scene, by what they are behind."""
    assert isinstance(settings, SceneSettings)
    return settings.behind()
