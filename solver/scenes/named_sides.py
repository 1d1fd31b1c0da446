"""Words on the sides of a mesh: what each of them is held, moved or loaded by.

They stand behind the name of a side in the mesh, as in "left held", or in the setting
`sides`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from solver.refusal import RefusedError

DEEDS = {
    "free": "nothing acts on it",
    "held": "it moves neither along x nor along y",
    "held x": "it does not move along x",
    "held y": "it does not move along y",
    "moved x": "it moves along x by the displacement",
    "moved y": "it moves along y by the displacement",
    "pulled": "the traction acts outwards on it",
    "pressed": "the pressure acts on it",
}
"""What may happen to a side, and what it means."""
USUAL = {
    "bottom": "held",
    "fixed": "held",
    "top": "moved y",
}
"""What happens to sides of these names if nothing else is said."""
_DEED = "|".join(sorted(DEEDS, key=len, reverse=True))
_PHRASE = re.compile(rf"(.*?)\s*\b((?:{_DEED})(?: and (?:{_DEED}))*)", re.DOTALL)
ALLOWED = f"a name of a side and one or more of {', '.join(DEEDS)}, joined by and"


def taken_apart(phrase: str) -> tuple[str, tuple[str, ...]]:
    """Name of a side, and what happens to it; nothing where the phrase does not say."""
    match = _PHRASE.fullmatch(phrase.strip())
    if match is None:
        return phrase.strip(), ()
    name, deeds = match.groups()
    return name or phrase.strip(), tuple(deeds.split(" and "))


def deeds_of(lines: Sequence[str], given: str) -> Mapping[str, tuple[str, ...]]:
    """What happens to the sides of a mesh, by the names of its lines, in order.

    What is `given`, phrases between commas, goes before what names say; where neither
    says anything, sides have what is usual for their name.

    Raises
    ------
    RefusedError
        For a phrase that is not understood, and a side that does not exist.
    """
    known = {}
    for line in lines:
        name, deeds = taken_apart(line)
        usual = USUAL.get(name.lower())
        if not deeds and usual:
            deeds = (usual,)
        known[line] = deeds
    names = {taken_apart(line)[0].lower(): line for line in lines}
    for phrase in given.split(","):
        if not phrase.strip():
            continue
        name, deeds = taken_apart(phrase)
        if not deeds:
            remedy = f"write “{name} held”, or another of these"
            raise RefusedError("sides", phrase.strip(), ALLOWED, remedy)
        if name.lower() not in names:
            sides = ", ".join(taken_apart(line)[0] for line in lines) or "none"
            remedy = f"there is no side {name!r}: those of the mesh are {sides}"
            raise RefusedError("sides", phrase.strip(), ALLOWED, remedy)
        known[names[name.lower()]] = deeds
    return known
