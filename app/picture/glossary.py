"""What the words of the page mean: one line each, shown where a pointer or the focus is on one."""

from __future__ import annotations

import re
from functools import cache, lru_cache

from app.languages.language import Language, language

ENGLISH = language("en")
TERMS: dict[tuple[str, ...], str] = {
    ("LATIN",): "The method: in turns it obeys the contact laws point by point and the elasticity "
    "of the bodies, at all instants at once, until both agree.",
    ("iteration", "iterate"): "One turn of the method; each improves all instants at once.",
    ("LATIN indicator η", "LATIN indicator", "η"): "How far apart the two stages of an iteration "
    "are. It is no error, as it also depends on the search direction k.",
    ("k-free indicator",): "By how much the iterate breaks the contact laws, as a share of the "
    "energy in play, whatever k is.",
    ("indicator",): "What the method computes of itself to see how far it is; it is no error.",
    (
        "search direction",
        "factor on k",
        "k ×",
        "auto k",
        "k updated",
    ): "k: the stiffness that joins the "
    "two stages of an iteration. It changes how many iterations are needed, not the solution.",
    ("estimated force error",): "How wrong the contact force is, as the run itself estimates it, "
    "without a reference.",
    ("displacement error",): "Distance of the displacement to the reference, as a share of its "
    "size.",
    ("friction force error", "force error"): "Distance of the contact force to the reference, as a "
    "share of its size.",
    ("error",): "Distance to the reference, as a share of its size.",
    ("reference",): "The solution of another solver on the same mesh, which goes from instant to "
    "instant; errors are distances to it.",
    ("incremental solver", "incremental"): "The solver of the reference: one instant after the "
    "other, each to the end.",
    ("closed form",): "The exact solution by formula, without a mesh along the body.",
    ("run time",): "All that a run needs to end: set-up, iterations, indicators, estimate.",
    ("iterations to 1 %",): "After which the friction force is within 1 % of the reference for "
    "the first time.",
    ("substructure",): "A piece of a body; every iteration solves each by itself.",
    ("interface",): "Where two bodies, two substructures, or a body and its support meet.",
    ("multiscale", "coarse problem", "macro"): "A small coarse problem balances the macro forces "
    "(resultants, moments) of all substructures at every iteration.",
    ("monoscale",): "Without a coarse problem: each substructure hears only its "
    "neighbours, so a load travels one substructure an iteration.",
    ("status step",): "Keeps the present stick, slip and opening, and solves the linear problem "
    "that is left; its solution counts only if it obeys all laws.",
    ("answer",): "The solution that a status step has found. It stands beside the iterates of the "
    "search, once these are accurate enough by themselves.",
    ("certified",): "Shown to obey equilibrium and all contact laws up to rounding.",
    ("chosen instant", "instant"): "A moment of the load path. Tap the map or drag the slider to "
    "choose one.",
    ("changed status",): "Another of stick, slip and open than in the iterate before; the status "
    "line says how many points and instants, and why.",
    ("bending stiffness",): "How much moment a little more curvature takes now, as a share of what "
    "it takes while nothing slips. Near a clamp it may be above 100 %: what slips farther along "
    "pulls too.",
    ("stick",): "The friction force is below its bound: the point does not slide.",
    ("slip −", "slip +", "slip"): "The friction force has reached its bound: the point slides, "
    "+ to the right, − to the left.",
    ("open",): "The surfaces do not touch: there is neither pressure nor friction.",
    ("±μp", "±μ(σ−p)"): "The bound of the friction force: coefficient of friction times pressure.",
    ("hysteresis loop",): "Force over displacement; the area inside is the energy that friction "
    "takes.",
    ("cycle",): "From one turning point of the load to the next but one; the way there from rest "
    "is none.",
    ("friction work",): "Energy that friction takes, where it does so: there surfaces wear.",
    ("run before",): "The last run that came to an end; it stays as a ghost to compare with.",
    ("this run",): "The one that goes on now, or was the last to.",
    ("first settings",): "The run that this page began with.",
    ("displacement ×",): "Displacements are drawn so many times larger than they are.",
    ("singular value", "SVD"): "Sizes of the modes that describe a field best. Where they fall "
    "fast, a few modes suffice.",
    ("PGD", "basis"): "Model reduction: fields are sums of few modes, found as the run goes on.",
    ("mode",): "A shape in space times a function of time; a field is a sum of modes.",
    ("whole table",): "All values of the field, at every point and instant.",
    ("clip",): "Friction as a straight line in the load, cut off at its bound and at what the last "
    "reversal left: two vectors for each branch, in which the load goes one way. Per cent: by how "
    "much they miss this iterate.",
    ("its field",): "The singular values of the field that the modes of a basis have to describe.",
    ("full stage",): "The same run without model reduction, to compare with.",
    ("nested",): "Starts from the solution of a coarser mesh.",
    ("Anderson",): "Combines the last iterates so that the two stages agree best.",
}
"""What it is called, the first spelling being that of the list, and what it means."""
_TEXT = re.compile(r"(<[^>]*>|&\w+;)")


@cache
def terms_in(say: Language) -> list[tuple[list[str], str]]:
    """Give all terms in a language: what each is called, and its line."""
    return [
        ([form for one in spellings for form in say.spellings(one)], say(line))
        for spellings, line in TERMS.items()
    ]


@cache
def _term(say: Language) -> re.Pattern[str]:
    every = sorted((one for called, _ in terms_in(say) for one in called), key=len, reverse=True)
    return re.compile(rf"(?<![\w-])({'|'.join(map(re.escape, every))})(s?)(?![\w-])", re.IGNORECASE)


@lru_cache(maxsize=1024)
def explained(html: str, plain: tuple[str, ...] = (), say: Language = ENGLISH) -> str:
    """Mark each term where it first stands in a text (HTML); the browser shows its line.

    The text is in the page's language. Terms that are to stay `plain` are given in small letters,
    in the singular.
    """
    seen = {form.lower() for one in plain for form in say.spellings(one)}

    def marked(found: re.Match[str]) -> str:
        term = found[1].lower()
        if term in seen:
            return found[0]
        seen.add(term)
        return f'<abbr tabindex="0">{found[0]}</abbr>'

    parts = _TEXT.split(html)
    parts[::2] = [_term(say).sub(marked, text) for text in parts[::2]]
    return "".join(parts)
