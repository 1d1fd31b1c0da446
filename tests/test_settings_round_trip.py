"""Every front reads what another wrote, and refuses what is wrong in one clear line."""

from __future__ import annotations

import json
import math
from pathlib import Path

import param
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from solver.checked import dump
from solver.definitions import CurveParameter, SettingError, allowed, parse
from solver.files import settings_from_command, settings_from_toml
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings
from solver.scenes.base import LARGEST_FIELD
from solver.tables import read_table, resolve

ANY = settings(
    derandomize=True, deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow]
)
DEFINITIONS = BarSettings.definitions()
NUMBERS = [
    name
    for name, definition in DEFINITIONS.items()
    if isinstance(definition, param.Number) and not isinstance(definition, param.Boolean)
]
CURVES = [
    name for name, definition in DEFINITIONS.items() if isinstance(definition, CurveParameter)
]
CHOICES = [name for name, kind in DEFINITIONS.items() if isinstance(kind, param.Selector)]


def curves(definition):
    low = 0.0 if definition.ordinate == "factor" else -1e15
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
    assume((elements + 1) * values.get("instants", BarSettings.instants) <= LARGEST_FIELD)
    sections = values.get("section_profile", "uniform")
    if not isinstance(sections, str):
        # Sections are positive, within eight decades of each other.
        values["section_profile"] = [(place, 1.0 + abs(size) % 1e7) for place, size in sections]
    return BarSettings.checked(values)


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


@ANY
@given(valid_settings())
def test_a_saved_file_gives_the_same_settings(chosen):
    again = settings_from_toml(dump(chosen))
    assert type(again) is type(chosen)
    assert again.values() == chosen.values()


@ANY
@given(valid_settings())
def test_an_address_gives_the_same_settings(chosen):
    from app.shell.address import query_of, settings_from_query

    again, complaint = settings_from_query(query_of(chosen))
    assert complaint == ""
    assert again.values() == chosen.values()


@ANY
@given(valid_settings())
def test_a_command_line_gives_the_same_settings(chosen):
    texts = [f"{name}={json.dumps(value)}" for name, value in chosen.values().items()]
    assert settings_from_command(chosen.scene, texts).values() == chosen.values()


@ANY
@given(valid_settings())
def test_result_files_hold_the_same_settings(chosen):
    text = json.dumps({"scene": chosen.scene, **chosen.values()})
    values = json.loads(text)
    assert CATALOGUE[values.pop("scene")].settings.checked(values).values() == chosen.values()


def test_a_saved_file_takes_changes_from_the_command_line(tmp_path):
    saved = tmp_path / "saved.toml"
    saved.write_text(dump(BarSettings.checked({"peak": 700.0, "elements": 20})), encoding="utf-8")
    found = settings_from_command(str(saved), ["peak=800", "load=ramp"])
    assert (found.peak, found.elements, found.load) == (800.0, 20, "ramp")


def test_a_csv_is_found_beside_the_settings_file_or_in_the_working_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "deep"
    folder.mkdir()
    (folder / "path.csv").write_text("time,force\n0,0\n0.5, 100\n1,-1e2\n", encoding="utf-8-sig")
    (folder / "run.toml").write_text('scene = "bar"\nload = "path.csv"\n', encoding="utf-8")
    expected = ((0.0, 0.0), (0.5, 100.0), (1.0, -100.0))
    assert settings_from_command("deep/run.toml", []).load == expected
    assert settings_from_command("bar", ["load=deep/path.csv"]).load == expected


@pytest.mark.parametrize("name", NUMBERS)
def test_numbers_out_of_range_or_of_another_kind_are_refused(name):
    definition = DEFINITIONS[name]
    low, high = definition.bounds
    span = allowed(definition)
    assert f"{low:g} to {high:g}" in span
    beyond = [low - 1, high * 2 + 1, 10**400, -(10**400)]
    for value in [*beyond, math.nan, math.inf, -math.inf, True, "many", None, [1.0], {"a": 1}]:
        text = refusal(lambda value=value: BarSettings.checked({name: value}))
        assert_names(text, name, json.dumps(value)[:57], span)


@pytest.mark.parametrize(
    "name", [name for name in NUMBERS if isinstance(DEFINITIONS[name], param.Integer)]
)
def test_whole_numbers_may_be_written_with_a_point_and_nothing_behind_it(name):
    low, _ = DEFINITIONS[name].bounds
    base = {"elements": 100, "substructures": 1}
    good = BarSettings.checked({**base, name: low + 1.0}).values()[name]
    assert type(good) is int
    assert_names(
        refusal(lambda: BarSettings.checked({name: low + 1.5})),
        name,
        str(low + 1.5),
        allowed(DEFINITIONS[name]),
    )


@pytest.mark.parametrize("value", [1, 0.0, "true", None, []])
def test_only_true_and_false_are_switches(value):
    text = refusal(lambda: BarSettings.checked({"multiscale": value}))
    assert_names(text, "multiscale", json.dumps(value), "true or false")


