"""The catalogue of scenes."""

from __future__ import annotations

from solver import discrete
from solver.discrete.loose_bodies import LooseBodiesError
from solver.discrete.problem import Problem
from solver.scenes.arch import ArchSettings
from solver.scenes.bar import BarSettings
from solver.scenes.belt import BeltSettings
from solver.scenes.block import BlockSettings
from solver.scenes.bundle import BundleSettings
from solver.scenes.fault import FaultSettings
from solver.scenes.incline import InclineSettings
from solver.scenes.layers import LayersSettings
from solver.scenes.mesh import MeshSettings
from solver.scenes.rope import RopeSettings
from solver.scenes.strand import StrandSettings
from solver.scenes.wall import WallSettings
from solver.settings.scene import Settings

CATALOGUE: dict[str, type[Settings]] = {
    settings.scene: settings
    for settings in (
        BarSettings,
        BlockSettings,
        FaultSettings,
        InclineSettings,
        LayersSettings,
        RopeSettings,
        StrandSettings,
        WallSettings,
        ArchSettings,
        BeltSettings,
        BundleSettings,
        MeshSettings,
    )
}


def discretise(settings: Settings) -> Problem:
    """Make the discrete problem of checked settings, with their loads and motions.

    Raises
    ------
    RefusedError
        For bodies that nothing holds, as where a mesh of one's own has too few sides
        that are held.
    """
    try:
        problem = discrete.discretise(settings.structure())
    except LooseBodiesError as refusal:
        raise settings.of_loose(refusal) from None
    return problem.with_drives(settings.drives())
