"""What the worker gives to be saved: tables, a page, and an instant for other solvers."""

from __future__ import annotations

import io
from base64 import b64encode
from collections.abc import Callable

from app.picture.shown import has_reference
from app.views.scene import Scene
from app.worker.offline import OFFLINE
from app.worker.tables import TABLES, table
from solver.refusal import RefusedError
from solver.study.other_programs.fclib import contacts_of, instant_at, local_problem, write_fclib

FCLIB = "fclib"
KINDS = *TABLES, OFFLINE, FCLIB
"""What there is to be saved."""


def file_of(what: str, scene: Scene, offline: Callable[[], str]) -> list[str]:
    """Give name and text of a file: one of `KINDS`; what is no text, in base 64.

    Parameters
    ----------
    what, scene
        Which file, and of what.
    offline
        Writes a page.

    Raises
    ------
    RefusedError
        Where the instant is no problem that FCLIB has, or too large for a page.
    """
    name = f"slipfront-{scene.run.settings.scene}"
    if what == OFFLINE:
        return [f"{name}.html", offline()]
    if what == FCLIB:
        return [f"{name}.hdf5", _fclib(scene)]
    return [f"{name}-{what}.csv", table(what, scene)]


def _fclib(scene: Scene) -> str:
    """Write the contact problem of the instant that is looked at, HDF5 in base 64."""
    settings, iterate = scene.run.settings, scene.frame.iterate
    problem = iterate.problem
    if not has_reference(settings):
        can = "python -m solver fclib writes it"
        raise RefusedError("FCLIB", "so many points of contact", "less on a page", can)
    instant = instant_at(float(scene.run.stand.instants[scene.instant]), problem.instants)
    local = local_problem(
        contacts_of(problem),
        iterate,
        instant,
        settings.scene,
        certified=iterate.residual is not None,
    )
    file = io.BytesIO()
    write_fclib(file, local)
    return b64encode(file.getvalue()).decode()
