"""Settings read from text and files, and results written to files."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from solver.curves import messages, read_tables
from solver.definitions import CurveParameter, SettingError, parse
from solver.discrete.inside import Inside
from solver.disk import LARGEST, TOO_LARGE, read_text, whole_file, why
from solver.latin import Iterate, Solution
from solver.reduction.basis import Reduction
from solver.reference.distance import determinate_forces, held_instants
from solver.remarks import remarks_on
from solver.scenes import CATALOGUE
from solver.settings import Settings


def settings_from_toml(text: str, source: str = "settings file") -> Settings:
    """Read a saved settings file, whose curves name no other files.

    Parameters
    ----------
    text
        TOML: a scene's name under `scene`, and settings by name.
    source
        Where the text comes from, used in messages.

    Raises
    ------
    SettingError
        For text that is no TOML, an unknown scene, or a refused setting.
    """
    kind, values = _scene_and_values(text, source)
    return kind.checked(values)


def _scene_and_values(text: str, source: str) -> tuple[type[Settings], dict[str, object]]:
    if len(text) > LARGEST:
        raise SettingError(source, text[:60], "TOML", TOO_LARGE)
    try:
        values = tomllib.loads(text)
    except (ValueError, RecursionError) as problem:
        raise SettingError(source, text, "TOML", f"mend it: {problem}") from None
    return scene_settings(values.pop("scene", None)), values


def settings_from_command(
    scene: str, assignments: Sequence[str]
) -> tuple[Settings, Mapping[str, str]]:
    """Read settings from a scene's name or a saved file, and `NAME=VALUE` texts over it.

    Returns
    -------
    The settings, and what was understood of tables in CSV files, by the name of their setting.
    Such files are sought beside the saved file, and those of assignments in the working folder.
    """
    settings, tables = None, {}
    if scene.endswith(".toml"):
        path = Path(scene)
        try:
            kind, values = _scene_and_values(read_text(path), f"settings file {scene}")
        except (OSError, UnicodeDecodeError) as problem:
            raise SettingError(
                "settings file", scene, "a readable TOML file", why(problem)
            ) from None
        tables = read_tables(kind, values, path.parent)
        settings = kind.checked(values)
    else:
        kind = scene_settings(scene)
    changes: dict[str, object] = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise SettingError("--set", assignment, "NAME=VALUE", "write an equals sign")
        changes[name] = parse(text) if name in kind.definitions() else text
        tables.pop(name, None)
    tables |= read_tables(kind, changes, Path())
    settings = settings.replace(**changes) if settings else kind.checked(changes)
    return settings, messages(tables, settings)


def remarks(settings: Settings, assignments: Sequence[str]) -> list[str]:
    """Say what of these settings a run does not heed: idle ones, and load tables that go on."""
    idle = settings.usual("paper")
    found = [
        f"{name} does nothing with the other settings as they are"
        for name in dict.fromkeys(assignment.partition("=")[0] for assignment in assignments)
        if not settings.applies(name) and getattr(settings, name) != idle[name]
    ]
    duration = settings.duration
    return found + [
        f"{name} goes on to {end:g} s, but the run ends at {duration:g} s: "
        f"set duration={end:g} to run all of it"
        for name, end in ends_of_tables(settings).items()
        if end > duration
    ]


def ends_of_tables(settings: Settings) -> dict[str, float]:
    """Give the last time, s, of every load path that is a table, by the name of its setting."""
    values = settings.values()
    return {
        name: values[name][-1][0]
        for name, definition in settings.definitions().items()
        if isinstance(definition, CurveParameter)
        and definition.abscissa == "time"
        and isinstance(values[name], tuple)
        and settings.applies(name)
    }


def scene_settings(scene: object) -> type[Settings]:
    """Find the settings of a scene by its name in the catalogue."""
    if not isinstance(scene, str) or scene not in CATALOGUE:
        raise SettingError("scene", scene, ", ".join(CATALOGUE), "choose one of these")
    return CATALOGUE[scene].settings


def summary(settings: Settings, solution: Solution) -> dict[str, Any]:
    """Give the key figures of a finished run."""
    last = solution.records[-1] if solution.records else None
    return {
        "scene": settings.scene,
        "status": str(solution.status.ending),
        "advice": solution.status.advice,
        "remarks": remarks_on(settings, solution.iterate),
        "iterations": solution.iterate.iterations,
        "indicator": last.indicator if last else None,
        "behaviour": last.behaviour if last else None,
        "estimated_error": last.estimated_error if last else None,
        "certified": solution.is_certified,
        "residual": solution.iterate.residual,
        "error_displacement": last.error_displacement if last else None,
        "error_force": last.error_force if last else None,
        "seconds": last.seconds if last else solution.iterate.seconds,
        **_bases(solution.iterate.reduction),
    }


def _bases(reduction: Reduction | None) -> dict[str, int]:
    if reduction is None:
        return {}
    return {
        "modes_largest": max(entry.modes for entry in reduction.records),
        "modes_stored": reduction.stored,
        "modes_saved": reduction.saved,
    }


def result_arrays(settings: Settings, solution: Solution) -> Mapping[str, Any]:
    """Give the arrays of a result file (SI; space first, time last).

    Along rods `displacement` is that of the degrees of freedom at `x`, body after body;
    `friction_force` and `status` are those of the points of all interfaces with friction, one after
    the other. In the plane there are all nodes `x`, (n_nodes, 2), the nodes of `elements`,
    (n_elements, 4), and their `displacement`, (n_nodes, 2, n_instants); `displacement_determinate`,
    (n_instants,), is false where nothing says where a body lies. Interfaces between bodies, or that
    may open, have arrays of their own (`interface_arrays`).

    With separated bases also pgd_modes, pgd_added, pgd_updated, pgd_enriched and pgd_dropped,
    shape (n_iterations, n_substructures), as in `ReductionRecord`.
    """
    iterate, problem = solution.iterate, solution.iterate.problem
    history: dict[str, list[Any]] = {
        "indicator": [entry.indicator for entry in solution.records],
        "behaviour": [entry.behaviour for entry in solution.records],
        "estimated_error": [entry.estimated_error for entry in solution.records],
        "seconds": [entry.seconds for entry in solution.records],
        "error_displacement": [entry.error_displacement for entry in solution.records],
        "error_force": [entry.error_force for entry in solution.records],
    }
    if iterate.reduction is not None:
        for name in ("modes", "added", "updated", "enriched", "dropped"):
            history[f"pgd_{name}"] = [
                [getattr(part, name) for part in entry.reduction] for entry in solution.records
            ]
    return {
        "t": problem.instants,
        **(
            _on_lines(iterate) if problem.inside is None else _in_the_plane(problem.inside, iterate)
        ),
        **interface_arrays(iterate),
        **{name: np.array(column) for name, column in history.items()},
        "certified": solution.is_certified,
        "residual": math.nan if iterate.residual is None else iterate.residual,
        "settings": json.dumps({"scene": settings.scene, **settings.values()}),
    }


def _on_lines(iterate: Iterate) -> dict[str, Any]:
    return {
        "x": iterate.problem.positions,
        "displacement": iterate.displacement,
        "friction_force": iterate.friction_force,
        "determinate": determinate_forces(iterate.problem),
        "status": iterate.status,
    }


def _in_the_plane(inside: Inside, iterate: Iterate) -> dict[str, Any]:
    return {
        "x": inside.nodes,
        "elements": inside.elements,
        "displacement": inside.displacement(iterate.displacement, slice(None)),
        "displacement_determinate": held_instants(iterate.problem, iterate.contact_force),
    }


def interface_arrays(iterate: Iterate) -> dict[str, Any]:
    """Give the arrays `interface/NAME/...` of all interfaces but a lone support of known bound.

    `points` are places along the interface, m; `determinate` tells where the force is no arbitrary
    share of what a support or a ring of contacts carries; the others are as in `ContactFields`,
    shape (n_points, n_instants), with the opening as `gap`. Forces are in N, on the body above.
    """
    found: dict[str, Any] = {}
    determinate = determinate_forces(iterate.problem)
    for name, law in iterate.problem.rubbing.items():
        if law.is_plain and len(iterate.problem.rubbing) == 1:
            continue
        fields = iterate.contact(name)
        *_, tangential = iterate.problem.contact_places[name]
        own = {
            "points": law.positions,
            "determinate": determinate[tangential],
            "normal_force": fields.normal_force,
            "tangential_force": fields.tangential_force,
            "gap": fields.opening,
            "slip": fields.slip,
            "status": fields.status,
        }
        found |= {
            f"interface/{name}/{key}": field for key, field in own.items() if field is not None
        }
    return found


def save_result(path: Path, settings: Settings, solution: Solution) -> None:
    """Write a result file (npz), complete or not at all."""
    with whole_file(path, "wb") as file:
        np.savez_compressed(file, **result_arrays(settings, solution))
