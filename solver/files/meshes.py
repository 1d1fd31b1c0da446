"""Files of meshes for settings: their texts replace the names of the files."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

from solver.discrete.plane.makers.named_mesh_refused import check_named
from solver.files.disk import LARGEST, read_bytes, too_large
from solver.refusal import LONGEST, RefusedError, Words
from solver.scenes.mesh_files import ABAQUS, CAN, GMSH, HEAD, as_text, read_mesh
from solver.settings.definitions import TextParameter
from solver.settings.scene import Settings
from solver.settings.values import SettingError, allowed

MESHES = GMSH, ABAQUS
"""Ends of the names of meshes that a page opens: these have names of bodies and sides,
and are read without other files."""


def text_of_mesh(data: bytes, source: str, name: str = "mesh") -> str:
    """Text of the mesh in a file, as value of the setting `name`.

    Raises
    ------
    SettingError
        For a file that is refused.
    """
    if len(data) > LARGEST:
        raise SettingError(name, source, CAN, too_large())
    try:
        mesh = read_mesh(data, source)
        check_named(mesh)
        return as_text(mesh)
    except RefusedError as refusal:
        value = refusal.value
        file = _short(source)
        found = f"{file}: {refusal.name} {value}"
        if refusal.name == name:
            found = f"{file} {value}"
        if value == source:
            # A file that cannot be read is refused as a whole.
            found = source
        raise SettingError(
            name, Words(found), refusal.allowed, refusal.remedy
        ) from None


def _short(name: str) -> str:
    """Name of a file; of a long one its beginning and end."""
    if len(name) <= LONGEST:
        return name
    half = LONGEST // 2
    return f"{name[:half]}...{name[-half:]}"


def read_meshes(kind: type[Settings], values: dict[str, Any], folder: Path) -> None:
    """Read the files named by settings; texts replace the names in the values.

    Only fronts whose user owns the machine call this: elsewhere no file may be read.
    """
    for name, definition in kind.definitions().items():
        value = values.get(name)
        if not isinstance(definition, TextParameter) or not definition.is_file:
            continue
        if not isinstance(value, str) or value.startswith(HEAD):
            continue
        if value not in definition.presets:
            can = allowed(definition)
            data = read_bytes(folder / value, partial(SettingError, name, value, can))
            values[name] = text_of_mesh(data, value, name)
