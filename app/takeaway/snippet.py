"""The run of a page as a Python program that needs the solver alone."""

from __future__ import annotations

import json

from app.picture.shown import has_reference
from solver.settings import Settings

IMPORTS = """\
from solver.files import scene_settings
from solver.latin import solve
"""
COMPARED = """\
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
"""
BEGIN = """\
from solver.scenes import discretise
from solver.scenes.method import method_of

settings = scene_settings({scene}).checked(
    {{
{values}    }}
)
problem = discretise(settings)
"""
ALONE = "solution = solve(problem, method_of(settings))\n"
BESIDE = """\
distance = distance_to(reference_of(problem), problem)
solution = solve(problem, method_of(settings), distance=distance)
"""
END = """\
for record in solution.records:
    print(record.iteration, record.indicator, record.error_force)
print(solution.status.ending)
"""
NOTE = "# On the page it started from the run before it; here it starts as its settings say.\n"


def snippet(settings: Settings, *, was_warm: bool = False) -> str:
    """Write a program that gives the numbers of a run again, all its settings in it.

    Parameters
    ----------
    settings
        Of the run; where the page has a reference, the program has it too.
    was_warm
        Whether the run started from the one before it, which the program has not.
    """
    is_compared = has_reference(settings)
    entries = (
        f"        {json.dumps(name)}: {value!r},\n" for name, value in settings.values().items()
    )
    begin = BEGIN.format(scene=json.dumps(settings.scene), values="".join(entries))
    imports = IMPORTS + (COMPARED if is_compared else "")
    return (NOTE if was_warm else "") + imports + begin + (BESIDE if is_compared else ALONE) + END
