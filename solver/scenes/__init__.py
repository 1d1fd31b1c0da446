"""The catalogue of scenes, and what is asked of a scene by its settings alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from solver.definitions import Rows
from solver.discrete.problem import Problem
from solver.discrete.structure import Loop, LoopFields, Structure
from solver.laws import FrictionLaw
from solver.reference.closed_forms import ExactCurve
from solver.scenes.bar import BAR
from solver.scenes.base import SceneSettings
from solver.scenes.block import BLOCK
from solver.scenes.entry import Entry, Features, Kind
from solver.scenes.fault import FAULT
from solver.scenes.incline import INCLINE
from solver.scenes.layers import LAYERS
from solver.scenes.rope import ROPE
from solver.scenes.strand import STRAND
from solver.scenes.wall import WALL
from solver.settings import Settings

CATALOGUE: dict[str, Entry] = {
    entry.settings.scene: entry
    for entry in (BAR, BLOCK, FAULT, INCLINE, LAYERS, ROPE, STRAND, WALL)
}


def entry_of(settings: Settings) -> Entry:
    """Entry of the scene that settings belong to."""
    return CATALOGUE[settings.scene]


def kind_of(settings: Settings) -> Kind:
    """What there is to see of a scene."""
    return entry_of(settings).kind


def _of_scene(settings: Settings) -> SceneSettings:
    """Settings as those of a scene, which all of them are."""
    assert isinstance(settings, SceneSettings)
    return settings


def features_of(settings: Settings) -> Features:
    """What a scene has under its present settings."""
    return _of_scene(settings).features


def structure_of(settings: Settings) -> Structure:
    """Make what checked settings describe: bodies, with all that acts on them."""
    return _of_scene(settings).structure()


def law_of(settings: Settings) -> FrictionLaw:
    """Law of friction, beside mu."""
    return _of_scene(settings).law


def words_of(settings: Settings) -> str:
    """What checked settings describe, in a sentence."""
    return _of_scene(settings).sentence()


def discretise(settings: Settings) -> Problem:
    """Make the discrete problem that checked settings describe."""
    return structure_of(settings).discretise()


def coarser_problems(settings: Settings) -> list[Problem]:
    """Make the discrete problems of the same scene, uncut, on ever coarser meshes.

    Returns
    -------
    The finest first; none where the scene's own mesh is as coarse as makes sense.
    """
    return [structure.discretise() for structure in _of_scene(settings).coarser()]


def loop_of(settings: Settings, problem: Problem) -> Loop:
    """Loop of a scene; forces of plane bodies are those on a metre of thickness."""
    return structure_of(settings).loop(problem)


def exact_of(
    settings: Settings, problem: Problem, solution: LoopFields | None = None
) -> list[ExactCurve]:
    """What is known of a scene without a mesh, as `SceneSettings.exact`; often that is nothing."""
    return list(_of_scene(settings).exact(problem, solution))


def points_of(settings: Settings, name: str) -> Rows:
    """Points that stand for the preset of a curve setting: where a table of one's own begins.

    They are linear in between; or rows, of a table of more columns.
    """
    return _of_scene(settings).rows(name)


def left_out(settings: Settings) -> list[str]:
    """What a run does not see of the tables of its settings, a sentence each."""
    return list(_of_scene(settings).left_out())


def chief_of(settings: type[Settings]) -> Sequence[str]:
    """Settings that a scene is about, in the order in which one thinks of them."""
    assert issubclass(settings, SceneSettings)
    return settings.chief()


def loads_of(settings: Settings) -> Sequence[str]:
    """Settings that say how much a scene is loaded; the first that applies counts."""
    return _of_scene(settings).LOADS


def mesh_of(settings: Settings) -> Sequence[str]:
    """Settings that say how many elements there are."""
    return _of_scene(settings).MESH


def ends_of(settings: Settings) -> Mapping[str, int]:
    """Largest numbers of parts that other settings leave, by the name of their setting."""
    return _of_scene(settings).ends


def behind(settings: Settings) -> Mapping[str, str]:
    """Settings that place or scale what acts on a scene, by what they are behind."""
    return _of_scene(settings).behind()
