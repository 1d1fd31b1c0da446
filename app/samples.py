"""Points that stand for the preset of a curve setting: where a table begins that the user edits."""

from __future__ import annotations

import numpy as np

from solver.definitions import Curve
from solver.loads import PRESETS, PULLS, load_path
from solver.scenes.bar import PROFILES, BarSettings
from solver.scenes.block import BlockSettings
from solver.scenes.layers import LayersSettings
from solver.scenes.sides import COMPONENTS, PRESCRIBED
from solver.scenes.strand import StrandSettings
from solver.settings import Settings

INSTANTS = 9
PLACES = 9
Points = list[tuple[float, float]]


def points_of(settings: Settings, name: str) -> Points:
    """Give points of the preset that a curve setting has at present."""
    values = settings.values()
    definition = settings.definitions()[name]
    assert isinstance(definition, Curve)
    if isinstance(settings, BarSettings) and values[name] in PROFILES and name != "load":
        return [(x * values["length"], factor) for x, factor in PROFILES[values[name]]]
    if isinstance(settings, BlockSettings) and name == "gap":
        return _gap(settings)
    presets = PULLS if isinstance(settings, StrandSettings) else PRESETS
    instants = np.linspace(0.0, values["duration"], INSTANTS)
    size = _size(settings, name)
    found = load_path(values[name], instants, values["duration"], size, values["seed"], presets)
    return [(float(t), float(f"{f:.6g}")) for t, f in zip(instants, found, strict=True)]


def _gap(settings: BlockSettings) -> Points:
    x = np.linspace(0.0, settings.length, PLACES)
    gap = (x - 0.5 * settings.length) ** 2 / (2.0 * settings.radius)
    gap = gap if settings.gap == "parabola" else np.zeros_like(x)
    return [(float(f"{a:.6g}"), float(f"{b:.6g}")) for a, b in zip(x, gap, strict=True)]


def _size(settings: Settings, path: str) -> float:
    """Give the largest value that a preset of this path reaches."""
    values = settings.values()
    if isinstance(settings, LayersSettings):
        names = {"pressure_load": "pressure", "pull_load": "pull", "bend_load": settings.bending}
        return float(values[names[path]])
    if isinstance(settings, BlockSettings):
        side, component, _ = path.split("_")
        prescribed = PRESCRIBED[values[side]][COMPONENTS.index(component)]
        return float(values[f"{side}_{component}_{'displacement' if prescribed else 'traction'}"])
    return float(values["peak"])
