"""The law of friction that the settings choose, put in the place of Coulomb's."""

from __future__ import annotations

from dataclasses import replace

from solver.discrete.problem import Problem
from solver.laws import Friction
from solver.laws.compliant import CompliantFriction
from solver.scenes.base import SceneSettings
from solver.settings import Settings


def is_coulomb(settings: Settings) -> bool:
    """Tell whether points stick until they slip."""
    assert isinstance(settings, SceneSettings)
    return bool(settings.friction_law == "coulomb")


def with_friction_law(problem: Problem, settings: Settings) -> Problem:
    """Give all plain friction the law of the settings."""
    assert isinstance(settings, SceneSettings)
    if is_coulomb(settings):
        return problem
    length = problem.scales.displacement
    laws = {
        name: CompliantFriction.of(law, settings.contact_stiffness, length)
        if type(law) is Friction
        else law
        for name, law in problem.interfaces.items()
    }
    return replace(problem, interfaces=laws)
