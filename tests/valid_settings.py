"""Settings of the bar as tests ask for them: all that are valid, and how the others are refused."""

from __future__ import annotations

import param
import pytest
from hypothesis import HealthCheck, assume, settings
from hypothesis import strategies as st

from solver.definitions import CurveParameter, SettingError
from solver.scenes.bar import BarSettings
from solver.scenes.base import LARGEST_FIELD

ANY = settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
DEFINITIONS = BarSettings.definitions()


def curves(definition):
    low = 0.0 if definition.ordinate in ("factor", "pressure") else -1e15
    abscissae = st.lists(st.floats(-1e15, 1e15), min_size=1, max_size=5, unique=True).map(sorted)
    ordinates = st.lists(st.floats(low, 1e15), min_size=5, max_size=5)
    tables = st.tuples(abscissae, ordinates).map(
        lambda pair: [list(row) for row in zip(*pair, strict=False)]
    )
    return st.sampled_from(definition.presets) | tables


def values_of(definition):
    """Give a strategy of all values that a definition allows."""
    if isinstance(definition, CurveParameter):
        return curves(definition)
    if isinstance(definition, param.Boolean):
        return st.booleans()
    if isinstance(definition, param.Selector):
        return st.sampled_from(definition.objects)
    if isinstance(definition, param.Integer):
        return st.integers(*definition.bounds)
    return st.floats(*definition.bounds)


@st.composite
def valid_settings(draw):
    """Any settings that fit together."""
    names = draw(st.sets(st.sampled_from(list(DEFINITIONS)), max_size=12))
    values = {name: draw(values_of(DEFINITIONS[name])) for name in sorted(names)}
    elements = values.get("elements", BarSettings.elements)
    values["substructures"] = min(values.get("substructures", BarSettings.substructures), elements)
    instants = values.get("instants", BarSettings.instants)
    assume((elements + 1) * instants <= LARGEST_FIELD)
    values["cycles"] = min(values.get("cycles", 1), max(1, (instants - 1) // 4))
    sections = values.get("section_profile", "uniform")
    if not isinstance(sections, str):
        # Sections are positive, within eight decades of each other.
        values["section_profile"] = [(place, 1.0 + abs(size) % 1e7) for place, size in sections]
    return BarSettings.checked(values)


def refusal(action):
    with pytest.raises(SettingError) as caught:
        action()
    text = str(caught.value)
    assert "\n" not in text
    return text


def assert_names(text, name, value, range_):
    assert name in text
    assert value in text
    assert f"allowed: {range_}" in text
