"""Settings in text and files: read, changed by a command, and written."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from solver.files.curves import messages, read_tables
from solver.files.meshes import read_meshes
from solver.files.toml_files import parse_toml, read_toml, require
from solver.files.typed import typed_numbers, typed_value
from solver.refusal import Words
from solver.scenes import CATALOGUE
from solver.settings.scene import Settings
from solver.settings.values import SettingError

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
    values = parse_toml(data, "the settings file", source)
    kind, number = head_of(values)
    settings = kind.checked(typed_numbers(values, kind.definitions()))
    return settings, meant_before(settings, values, number)


def head_of(values: dict[str, Any]) -> tuple[type[Settings], int]:
    """Settings of the scene of a file, and the number of its format, 1 if missing.

    They are removed from the values of the file, and so is a case: settings are left.
    """
    values.pop("case", None)
    number = values.pop("format", 1)
    require(
        isinstance(number, int) and 1 <= number <= FORMAT,
        "format",
        number,
        f"a whole number from 1 to {FORMAT}",
        "the file is of a later version: update Slipfront, or save the settings again",
    )
    return scene_settings(values.pop("scene", None)), number


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
    values: dict[str, Any] = {"scene": scene, "format": FORMAT}
    if scene.endswith(".toml"):
        values = read_toml(Path(scene), "settings file")
    kind, number = head_of(values)
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
