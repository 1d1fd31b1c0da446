"""Settings say what they are, and never change: a change gives new ones."""

from __future__ import annotations

import json

import param
import pytest
from valid_settings import DEFINITIONS

from solver.definitions import CurveParameter, allowed, parse
from solver.scenes.bar import BarSettings


def another(definition):
    """Give a valid value that is not the very object that the settings hold."""
    if isinstance(definition, CurveParameter):
        return "ramp"
    if isinstance(definition, param.Boolean):
        return not definition.default
    if isinstance(definition, param.Selector):
        return "".join(definition.default)
    low, high = definition.bounds
    return high if low == definition.default else low


@pytest.mark.parametrize("name", list(DEFINITIONS))
def test_settings_are_immutable(name):
    chosen = BarSettings.checked({"load": [[0.0, 1.0], [1.0, 2.0]]})
    before = chosen.values()
    other = another(DEFINITIONS[name])
    for change in (
        lambda: setattr(chosen, name, other),
        lambda: chosen.param.update(**{name: other}),
    ):
        with pytest.raises(TypeError, match="onstant"):
            change()
    assert chosen.values() == before
    hash(before[name])


def test_a_change_gives_new_settings_and_leaves_the_old_ones():
    chosen = BarSettings.checked({"load": [[0.0, 1.0], [1.0, 2.0]]})
    changed = chosen.replace(load="ramp")
    assert (chosen.load, changed.load) == (((0.0, 1.0), (1.0, 2.0)), "ramp")
    fewer = chosen.with_change("elements", 4)
    assert (fewer.elements, fewer.substructures, chosen.substructures) == (4, 4, 10)


@pytest.mark.parametrize("name", list(DEFINITIONS))
def test_every_setting_says_what_it_is(name):
    definition = DEFINITIONS[name]
    assert definition.doc
    assert allowed(definition)
    default = definition.default
    again = parse(json.dumps(default))
    assert again == default
    assert BarSettings.checked({name: default}).values() == BarSettings().values()
