"""Questions of the tab *What if* that are ready to be asked."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

from app.picture.shown import has_reference
from app.whatif.question import (
    LISTED,
    TENTH,
    Question,
    Span,
    changed_quantity,
    offered,
    shown_range,
    usual_span,
)
from solver.definitions import SettingError
from solver.scenes import behind, kind_of, loads_of
from solver.settings import Settings
from solver.study.quantities.cycle_measures import has_a_limit, has_cycles

COARSE = 10
"""Values along each side of a map."""
CUTS = (1, 2, 5, 10, 20)
"""Numbers of substructures that are compared."""


def bathtub(settings: Settings) -> Question:
    """Ask for the iterations over the search direction, with and without acceleration."""
    return _over_k(settings, "acceleration")


def over_k(settings: Settings) -> Question:
    """Ask for the iterations until the force is as near as a page asks, over k alone."""
    span = usual_span(settings.definitions()["k_scale"], "k_scale")
    return Question((span,), f"iterations_to_force@{settings.accuracy:g}")


def design_chart(settings: Settings) -> Question | None:
    """Ask for the energy dissipated over friction and load, where a number says the load."""
    return _map(settings, "friction", _load(settings), "dissipation")


def fretting_map(settings: Settings) -> Question | None:
    """Ask how much slips at once over what goes to and fro and what presses, if it does so."""
    normal = behind(settings).get("top y")
    return (
        _map(settings, _load(settings), normal, "sliding_share") if has_cycles(settings) else None
    )


def shakedown(settings: Settings) -> Question | None:
    """Ask for the shakedown factor over friction; it is in proportion to what presses.

    Not of rods that stick rigidly: a load at their end has no limit, as the mesh is refined.
    """
    is_rigid_rod = kind_of(settings) != "plane" and not settings.applies("contact_stiffness")
    if not has_a_limit(settings) or is_rigid_rod:
        return None
    end = shown_range(settings.definitions()["friction"])[1]
    span = Span("friction", f"{TENTH * end:g}", f"{end:g}", str(COARSE))
    return Question((span,), "shakedown_factor")


READY: dict[str, tuple[str, Callable[[Settings], Question | None]]] = {
    "The bathtub": (
        "Iterations over the factor on k, with and without acceleration. It is steepest with the "
        "paper's method.",
        bathtub,
    ),
    "The bathtub over substructures": (
        "Iterations over the factor on k, for several numbers of substructures.",
        lambda settings: _over_k(settings, "substructures"),
    ),
    "The design chart": ("Energy dissipated over friction and load.", design_chart),
    "The fretting map": (
        "Share of the contact that slips at once in the last cycle, over the load and what "
        "presses: 0 is stick, 1 gross slip.",
        fretting_map,
    ),
    "The shakedown limit": (
        "How many times as far the load may swing to and fro until slip goes on for ever, over "
        "friction. Below 1 it does so now. Pressed twice as hard, it is twice as much.",
        shakedown,
    ),
}
"""Questions that are ready, by what their buttons say, with a word on each."""


def _over_k(settings: Settings, name: str) -> Question:
    spans = [usual_span(settings.definitions()["k_scale"], "k_scale")]
    if name == "substructures":
        cuts = ",".join(_possible(settings, name))
        spans.append(Span(name, spacing=LISTED, listed=cuts))
    elif name in offered(settings):
        spans.append(usual_span(settings.definitions()[name], name))
    of = changed_quantity("iterations_to_force", "") if has_reference(settings) else "iterations"
    return Question(tuple(spans), of)


def _possible(settings: Settings, name: str) -> Iterator[str]:
    for value in CUTS:
        with contextlib.suppress(SettingError):
            yield str(getattr(settings.replace(**{name: value}), name))


def _load(settings: Settings) -> str | None:
    """Name the setting that says how large the load is, where a number does."""
    return next((name for name in loads_of(settings) if name in offered(settings)), None)


def _map(settings: Settings, across: str | None, up: str | None, of: str) -> Question | None:
    """Ask over two settings, from a tenth of what their sliders reach on."""
    definitions, spans = offered(settings), []
    for name in (across, up):
        if name is None or name not in definitions:
            return None
        end = shown_range(definitions[name])[getattr(settings, name) >= 0.0]
        low, high = sorted((TENTH * end, end))
        spans.append(Span(name, f"{low:g}", f"{high:g}", str(COARSE)))
    return Question(tuple(spans), of)
