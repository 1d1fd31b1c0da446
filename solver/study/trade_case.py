"""A case of the trade: somebody's question, the run that answers it, and a number that is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from solver.definitions import SettingError
from solver.files import (
    check_controls,
    check_keys,
    fields_in,
    placed,
    read_toml,
    require,
    scene_settings,
)
from solver.settings import Icon, Settings
from solver.study.quantities import reading
from solver.study.quantities.quantity import Quantity


@dataclass(frozen=True, eq=False)
class Case:
    """A case as its file says, whose name it has (`cases/README.md` says what each is)."""

    name: str
    order: int
    title: str
    question: str
    source: str
    settings: Settings
    quantity: Quantity
    known: float
    tolerance: float
    formula: str
    how: str
    change: str
    controls: tuple[str, ...]
    picture: Icon
    views: tuple[str, ...] = ()


def case_from_file(path: Path) -> Case:
    """Read a case: a file of settings with a table `case`.

    The message of a refusal begins with the name of the file.
    """
    with placed(path.name):
        values = read_toml(path, "case")
        kind = scene_settings(values.pop("scene", None))
        entries = values.pop("case", None)
        if not isinstance(entries, dict):
            raise SettingError("case", entries, "a table", "write [case] below the settings")
        settings = kind.checked(values)
        with placed("case"):
            return _case(path.stem, settings, entries)


def all_cases() -> list[Case]:
    """Read all cases of the folder `cases`, in their order."""
    found = map(case_from_file, Path(__file__).with_name("cases").glob("*.toml"))
    return sorted(found, key=lambda case: case.order)


def _case(name: str, settings: Settings, entries: Mapping[str, Any]) -> Case:
    picture = {"picture": settings.icon._asdict(), **entries}["picture"]
    values = fields_in(Case, {**entries, "picture": picture}, quantity=str, picture=dict)
    tolerance, can = values["tolerance"], "a share above 0 and below 1"
    require(0.0 < tolerance < 1.0, "tolerance", tolerance, can, "say what the mesh leaves")
    check_controls(values["controls"], settings)
    check_keys(picture, dict.fromkeys(Icon._fields, str))
    values |= {"quantity": reading(values["quantity"]), "picture": Icon(**picture)}
    return Case(name=name, settings=settings, **values)
