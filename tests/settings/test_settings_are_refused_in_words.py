"""Unknown settings and bad values are refused in one clear line."""

import json
import math

import param
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refusals import assert_names, refusal

from app.link import query_of, read
from app.state import default_settings
from solver.files.saved import settings_from_command, settings_from_toml
from solver.scenes.bar import BarSettings
from solver.settings.definitions import CurveParameter
from solver.settings.values import REMOVED, allowed

DEFINITIONS = BarSettings.definitions()
BAD_TABLES = [
    ([], "at least one pair"),
    ("nowhere", "choose a preset"),
    (3.0, "at least one pair"),
    ([[0.0, 1.0], [1.0]], "row 2 must be a pair"),
    ([[0.0, 1.0, 2.0]], "row 1 must be a pair"),
    ([0.0, 1.0], "row 1 must be a pair"),
    ([[0.0, 1.0], [0.5, 1.0], [0.5, 2.0]], "row 3"),
    ([[1.0, 1.0], [0.0, 1.0]], "must increase"),
    ([[0.0, math.nan]], "is nan, give a number from"),
    ([[math.inf, 1.0]], "is inf, give a number from"),
    ([[0.0, "much"]], "not a number"),
    ([[0.0, True]], "not a number"),
    ([[0.0, 1e16]], "give a number from"),
    ([[0.0, 10**400]], "give a number from"),
]
NO_NUMBERS = [
    10**400,
    -(10**400),
    math.nan,
    math.inf,
    -math.inf,
    True,
    "many",
    None,
    [1.0],
    {},
]
NO_CHOICES = ["nothing", 3, 0.0, None, [], ["none"], {"a": 1}]


@st.composite
def wrong(draw):
    """Any setting with a refused value, what is allowed, and a remedy or none."""
    name = draw(st.sampled_from(sorted(DEFINITIONS)))
    definition = DEFINITIONS[name]
    remedy = ""
    if isinstance(definition, CurveParameter):
        value, remedy = draw(st.sampled_from(BAD_TABLES))
        return name, value, ", ".join(definition.presets), remedy
    if isinstance(definition, param.Boolean):
        return name, draw(st.sampled_from(NO_CHOICES)), "true or false", ""
    if isinstance(definition, param.Selector):
        return (
            name,
            draw(st.sampled_from([*NO_CHOICES, True])),
            ", ".join(definition.objects),
            "",
        )
    low, high = definition.bounds
    beyond = [low - 1, high * 2 + 1, *NO_NUMBERS]
    if isinstance(definition, param.Integer):
        beyond.append(low + 1.5)
    return name, draw(st.sampled_from(beyond)), allowed(definition), ""


@settings(max_examples=200)
@given(wrong())
def test_bad_values_of_settings_are_refused_with_the_allowed_ones(case):
    name, value, span, remedy = case
    text = refusal(lambda: BarSettings.checked({name: value}))
    assert_names(text, name, json.dumps(value)[:57], span)
    assert remedy in text


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("peak", "any number (at most 1e15 N in size)"),
        ("pressure", "any number from 0 on (to 1e15 N/m)"),
        ("young", "any number above 0 (from 1 Pa to 1e18 Pa)"),
        ("relaxation", "a number from 0.01 to 1"),
        ("seed", "a whole number from 0 to 2147483647"),
    ],
)
def test_ranges_read_naturally_and_remote_bounds_come_last(name, said):
    assert f"allowed: {said}; " in refusal(lambda: BarSettings.checked({name: "many"}))


def test_whole_numbers_may_be_written_with_a_point_and_nothing_behind_it():
    assert type(BarSettings.checked({"elements": 100.0}).elements) is int


@pytest.mark.parametrize(
    ("name", "meant", "meaning"),
    [
        ("friktion", "friction", "Coefficient of friction mu"),
        ("mu", "friction", "Coefficient of friction mu"),
        (
            "left_displacement",
            "support_displacement",
            "Largest displacement of what holds the left",
        ),
        ("load_path", "load", "Force at the right end over time"),
        ("k", "k_scale", "Multiplies the search direction k"),
    ],
)
def test_unknown_names_are_refused_with_the_nearest_ones_and_their_meaning(
    name, meant, meaning
):
    text = refusal(lambda: BarSettings.checked({name: 0.3}))
    assert_names(text, name, "0.3", "a setting of bar")
    assert f"did you mean {meant} ({meaning}" in text
    assert len(text) < 400


@pytest.mark.parametrize("name", REMOVED)
def test_removed_settings_are_refused_as_removed(name):
    text = refusal(lambda: BarSettings.checked({name: 0.5}))
    assert f"it is gone: {REMOVED[name].reason}; leave it out" in text
    # Files of early versions have all settings.
    settings = BarSettings.checked({name: REMOVED[name].neutral, "friction": 0.2})
    assert settings.values() == BarSettings.checked({"friction": 0.2}).values()


def test_names_that_are_no_settings_are_refused():
    for name in ("scene", "name", "param", "checked"):
        assert "there is no such setting" in refusal(
            lambda name=name: BarSettings.checked({name: "x"})
        )


def test_unknown_scenes_are_refused_with_the_known_ones():
    for text in ('scene = "bridge"', "peak = 1.0", "scene = 3", 'scene = ["bar"]'):
        assert "allowed: bar" in refusal(lambda text=text: settings_from_toml(text))
    assert_names(
        refusal(lambda: settings_from_command("bridge", [])), "scene", "bridge", "bar"
    )


def test_values_that_do_not_fit_together_are_refused():
    text = refusal(lambda: BarSettings.checked({"elements": 5}))
    assert_names(text, "substructures", "10", "1 to elements (5)")
    text = refusal(
        lambda: BarSettings.checked({"elements": 20_000, "instants": 20_001})
    )
    assert_names(text, "instants", "20001", "at most 1249")
    text = refusal(lambda: BarSettings.checked({"friction_profile": [[0.0, -1.0]]}))
    assert_names(text, "friction_profile", "-1.0", "factors of at least 0")


@pytest.mark.parametrize(
    "text",
    [
        "9" * 5000,
        "1" + "0" * 400,
        "[" * 20_000,
        "1\nseed = 4",
        "",
        "nan",
        "true",
        "1,500",
        "9x" * 30_000,
    ],
)
def test_text_that_is_no_number_is_refused_by_every_front(text):
    assert "peak = " in refusal(lambda: settings_from_command("bar", [f"peak={text}"]))
    place, complaint = read("?peak=" + text.replace("\n", "%0A") + "&seed=3")
    assert query_of(place) == "?scene=bar&seed=3"
    if text:
        assert "Peak load cannot be" in complaint


@pytest.mark.parametrize(
    ("query", "words", "scene"),
    [
        ("?friction=-3", "μ cannot be −3", "bar"),
        ("?scene=strand&broken=9", "cannot be 9", "strand"),
        ("?scene=bridge", "there is no scene bridge", "bar"),
    ],
)
def test_a_bad_address_is_explained_and_gives_the_defaults_of_its_scene(
    query, words, scene
):
    place, complaint = read(query)
    assert words in complaint
    assert place["settings"].values() == default_settings(scene).values()
