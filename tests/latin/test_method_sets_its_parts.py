"""`method` sets the parts of the method at once;
what is set by hand beside it is kept.
"""

from __future__ import annotations

import pytest

from app.link import read
from app.state import SEARCH
from solver.commands.cli import main
from solver.files.saved import settings_from_command
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings
from solver.settings.scene import Settings

PAPER = {
    "search_direction": "paper",
    "acceleration": "none",
    "start": "zero",
    "relaxation": 0.8,
    "finish": "none",
    "tolerance": 1e-10,
}
FAST = {
    "search_direction": "auto",
    "acceleration": "anderson",
    "start": "nested",
    "relaxation": 0.8,
    "finish": "at-once",
    "tolerance": 1e-3,
}
METHODS = {"paper": PAPER, "fast": FAST}
OTHERS = {
    "friction": 0.4,
    "elements": 30,
    "accuracy": 1e-4,
    "k_scale": 2.0,
    "max_iterations": 77,
}
BY_HAND = {"search_direction": "auto", "start": "zero", "tolerance": 1e-7}


def other(method):
    return next(name for name in METHODS if name != method)


def parts(settings):
    return {name: getattr(settings, name) for name in FAST}


@pytest.mark.parametrize("method", METHODS)
def test_a_method_sets_all_its_parts_of_the_bar(method):
    assert parts(BarSettings.checked({"method": method})) == METHODS[method]


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_defaults_are_the_values_of_the_fast_method(scene):
    kind = CATALOGUE[scene]
    assert kind.checked({}).method == "fast"
    assert (
        kind().values()
        == kind.checked({}).values()
        == kind.checked({"method": "fast"}).values()
    )


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "change", [Settings.replace, Settings.with_change], ids=["replace", "with_change"]
)
def test_another_method_brings_its_parts_and_all_else_stays(method, change):
    before = BarSettings.checked({"method": other(method)} | OTHERS | BY_HAND)
    if change is Settings.replace:
        after = before.replace(method=method)
    else:
        after = before.with_change("method", method)
    assert parts(after) == METHODS[method]
    stay = before.values().keys() - {*FAST, "method"}
    assert {name: getattr(after, name) for name in stay} == {
        name: getattr(before, name) for name in stay
    }


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("method_first", [True, False])
def test_values_set_besides_a_method_are_kept_by_files_and_commands(
    method, method_first, tmp_path
):
    named = {"method": method}
    if method_first:
        values = named | BY_HAND
    else:
        values = BY_HAND | named
    expected = METHODS[method] | BY_HAND
    assert parts(BarSettings.checked(values)) == expected
    words = [f"{name}={value}" for name, value in values.items()]
    assert parts(settings_from_command("bar", words)[0]) == expected
    place, complaint = read("?" + "&".join(words))
    # A page shows the search.
    shown = expected | ({"finish": SEARCH["finish"]} if method == "fast" else {})
    assert (parts(place["settings"]), complaint) == (shown, "")
    saved = tmp_path / "few.toml"
    saved.write_text(f'scene = "bar"\nmethod = "{method}"\n', encoding="utf-8")
    assert parts(settings_from_command(str(saved), words)[0]) == expected
    assert parts(BarSettings.checked(named).replace(**BY_HAND)) == expected


def test_a_method_that_does_not_exist_is_refused_with_those_that_do(capsys):
    assert main(["run", "bar", "--set", "method=slow"]) == 2
    told = capsys.readouterr().err
    assert "method" in told
    assert "fast, paper" in told
