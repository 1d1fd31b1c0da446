"""Case of the trade: a question, the run that answers it, and a known number."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from solver.files.saved import (
    check_controls,
    check_keys,
    fields_in,
    format_in,
    placed,
    read_toml,
    require,
    scene_settings,
)
from solver.settings.definitions import SettingError
from solver.settings.scene import Icon, Settings
from solver.study.quantities import reading
from solver.study.quantities.quantity import Quantity


@dataclass(frozen=True, eq=False)
class Case:
    """A case by its file, whose name it has (`cases/README.md` explains the keys)."""

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
        format_in(values)
        kind = scene_settings(values.pop("scene", None))
        entries = values.pop("case", None)
        if not isinstance(entries, dict):
            raise SettingError(
                "case", entries, "a table", "write [case] below the settings"
            )
        settings = kind.checked(values)
        with placed("case"):
            # A case without a picture of its own has that of its scene.
            entries = {"picture": settings.icon._asdict(), **entries}
            fields = fields_in(Case, entries, quantity=str, picture=dict)
            tolerance = fields["tolerance"]
            is_share = 0.0 < tolerance < 1.0
            can = "a share above 0 and below 1"
            remedy = "say what the mesh leaves"
            require(is_share, "tolerance", tolerance, can, remedy)
            check_controls(fields["controls"], settings)
            check_keys(fields["picture"], dict.fromkeys(Icon._fields, str))
            fields["quantity"] = reading(fields["quantity"])
            fields["picture"] = Icon(**fields["picture"])
        return Case(name=path.stem, settings=settings, **fields)


def all_cases() -> list[Case]:
    """Read all cases of the folder `cases`, in their order."""
    files = Path(__file__).with_name("cases").glob("*.toml")
    cases = [case_from_file(file) for file in files]
    return sorted(cases, key=lambda case: case.order)
