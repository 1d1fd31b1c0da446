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
from typing import Any, get_type_hints

import numpy as np

from solver.files.curves import messages, read_tables
from solver.files.disk import LARGEST, read_bytes, too_large, whole_file
from solver.files.meshes import read_meshes
from solver.files.table_lines import text_of
from solver.files.typed import typed_numbers, typed_value
from solver.latin import Answer, Iterate, Solution
from solver.reference.distance import determinate_forces, held_instants
from solver.refusal import Words
from solver.scenes import CATALOGUE
from solver.scenes.remarks import remarks_on
from solver.settings.scene import Settings
from solver.settings.values import SettingError

WORDS = {
    str: "text",
    int: "a whole number",
    list: "a list",
    dict: "a table",
}
"""Words on the type of a value in a file; of all other types they are "a number"."""
TEXTS = tuple[str, ...]
IN_FILES: dict[Any, Any] = {
    str: str,
    int: int,
    float: (int, float),
    TEXTS: list,
}
"""Type of a value in a file, by the type of the field that the value is for."""
INDICATORS = (
    "indicator",
    "behaviour",
    "estimated_error",
)
"""Indicators of every iteration."""
ERRORS = (
    "error_displacement",
    "error_force",
)
"""Errors of every iteration where there is a reference."""
FORMAT = 2
"""Number of the format of settings files. Files of the first format have no number: in
them the slip of a fault is that of one of its sides."""


def settings_from_toml(text: str) -> Settings:
    """Settings of a saved file in TOML, as `read_settings`."""
    return read_settings(text, "a text")[0]


def read_settings(data: bytes | str, source: str) -> tuple[Settings, Mapping[str, str]]:
    """Settings of a saved file in TOML, and messages on settings with an older meaning.

    The messages stand under the names of the settings. The file has a scene's name
    under `scene`, and settings by name; its curves name no other files. A refusal of
    what is no TOML names the source.
    """
    values = _parsed(data, "the settings file", source)
    values.pop("case", None)
    number = format_in(values)
    kind = scene_settings(values.pop("scene", None))
    settings = kind.checked(typed_numbers(values, kind.definitions()))
    return settings, meant_before(settings, values, number)


def format_in(values: dict[str, Any]) -> int:
    """Remove the number of the format from the values of a file; 1 if missing."""
    number = values.pop("format", 1)
    require(
        isinstance(number, int) and 1 <= number <= FORMAT,
        "format",
        number,
        f"a whole number from 1 to {FORMAT}",
        "the file is of a later version: update Slipfront, or save the settings again",
    )
    return int(number)


def meant_before(
    settings: Settings, given: Collection[str], number: int
) -> Mapping[str, str]:
    """Messages on given settings that had another meaning in a format, by name."""
    if number >= FORMAT:
        return {}
    changed = settings.changed_meanings()
    return {name: message for name, message in changed.items() if name in given}


def dump(settings: Settings) -> str:
    """Text of a TOML file of settings, for page, command line and library."""
    lines = [
        f"{name} = {json.dumps(value)}" for name, value in settings.values().items()
    ]
    head = [f"scene = {json.dumps(settings.scene)}", f"format = {FORMAT}"]
    return "\n".join([*head, *lines, ""])


def settings_from_command(
    scene: str, assignments: Sequence[str]
) -> tuple[Settings, Mapping[str, str]]:
    """Settings of a scene or a saved file with `NAME=VALUE` changes, and messages.

    CSV files that a saved file names are sought beside that file, and those that an
    assignment names in the working folder. Messages stand under the names of settings:
    how a CSV file was understood, and which settings of a saved file had another
    meaning in its format.
    """
    values: dict[str, Any] = {"scene": scene}
    number = FORMAT
    if scene.endswith(".toml"):
        values = read_toml(Path(scene), "settings file")
        values.pop("case", None)
        number = format_in(values)
    kind = scene_settings(values.pop("scene", None))
    values = typed_numbers(values, kind.definitions())
    # Names of files are replaced by points before anything is checked.
    tables = read_tables(kind, values, Path(scene).parent)
    read_meshes(kind, values, Path(scene).parent)
    changes = _changes_in(assignments, kind)
    # A table that an assignment replaces has nothing to say any more.
    for name in changes:
        tables.pop(name, None)
    tables |= read_tables(kind, changes, Path())
    read_meshes(kind, changes, Path())
    # The file is checked by itself first, so that a refusal tells its faults from those
    # of changes.
    settings = kind.checked(values).replace(**changes)
    found = dict(messages(tables, settings))
    from_file = values.keys() - changes
    for name, message in meant_before(settings, from_file, number).items():
        if name in found:
            found[name] = f"{found[name]}; {message}"
        else:
            found[name] = message
    return settings, found


