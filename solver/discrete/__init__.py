"""From a scene to a discrete problem."""

from solver.discrete.bar import discretise_bar
from solver.discrete.problem import Problem
from solver.discrete.stack import discretise_stack
from solver.scenes.bar import BarSettings, bar
from solver.scenes.block import BlockSettings, block
from solver.scenes.layers import LayersSettings, layers
from solver.settings import Settings


def discretise(settings: Settings) -> Problem:
    """Make the discrete problem that checked settings describe."""
    match settings:
        case BarSettings():
            return discretise_bar(bar(settings))
        case BlockSettings():
            return discretise_stack(block(settings))
        case LayersSettings():
            return discretise_stack(layers(settings))
        case _:
            raise TypeError(f"no discretisation for the settings of {settings.scene!r}")


__all__ = ["Problem", "discretise"]
