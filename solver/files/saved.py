"""Settings read from text and files, and results written to files."""

from __future__ import annotations

import contextlib
import json
import math
import tomllib
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import MISSING, fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from solver.files.curves import messages, read_tables
from solver.files.disk import LARGEST, TOO_LARGE, read_bytes, whole_file
from solver.latin import Iterate, Solution
from solver.reference.distance import determinate_forces, held_instants
from solver.scenes import CATALOGUE
from solver.scenes.remarks import remarks_on
from solver.settings.definitions import SettingError, parse
from solver.settings.scene import Settings

WORDS = {str: "text", int: "a whole number", list: "a list", dict: "a table"}
IN_FILES = {"str": str, "int": int, "float": (int, float), "tuple[str, ...]": list}
"""Types of values in a file, by those of the fields that they are for."""
INDICATORS = "indicator", "behaviour", "estimated_error"
ERRORS = "error_displacement", "error_force"
"""What is known of every iteration, beside its time; errors where there is a
reference."""
FORMAT = 2
"""Number of the format of settings files. Files of before the second have none: in them
the slip of a fault is that of one of its sides."""


def settings_from_toml(text: str, source: str = "settings file") -> Settings:
    """Settings of a saved file in TOML, as `read_settings`."""
    return read_settings(text, source)[0]


def read_settings(text: str, source: str) -> tuple[Settings, Mapping[str, str]]:
    """Settings of a saved file in TOML, and what to know of those that once meant something else.

    The latter by the name of the setting. The file has a scene's name under `scene`,
    and settings by name; its curves name no other files; messages begin with its
    source.
    """
    values = _parsed(text, source, text)
    values.pop("case", None)
    number = format_in(values)
    settings = scene_settings(values.pop("scene", None)).checked(values)
    return settings, meant_before(settings, values, number)


def format_in(values: dict[str, Any]) -> int:
    """Take the number of the format out of the content of a settings file; 1 where it has none."""
    number = values.pop("format", 1)
    remedy = (
        "the file is of a later version: update Slipfront, or save the settings again"
    )
    is_known = isinstance(number, int) and 1 <= number <= FORMAT
    require(is_known, "format", number, f"a whole number from 1 to {FORMAT}", remedy)
    return int(number)


def meant_before(
    settings: Settings, given: Collection[str], number: int
) -> Mapping[str, str]:
    """What to know of given settings that meant something else in a format, by their names."""
    if number >= FORMAT:
        return {}
    changed = settings.changed_meanings()
    return {name: message for name, message in changed.items() if name in given}


def dump(settings: Settings) -> str:
    """Text of a TOML file of settings, which every front reads."""
    lines = [
        f"{name} = {json.dumps(value)}" for name, value in settings.values().items()
    ]
    head = [f"scene = {json.dumps(settings.scene)}", f"format = {FORMAT}"]
    return "\n".join([*head, *lines, ""])