def _changes_in(assignments: Sequence[str], kind: type[Settings]) -> dict[str, object]:
    """Values of `NAME=VALUE` texts by name; values of unknown names stay texts."""
    changes: dict[str, object] = {}
    definitions = kind.definitions()
    for assignment in assignments:
        before, equals, text = assignment.partition("=")
        if not equals:
            raise SettingError(
                "--set", assignment, "NAME=VALUE", "write an equals sign"
            )
        name = before.strip()
        if not name:
            raise SettingError(
                "--set", assignment, "NAME=VALUE", "write a name before the sign"
            )
        if name in definitions:
            changes[name] = typed_value(text, name, definitions[name])
        else:
            changes[name] = text
    return changes


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """Read a file in TOML; refusals name the file by its `kind`."""
    refuse = partial(SettingError, kind, str(path), "a file that can be read")
    return _parsed(read_bytes(path, refuse), kind, str(path))


def _parsed(data: bytes | str, name: str, shown: str) -> dict[str, Any]:
    """Parse a text in TOML; refusals have the name `name`, and show `shown`."""
    if len(data) > LARGEST:
        raise SettingError(name, shown, "TOML", too_large())
    refuse = partial(SettingError, name, shown, "TOML")
    text = text_of(data, refuse, "save the settings again")
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as problem:
        reason = " ".join(str(problem).split())
        raise refuse(f"mend it: {reason}") from None


def check_keys(
    values: Mapping[str, Any], keys: Mapping[str, Any], optional: Collection[str] = ()
) -> None:
    """Refuse unknown keys, missing keys, and values of a wrong type."""
    known = ", ".join(keys)
    for name, value in values.items():
        if name not in keys:
            raise SettingError(name, value, known, "there is no such key: leave it out")
        # True is an instance of int in Python, and no number here.
        if not isinstance(value, keys[name]) or isinstance(value, bool):
            raise SettingError(
                name, value, WORDS.get(keys[name], "a number"), "mend the value"
            )
    for name in keys:
        if name not in values and name not in optional:
            raise SettingError(name, None, known, "this key is needed: write it")


def fields_in(kind: Any, values: Mapping[str, Any], **others: Any) -> dict[str, Any]:
    """Values of the fields of a dataclass from a table's keys, with lists as tuples.

    The table has no key `name`, and may leave out fields with a default. `others` are
    the types of keys that are no fields, or whose values have another type in the file.
    Keys are refused as by `check_keys`, and lists of anything but texts.
    """
    # Types of fields are texts in modules with postponed annotations.
    types = get_type_hints(kind)
    keys = {}
    optional = []
    for field in fields(kind):
        if field.name == "name":
            continue
        if types[field.name] in IN_FILES:
            keys[field.name] = IN_FILES[types[field.name]]
        if field.default is not MISSING:
            optional.append(field.name)
    check_keys(values, keys | others, optional)
    found = dict(values)
    for name in keys.keys() & found.keys():
        if types[name] == TEXTS and name not in others:
            found[name] = _texts_in(found[name], name)
    return found


def _texts_in(values: Sequence[object], name: str) -> tuple[str, ...]:
    """Texts in a list under a key; refuse an empty list and other values."""
    texts = [value for value in values if isinstance(value, str)]
    require(
        len(values) > 0 and len(texts) == len(values) and all(texts),
        name,
        list(values),
        "a list of texts, at least one",
        "write them in quotes",
    )
    return tuple(texts)


def require(is_met: bool, name: str, value: object, allowed: str, remedy: str) -> None:
    """Refuse a value unless a requirement is met."""
    if not is_met:
        raise SettingError(name, value, allowed, remedy)


def check_controls(names: Sequence[str], settings: Settings) -> None:
    """Refuse controls that are no settings, or do not apply."""
    applying = [name for name in settings.definitions() if settings.applies(name)]
    for name in names:
        remedy = "name a setting that does something here"
        require(name in applying, "controls", name, ", ".join(applying), remedy)


@contextlib.contextmanager
def placed(place: str) -> Iterator[None]:
    """Context that puts a file, or a place in a file, before names in refusals."""
    try:
        yield
    except SettingError as refusal:
        name = f"{place}: {refusal.name}"
        raise SettingError(
            name, refusal.value, refusal.allowed, refusal.remedy
        ) from None


