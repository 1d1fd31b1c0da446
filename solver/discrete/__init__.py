"""From a scene to a discrete problem."""

from dataclasses import replace

from solver.discrete.bar import discretise_bar
from solver.discrete.problem import Problem
from solver.discrete.stack import discretise_stack
from solver.discrete.strand import discretise_strand
from solver.laws import Friction
from solver.laws.compliant import CompliantFriction
from solver.scenes.bar import BarSettings, bar
from solver.scenes.block import BlockSettings, block
from solver.scenes.layers import LayersSettings, layers
from solver.scenes.strand import StrandSettings, strand
from solver.settings import Settings


def discretise(settings: Settings) -> Problem:
    """Make the discrete problem that checked settings describe."""
    return _with_law(settings, _discretise(settings))


def _with_law(settings: Settings, problem: Problem) -> Problem:
    """Give all friction the law of the settings."""
    if settings.friction_law == "coulomb":
        return problem
    length = problem.scales.displacement
    laws = {
        name: CompliantFriction.of(law, settings.contact_stiffness, length)
        if isinstance(law, Friction)
        else law
        for name, law in problem.interfaces.items()
    }
    return replace(problem, interfaces=laws)


def _discretise(settings: Settings) -> Problem:
    match settings:
        case BarSettings():
            return discretise_bar(bar(settings))
        case BlockSettings():
            return discretise_stack(block(settings))
        case LayersSettings():
            return discretise_stack(layers(settings))
        case StrandSettings():
            return discretise_strand(strand(settings))
        case _:
            raise TypeError(f"no discretisation for the settings of {settings.scene!r}")


def coarser_problems(settings: Settings) -> list[Problem]:
    """Make the discrete problems of the same scene, uncut, on ever coarser meshes.

    Returns
    -------
    The finest first; none where the scene's own mesh is as coarse as makes sense.
    """
    found = []
    if isinstance(settings, BarSettings):
        scene = bar(settings).coarser()
        while scene is not None:
            found.append(_with_law(settings, discretise_bar(scene)))
            scene = scene.coarser()
    elif isinstance(settings, StrandSettings):
        coarse = settings.coarser()
        while coarse is not None:
            found.append(_with_law(settings, discretise_strand(strand(coarse))))
            coarse = coarse.coarser()
    return found


__all__ = ["Problem", "coarser_problems", "discretise"]
