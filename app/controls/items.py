"""Which controls stand at the side, in which order, and what each says."""

from __future__ import annotations

from functools import cache
from typing import Any

from app.components.form import item_of
from app.controls.comparing import CHOICES
from app.lessons.lesson import LESSONS
from solver.scenes import CATALOGUE
from solver.settings import Settings

METHOD = "Method"
ORDER = (
    "Load",
    "Top",
    "Left",
    "Right",
    "Contact",
    "Bar",
    "Strand",
    "Body",
    "Body force",
    "Decomposition",
    METHOD,
    "Stop",
)

# None of these is the name of a setting.
SCENE, LESSON, WARM = "the-scene", "the-lesson", "start-from-before"
VIEWS, SHARE, COMPARE, NOTE = "the-views", "share", "compare", "note"
SCENE_ITEM = {
    "name": SCENE,
    "kind": "choice",
    "label": "Scene",
    "help": "What is solved; each scene keeps its settings until the page is closed.",
    "options": [[entry.title, name] for name, entry in CATALOGUE.items()],
}
LESSON_ITEM = {
    "name": LESSON,
    "kind": "choice",
    "label": "Lesson",
    "help": "A question: predict the answer, change one thing, and see why.",
    "options": [["none", ""], *([one.title, one.name] for one in LESSONS.values())],
}
COMPARE_ITEM = {
    "name": COMPARE,
    "kind": "choice",
    "label": "Compare with",
    "help": "Two runs in step, on the same axes. Keep the present settings as run A and change "
    "those of run B, or choose a pair.",
    "options": [[title, name] for title, name in CHOICES.items()],
}
WARM_ITEM = {
    "name": WARM,
    "kind": "flip",
    "label": "Start from the run before",
    "help": "When a setting changes, start from the last solution, if that saves iterations: one "
    "iteration from either start shows which is nearer, and both are part of the run time. Reset "
    "always takes the usual start.",
    "group": METHOD,
}
VIEWS_ITEM = {"name": VIEWS, "kind": "checks", "help": "Which plots are drawn.", "group": "Views"}
NOTE_ITEM = {"name": NOTE, "kind": "note"}
LINK, SAVE, DEFAULTS, CLASS = "Link", "Save", "Defaults", "Class"
SHARE_ITEM = {
    "name": SHARE,
    "kind": "share",
    "group": "Share",
    "buttons": [
        [LINK, "Copy the address of this page: its settings and what you look at."],
        [SAVE, "Save the settings as a file, which Open and the command line read."],
        [DEFAULTS, "Bring all settings back to their defaults."],
        [CLASS, "Begin a class: whoever joins by its code sees what you see."],
    ],
    "label": "Open settings (.toml) or load (.csv)",
}


@cache
def items(settings: type[Settings]) -> list[dict[str, Any]]:
    """Say what controls there are, those behind "more" before the choice of views."""
    made = [item_of(name, definition) for name, definition in settings.definitions().items()]
    found = [item for item in made if item is not None]
    open_ones = [item for item in found if not item["more"]]
    groups = [*ORDER, *(item["group"] for item in open_ones)]
    open_ones.sort(key=lambda item: groups.index(item["group"]))
    after = max(i for i, item in enumerate(open_ones) if item["group"] == METHOD) + 1
    open_ones.insert(after, WARM_ITEM)
    more = [item for item in found if item["more"]]
    return [
        NOTE_ITEM,
        SCENE_ITEM,
        LESSON_ITEM,
        COMPARE_ITEM,
        *open_ones,
        *more,
        VIEWS_ITEM,
        SHARE_ITEM,
    ]