def scene_settings(scene: object) -> type[Settings]:
    """Settings of a scene by its name in the catalogue.

    Raises
    ------
    SettingError
        For a name that no scene has.
    """
    if scene is None:
        scene = Words("missing")
    if not isinstance(scene, str) or scene not in CATALOGUE:
        raise SettingError("scene", scene, ", ".join(CATALOGUE), "choose one of these")
    return CATALOGUE[scene]


def summary(settings: Settings, solution: Solution) -> dict[str, Any]:
    """Key figures of a finished run."""
    last = None
    seconds = solution.iterate.seconds
    if solution.records:
        last = solution.records[-1]
        seconds = last.seconds
    figures = {
        "scene": settings.scene,
        "status": str(solution.status.ending),
        "advice": solution.status.advice,
        "remarks": remarks_on(settings, solution.iterate),
        "iterations": solution.iterate.iterations,
    }
    for name in INDICATORS:
        figures[name] = getattr(last, name, None)
    figures["certified"] = solution.is_certified
    figures["residual"] = None
    if isinstance(solution.iterate, Answer):
        figures["residual"] = solution.iterate.residual
    for name in ERRORS:
        figures[name] = getattr(last, name, None)
    figures["seconds"] = seconds
    return figures


def result_arrays(settings: Settings, solution: Solution) -> Mapping[str, Any]:
    """Arrays of a result file (SI; space first, time last; solver/README.md, 12).

    In the plane `displacement` has shape (n_nodes, 2, n_instants), and
    `displacement_determinate`, (n_instants,), is false at instants at which nothing
    determines the position of a body.
    """
    iterate = solution.iterate
    residual = math.nan
    if isinstance(iterate, Answer):
        residual = iterate.residual
    arrays: dict[str, Any] = {"t": iterate.problem.instants}
    arrays |= _body_arrays(iterate)
    arrays |= interface_arrays(iterate)
    arrays |= _history_arrays(solution)
    arrays["certified"] = solution.is_certified
    arrays["residual"] = residual
    arrays["settings"] = json.dumps({"scene": settings.scene, **settings.values()})
    return arrays


def _body_arrays(iterate: Iterate) -> dict[str, Any]:
    """Arrays of bodies: of nodes along rods, or of nodes and elements in the plane."""
    problem = iterate.problem
    # Along rods every node is an unknown; in the plane inner nodes are condensed, and
    # follow from the sides.
    inside = problem.inside
    if inside is None:
        return {
            "x": problem.positions,
            "displacement": problem.absolute(iterate.displacement),
            "friction_force": iterate.friction_force,
            "determinate": determinate_forces(problem),
            "status": iterate.status,
        }
    return {
        "x": inside.nodes,
        "elements": inside.elements,
        "displacement": inside.displacement(iterate.displacement, slice(None)),
        "displacement_determinate": held_instants(problem, iterate.contact_force),
    }


def _history_arrays(solution: Solution) -> dict[str, Any]:
    """Arrays of figures of every iteration, each of shape (n_iterations,)."""
    names = [*INDICATORS, *ERRORS, "seconds"]
    arrays = {}
    for name in names:
        arrays[name] = np.array([getattr(entry, name) for entry in solution.records])
    if solution.iterate.bases:
        arrays["pgd_modes"] = np.array([entry.modes for entry in solution.records])
    return arrays


def interface_arrays(iterate: Iterate) -> dict[str, Any]:
    """Arrays `interface/NAME/...` of all interfaces, except a single rod's.

    `determinate`, (n_points,), is false at points whose force is an arbitrary share of
    the total that a support or a ring of bodies carries.
    """
    arrays: dict[str, Any] = {}
    determinate = determinate_forces(iterate.problem)
    contacts = iterate.problem.contacts
    positions = contacts.of_points([law.positions for law in contacts.laws.values()])
    # A single rod on its support has its fields under short names at the top level.
    is_plain = all(law.is_plain for law in contacts.laws.values())
    if is_plain and len(contacts) == 1:
        return arrays
    for name in contacts:
        fields = iterate.contact(name)
        *_, tangential = contacts.forces[name]
        entries = {
            "points": positions[contacts.points[name]],
            "determinate": determinate[tangential],
            "normal_force": fields.normal_force,
            "tangential_force": fields.tangential_force,
            "gap": fields.opening,
            "slip": fields.slip,
            "status": fields.status,
        }
        for key, field in entries.items():
            if field is not None:
                arrays[f"interface/{name}/{key}"] = field
    return arrays


def save_result(path: Path, settings: Settings, solution: Solution) -> None:
    """Write a result file (npz), complete or not at all."""
    with whole_file(path, "wb") as file:
        np.savez_compressed(file, **result_arrays(settings, solution))