@pytest.mark.parametrize("name", CHOICES)
@pytest.mark.parametrize("value", ["nothing", 3, True, None, ["none"], {"a": 1}])
def test_only_the_names_of_a_choice_are_taken(name, value):
    text = refusal(lambda: BarSettings.checked({name: value}))
    assert_names(text, name, json.dumps(value), ", ".join(DEFINITIONS[name].objects))


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize(
    ("value", "remedy"),
    [
        ([], "at least one pair"),
        ("nowhere", "choose a preset"),
        (3.0, "at least one pair"),
        ([[0.0, 1.0], [1.0]], "row 2 must be a pair"),
        ([[0.0, 1.0, 2.0]], "row 1 must be a pair"),
        ([0.0, 1.0], "row 1 must be a pair"),
        ([[0.0, 0.0], [0.5, 1.0], [0.5, 2.0]], "row 3"),
        ([[1.0, 0.0], [0.0, 1.0]], "must increase"),
        ([[0.0, math.nan]], "not finite"),
        ([[math.inf, 0.0]], "not finite"),
        ([[0.0, "much"]], "not a number"),
        ([[0.0, True]], "not a number"),
        ([[0.0, 1e16]], "1e15"),
        ([[0.0, 10**400]], "1e15"),
    ],
    ids=str,
)
def test_bad_tables_are_refused_with_their_row(name, value, remedy):
    text = refusal(lambda: BarSettings.checked({name: value}))
    assert_names(text, name, json.dumps(value)[:57], ", ".join(DEFINITIONS[name].presets))
    assert remedy in text


def test_a_csv_may_have_quoted_names_in_capitals_and_empty_lines(tmp_path):
    file = tmp_path / "load.csv"
    file.write_text('"Time", Force\n\n0,0\n , \n1,"700"\n\n', encoding="utf-8")
    found = resolve(DEFINITIONS["load"], "load", "load.csv", tmp_path)
    assert found == [[0.0, 0.0], [1.0, 700.0]]


@pytest.mark.parametrize(
    "text",
    [
        "0;0\n0,5;1200\n",
        "Zeit [s];Kraft [kN]\n0,0;0\n0,5;1,2\n",
        "t\tF\n0\t0\n0.5\t1.2e3\n",
        "Bench 3, second try\ntime (ms),force / N\n0,0\n500,1200\n",
        "t;F\ns;kN\n\n0;0\n0,5;1,2\n;\n",
    ],
    ids=repr,
)
def test_a_csv_is_read_as_spreadsheets_write_it_with_its_units(text):
    found = read_table(text, DEFINITIONS["load"], "load", "load.csv")
    assert found == [[0.0, 0.0], [0.5, 1200.0]]


@pytest.mark.parametrize(
    ("rows", "remedy"),
    [
        ("", "no points"),
        ("time,force\n", "no points"),
        ("0,0\n\n1\n", "line 3"),
        ("0,0\n1\n", "line 2"),
        ("0,0\n1,\n", "line 2"),
        ("0,0\n1,2,3\n", "line 2"),
        ("0,0\n1,much\n", "line 2"),
        ("force,time\n0,0\n", "line 1"),
        ("0;0\n0,5;1.5\n", "line 2"),
        ('0,0\n1,"1,000"\n', "line 2"),
        ("time (min),force (N)\n0,0\n", "line 1 says min: give it in s"),
        ("time;force\ns;lbf\n0;0\n", "line 2 says lbf: give it in N"),
        ("much,1\n1,1\n", "line 1"),
        ("0,0\n1,nan\n", "row 2"),
        ("0,0\n1,inf\n", "row 2"),
        ("1,0\n0,0\n", "must increase"),
        ("0,0\n0,1\n", "must increase"),
    ],
    ids=repr,
)
def test_a_bad_csv_is_refused_with_its_line(tmp_path, rows, remedy):
    file = tmp_path / "load.csv"
    file.write_text(rows, encoding="utf-8")
    text = refusal(lambda: settings_from_command("bar", [f"load={file}"]))
    assert text.startswith("load = ")
    assert "allowed: ramp, triangle" in text
    assert remedy in text


def test_a_csv_that_is_missing_binary_or_a_folder_is_refused(tmp_path):
    binary = tmp_path / "binary.csv"
    binary.write_bytes(b"\xff\xfe\x00\x80")
    for path in (tmp_path / "none.csv", binary, tmp_path):
        text = refusal(lambda path=path: settings_from_command("bar", [f"load={path}"]))
        assert "load = " in text
        assert "no readable CSV file" in text
    nul = 'scene = "bar"\nload = "a\\u0000b"\n'
    assert "no readable CSV file" in refusal(lambda: settings_from_toml(nul, tmp_path))


