"""Which controls stand at the side, in which order, and what each says."""

from __future__ import annotations

from functools import cache
from typing import Any

from app.components.form import UNITS, item_of
from app.controls.comparing import CHOICES
from app.lessons.lesson import LESSONS
from app.picture.units import COOKIE, SYSTEMS
from solver.definitions import about
from solver.scenes import CATALOGUE, chief_of
from solver.settings import Settings

METHOD = "Method"
WHAT = (
    "What the scene is",
    (
        "Load",
        "Top",
        "Left",
        "Right",
        "Contact",
        "Bar",
        "Strand",
        "Body",
        "Body force",
    ),
)
HOW = "How it is solved", ("Decomposition", METHOD, "Stop")
SEEN = "What is seen"
"""Sheets, and the groups of settings in them, but for what the scene is about."""

# None of these is the name of a setting.
SCENE, LESSON, WARM = "the-scene", "the-lesson", "start-from-before"
VIEWS, COMPARE, BROUGHT, NOTE = "the-views", "compare", "brought", "note"
SCENE_ITEM: dict[str, Any] = {
    "name": SCENE,
    "kind": "scenes",
    "label": "Scene",
    "help": "What is solved; each scene keeps its settings until the page is closed.",
    "options": [[name, entry.title, list(entry.emblem)] for name, entry in CATALOGUE.items()],
}
LESSON_ITEM: dict[str, Any] = {
    "name": LESSON,
    "kind": "choice",
    "label": "Lesson",
    "help": "A question: predict the answer, change one thing, and see why.",
    "options": [
        ["none", ""],
        *([one.title, one.name, one.subject] for one in LESSONS.values()),
    ],
}
COMPARE_ITEM: dict[str, Any] = {
    "name": COMPARE,
    "kind": "choice",
    "label": "Compare with",
    "help": "Two runs in step, on the same axes. Keep the present settings as run A and change "
    "those of run B, or choose a pair.",
    "options": [[title, name] for title, name in CHOICES.items()],
    "sheet": SEEN,
    "group": "Second run",
}
BROUGHT_ITEM: dict[str, Any] = {
    "name": BROUGHT,
    "kind": "table",
    "label": "Results of another program",
    "help": "Drop or choose a table (.csv) whose first line names x, t, and friction force or "
    "displacement (m, s, N/m, or Pa of bodies in the plane), at any points and instants. They are "
    "drawn beside the run, and their distance to it is told. They stay with this scene until they "
    "are removed, or the page is closed.",
    "sheet": SEEN,
    "group": "Second run",
}
WARM_ITEM = {
    "name": WARM,
    "kind": "flip",
    "label": "Start from the run before",
    "help": "When a setting changes, start from the last solution, if that saves iterations: one "
    "iteration from either start shows which is nearer, and both are part of the run time. Reset "
    "always takes the usual start.",
    "sheet": HOW[0],
    "group": METHOD,
}
UNITS_ITEM: dict[str, Any] = {
    "name": UNITS,
    "kind": "choice",
    "label": "Units",
    "help": "In which values are shown, typed (another may be typed too, as in 5 mm) and saved. "
    "Tables have SI where the size chooses; "
    "links, saved settings and programs always.",
    "options": [[title, name] for name, title in SYSTEMS.items()],
    "cookie": COOKIE,
    "sheet": SEEN,
    "group": "Units",
}
VIEWS_ITEM: dict[str, Any] = {
    "name": VIEWS,
    "kind": "checks",
    "help": "Which plots are drawn.",
    "sheet": SEEN,
    "group": "Plots",
}
NOTE_ITEM: dict[str, Any] = {"name": NOTE, "kind": "note"}


@cache
def items(settings: type[Settings]) -> list[dict[str, Any]]:
    """Say what controls there are: the chief ones, and in sheets all others."""
    definitions = settings.definitions()
    chief = [name for name in chief_of(settings) if name in definitions]
    # What is a scene's own comes first in its groups.
    own = dict.fromkeys(name for kind in settings.__mro__ for name in vars(kind))
    what = _sheet(settings, *WHAT, [name for name in own if name not in chief])
    how = _sheet(settings, *HOW, [name for name in definitions if name not in chief])
    after = max(place for place, item in enumerate(how) if item["group"] == METHOD) + 1
    how.insert(after, WARM_ITEM)
    first = [item for name in chief if (item := item_of(name, definitions[name]))]
    others = [COMPARE_ITEM, BROUGHT_ITEM, UNITS_ITEM, VIEWS_ITEM, LESSON_ITEM]
    return [NOTE_ITEM, SCENE_ITEM, *first, *what, *how, *others]


def _sheet(
    settings: type[Settings], title: str, groups: tuple[str, ...], names: list[str]
) -> list[dict[str, Any]]:
    """Say which controls stand in a sheet: those of its groups, one group after the other."""
    definitions = settings.definitions()
    return [
        {**item, "sheet": title, "group": group}
        for group in groups
        for name in names
        if name in definitions
        and about(definitions[name]).group == group
        and (item := item_of(name, definitions[name]))
    ]
