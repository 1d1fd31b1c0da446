"""From a scene to a discrete problem."""

from solver.discrete.bar import discretise_bar
from solver.discrete.problem import Problem
from solver.scenes.bar import BarSettings, bar
from solver.settings import Settings


def discretise(settings: Settings) -> Problem:
    """Make the discrete problem that checked settings describe."""
    match settings:
        case BarSettings():
            return discretise_bar(bar(settings))
        case _:
            raise TypeError(f"no discretisation for the settings of {settings.scene!r}")


def coarser_problems(settings: Settings) -> list[Problem]:
    """Make the discrete problems of the same scene, uncut, on ever coarser meshes.

    Returns
    -------
    The finest first; none where the scene's own mesh is as coarse as makes sense.
    """
    match settings:
        case BarSettings():
            found = []
            scene = bar(settings).coarser()
            while scene is not None:
                found.append(discretise_bar(scene))
                scene = scene.coarser()
            return found
        case _:
            raise TypeError(f"no discretisation for the settings of {settings.scene!r}")


__all__ = ["Problem", "coarser_problems", "discretise"]
