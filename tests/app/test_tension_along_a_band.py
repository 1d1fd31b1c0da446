"""The tension along a band is shown as the axial force of rods is."""

from __future__ import annotations

import numpy as np
import pytest

from app.messages import Needs
from app.views.rope import AxialForces
from app.worker.extras import EXTRAS, Sampled
from solver.latin import solve
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of


def shown(scene):
    """The extra of a small run of a scene, its settings, and the shown instants."""
    settings = CATALOGUE[scene].checked(dict(CATALOGUE[scene].SMALL))
    problem = discretise(settings)
    iterate = solve(problem, method_of(settings)).iterate
    columns = np.arange(0, problem.n_instants, 3)
    loop = settings.structure().loop(problem)
    sampled = Sampled(problem, settings, loop, columns)
    return EXTRAS["axial force"](sampled, iterate, Needs()), settings, columns


def test_the_tension_along_a_band_begins_and_ends_with_that_of_its_ends():
    extra, settings, columns = shown("belt")
    assert AxialForces.applies(settings)
    assert extra["force"].shape == (1, len(extra["x"]), len(columns))
    ends = extra["force"][0, [0, -1]]
    known = np.stack([settings.tail_tension, settings.tension])[:, columns]
    assert ends == pytest.approx(known, rel=1e-3, abs=1e-3)
    assert extra["x"][-1] == pytest.approx(settings.curve.length)
    assert np.all(np.diff(extra["x"]) > 0.0)


def test_bodies_without_an_axis_show_no_axial_force():
    extra, settings, _ = shown("incline")
    assert extra is None
    assert not AxialForces.applies(settings)