def settings_from_command(
    scene: str, assignments: Sequence[str]
) -> tuple[Settings, Mapping[str, str]]:
    """Settings of a scene or a saved file, with `NAME=VALUE` texts over it, and what to know.

    CSV files that it names are sought beside the saved file, and those of assignments
    in the working folder; what was understood of them is by the name of their setting,
    and so is what those of the file meant that once meant something else.
    """
    values: dict[str, Any] = {"scene": scene}
    number = FORMAT
    if scene.endswith(".toml"):
        values = read_toml(Path(scene), "settings file")
        values.pop("case", None)
        number = format_in(values)
    kind = scene_settings(values.pop("scene", None))
    tables = read_tables(kind, values, Path(scene).parent)
    changes: dict[str, object] = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise SettingError(
                "--set", assignment, "NAME=VALUE", "write an equals sign"
            )
        if name in kind.definitions():
            changes[name] = parse(text)
        else:
            changes[name] = text
        tables.pop(name, None)
    tables |= read_tables(kind, changes, Path())
    settings = kind.checked(values).replace(**changes)
    told = dict(messages(tables, settings))
    for name, message in meant_before(
        settings, values.keys() - changes, number
    ).items():
        if name in told:
            told[name] = f"{told[name]}; {message}"
        else:
            told[name] = message
    return settings, told


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Content of a file in TOML; one that is none is refused as what it is to be, its `kind`."""
    refuse = partial(SettingError, kind, str(path), "a file that can be read")
    return _parsed(read_bytes(path, refuse), kind, str(path))


def _parsed(data: bytes | str, name: str, shown: str) -> dict[str, Any]:
    if len(data) > LARGEST:
        raise SettingError(name, shown[:60], "TOML", TOO_LARGE)
    try:
        return tomllib.loads(
            data if isinstance(data, str) else data.decode("utf-8-sig")
        )
    except (ValueError, RecursionError) as problem:
        reason = " ".join(str(problem).split())
        raise SettingError(name, shown, "TOML", f"mend it: {reason}") from None


def check_keys(
    values: Mapping[str, Any], keys: Mapping[str, Any], optional: Collection[str] = ()
) -> None:
    """Refuse keys that there are not, keys that lack, and values of a wrong type."""
    known = ", ".join(keys)
    for name, value in values.items():
        if name not in keys:
            raise SettingError(name, value, known, "there is no such key: leave it out")
        if not isinstance(value, keys[name]) or isinstance(value, bool):
            raise SettingError(
                name, value, WORDS.get(keys[name], "a number"), "mend the value"
            )
    for name in keys:
        if name not in values and name not in optional:
            raise SettingError(name, None, known, "this key is needed: write it")


def fields_in(kind: Any, values: Mapping[str, Any], **others: Any) -> dict[str, Any]:
    """Values of the fields of a dataclass that a table has as its keys, with lists as tuples.

    What has a default may be left out; its name is not in the table. `others` are the
    types of keys that are no fields, or are kept otherwise. Keys are refused as by
    `check_keys`, and lists of anything but texts.
    """
    own = {field.name: field for field in fields(kind) if field.name != "name"}
    keys = {
        name: IN_FILES[field.type]
        for name, field in own.items()
        if field.type in IN_FILES
    }
    optional = [name for name, field in own.items() if field.default is not MISSING]
    check_keys(values, keys | others, optional)
    found = dict(values)
    for name in keys.keys() & found.keys():
        if own[name].type == "tuple[str, ...]" and name not in others:
            texts = found[name] = tuple(found[name])
            are_texts = bool(texts) and all(
                isinstance(text, str) and text for text in texts
            )
            can = "a list of texts, at least one"
            require(are_texts, name, list(texts), can, "write them in quotes")
    return found


def require(is_met: bool, name: str, value: object, allowed: str, remedy: str) -> None:
    """Refuse a value that does not meet what is required of it."""
    if not is_met:
        raise SettingError(name, value, allowed, remedy)


def check_controls(names: Sequence[str], settings: Settings) -> None:
    """Refuse controls that are no settings, or do nothing beside the others."""
    working = [name for name in settings.definitions() if settings.applies(name)]
    for name in names:
        remedy = "name a setting that does something here"
        require(name in working, "controls", name, ", ".join(working), remedy)


@contextlib.contextmanager
def placed(place: str) -> Iterator[None]:
    """Put the file, or the place in it, before what is refused in it."""
    try:
        yield
    except SettingError as refusal:
        name = f"{place}: {refusal.name}"
        raise SettingError(
            name, refusal.value, refusal.allowed, refusal.remedy
        ) from None


def scene_settings(scene: object) -> type[Settings]:
    """Settings of a scene by its name in the catalogue."""
    if not isinstance(scene, str) or scene not in CATALOGUE:
        raise SettingError("scene", scene, ", ".join(CATALOGUE), "choose one of these")
    return CATALOGUE[scene]


def summary(settings: Settings, solution: Solution) -> dict[str, Any]:
    """Key figures of a finished run."""
    if solution.records:
        last = solution.records[-1]
    else:
        last = None
    return {
        "scene": settings.scene,
        "status": str(solution.status.ending),
        "advice": solution.status.advice,
        "remarks": remarks_on(settings, solution.iterate),
        "iterations": solution.iterate.iterations,
        **{name: getattr(last, name, None) for name in INDICATORS},
        "certified": solution.is_certified,
        "residual": solution.iterate.residual,
        **{name: getattr(last, name, None) for name in ERRORS},
        "seconds": last.seconds if last else solution.iterate.seconds,
    }


def result_arrays(settings: Settings, solution: Solution) -> Mapping[str, Any]:
    """Arrays of a result file (SI; space first, time last), as solver/README.md, 12, has them.

    In the plane `displacement` has shape (n_nodes, 2, n_instants), and
    `displacement_determinate`, (n_instants,), is false where nothing says where a body
    lies.
    """
    iterate = solution.iterate
    problem = solution.iterate.problem
    history = {
        name: np.array([getattr(entry, name) for entry in solution.records])
        for name in (*INDICATORS, *ERRORS, "seconds")
    }
    if iterate.bases:
        history["pgd_modes"] = np.array([entry.modes for entry in solution.records])
    found: dict[str, Any]
    if problem.inside is None:
        found = {
            "x": problem.positions,
            "displacement": problem.at_rest(iterate.displacement),
            "friction_force": iterate.friction_force,
            "determinate": determinate_forces(problem),
            "status": iterate.status,
        }
    else:
        found = {
            "x": problem.inside.nodes,
            "elements": problem.inside.elements,
            "displacement": problem.inside.displacement(
                iterate.displacement, slice(None)
            ),
            "displacement_determinate": held_instants(problem, iterate.contact_force),
        }
    return {
        "t": problem.instants,
        **found,
        **interface_arrays(iterate),
        **history,
        "certified": solution.is_certified,
        "residual": math.nan if iterate.residual is None else iterate.residual,
        "settings": json.dumps({"scene": settings.scene, **settings.values()}),
    }


def interface_arrays(iterate: Iterate) -> dict[str, Any]:
    """Arrays `interface/NAME/...` of all interfaces but a lone support of known bound.

    `determinate` is where the force is no arbitrary share of what a support or a ring
    carries.
    """
    arrays: dict[str, Any] = {}
    determinate = determinate_forces(iterate.problem)
    for name, law in iterate.problem.rubbing.items():
        if law.is_plain and len(iterate.problem.rubbing) == 1:
            continue
        fields = iterate.contact(name)
        *_, tangential = iterate.problem.contact_places[name]
        entries = {
            "points": law.positions,
            "determinate": determinate[tangential],
            "normal_force": fields.normal_force,
            "tangential_force": fields.tangential_force,
            "gap": fields.opening,
            "slip": fields.slip,
            "status": fields.status,
        }
        arrays |= {
            f"interface/{name}/{key}": field
            for key, field in entries.items()
            if field is not None
        }
    return arrays


def save_result(path: Path, settings: Settings, solution: Solution) -> None:
    """Write a result file (npz), complete or not at all."""
    with whole_file(path, "wb") as file:
        np.savez_compressed(file, **result_arrays(settings, solution))