def test_unknown_names_are_refused_with_the_nearest_one():
    text = refusal(lambda: BarSettings.checked({"friktion": 0.3}))
    assert_names(text, "friktion", "0.3", "substructures, multiscale")
    assert "did you mean friction?" in text
    for name in ("scene", "name", "param", "checked"):
        assert "there is no such setting" in refusal(
            lambda name=name: BarSettings.checked({name: "x"})
        )


def test_unknown_scenes_are_refused_with_the_known_ones():
    for text in ('scene = "bridge"', "peak = 1.0", "scene = 3", 'scene = ["bar"]'):
        assert "allowed: bar" in refusal(lambda text=text: settings_from_toml(text))
    assert_names(refusal(lambda: settings_from_command("bridge", [])), "scene", "bridge", "bar")


@pytest.mark.parametrize(
    "text",
    [
        "scene = bar",
        'scene = "bar"\npeak =',
        "[[[",
        'scene = "bar"\nscene = "bar"',
        "\x00",
        'scene = "bar"\npeak = ' + "9" * 5000,
        'scene = "bar"\npeak = ' + "[" * 20_000,
    ],
    ids=lambda text: text[:20],
)
def test_a_broken_settings_file_is_refused(text):
    assert "allowed: TOML" in refusal(lambda: settings_from_toml(text))


def test_a_settings_file_that_cannot_be_read_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("binary.toml").write_bytes(b"\xff\xfe")
    Path("folder.toml").mkdir()
    for name in ("none.toml", "binary.toml", "folder.toml"):
        text = refusal(lambda name=name: settings_from_command(name, []))
        assert name in text
        assert "readable TOML file" in text


@pytest.mark.parametrize("text", ["peak", "", "peak 3"])
def test_an_assignment_without_an_equals_sign_is_refused(text):
    assert "NAME=VALUE" in refusal(lambda: settings_from_command("bar", [text]))


@pytest.mark.parametrize(
    "text", ["9" * 5000, "1" + "0" * 400, "[" * 20_000, "1\nseed = 4", "", "nan", "true", "1,5"]
)
def test_text_that_is_no_number_is_refused_by_every_front(text):
    from app.shell.address import query_of, settings_from_query

    assert "peak = " in refusal(lambda: settings_from_command("bar", [f"peak={text}"]))
    chosen, complaint = settings_from_query("?peak=" + text.replace("\n", "%0A") + "&seed=3")
    assert query_of(chosen) == "?scene=bar&seed=3"
    if text:
        assert "peak = " in complaint


def test_values_that_do_not_fit_together_are_refused():
    text = refusal(lambda: BarSettings.checked({"elements": 5}))
    assert_names(text, "substructures", "10", "1 to elements (5)")
    text = refusal(lambda: BarSettings.checked({"elements": 20_000, "instants": 20_001}))
    assert_names(text, "instants", "20001", "at most 1249")
    text = refusal(lambda: BarSettings.checked({"friction_profile": [[0.0, -1.0]]}))
    assert_names(text, "friction_profile", "-1.0", "factors of at least 0")


@pytest.mark.parametrize("path", ["/etc/passwd", "load.csv", "../load.csv"])
def test_an_address_never_reads_a_file(tmp_path, monkeypatch, path):
    from app.shell.address import settings_from_query

    monkeypatch.chdir(tmp_path)
    (tmp_path / "load.csv").write_text("0,0\n1,100\n", encoding="utf-8")
    opened = []
    monkeypatch.setattr(Path, "read_text", lambda self, *rest, **more: opened.append(self))
    for text in (path, f'"{path}"'):
        chosen, complaint = settings_from_query(f"?load={text}")
        assert chosen.load == "sine"
        assert "choose a preset" in complaint
    assert not opened


@pytest.mark.parametrize(
    ("query", "words", "scene"),
    [
        ("?friction=-3", "friction = -3 is refused", "bar"),
        ("?scene=strand&broken=9", "broken = 9 is refused", "strand"),
        ("?scene=bridge", 'scene = "bridge" is refused', "bar"),
    ],
)
def test_a_bad_address_is_explained_and_gives_the_defaults_of_its_scene(query, words, scene):
    from app.shell.address import settings_from_query

    chosen, complaint = settings_from_query(query)
    assert words in complaint
    assert chosen.scene == scene
    assert not chosen.changed()


def test_an_uploaded_file_never_names_another():
    text = 'scene = "bar"\nload = "/etc/passwd"\n'
    assert "choose a preset" in refusal(lambda: settings_from_toml(text))


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


@pytest.mark.parametrize("scene", CATALOGUE)
def test_a_file_of_an_earlier_version_is_read_as_far_as_it_still_holds(scene):
    kind = CATALOGUE[scene].settings
    usual = kind.checked({})
    old = 'local_stage = "full"\nlocal_points = 0.5\nlocal_instants = 0.5\n'
    assert settings_from_toml(f"{dump(usual)}{old}").values() == usual.values()
    with pytest.raises(SettingError, match=r"local_stage.*leave it out"):
        kind.checked({"local_stage": "reduced"})
