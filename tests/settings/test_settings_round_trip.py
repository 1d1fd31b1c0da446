"""Settings never change, and every front reads what another wrote."""

import json

import pytest

from app.link import query_of, read
from solver.files.saved import dump, settings_from_command, settings_from_toml
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings
from solver.settings.values import allowed, parse
from solver.study.random_runs import draw


@pytest.mark.parametrize("scene", CATALOGUE)
def test_files_addresses_commands_and_results_give_the_same_settings_again(scene):
    for row in range(4):
        chosen = draw(scene, 5, row)
        values = chosen.values()
        again = settings_from_toml(dump(chosen))
        assert type(again) is type(chosen)
        assert again.values() == values
        place, complaint = read(query_of({"settings": chosen}))
        assert (place["settings"].values(), complaint) == (values, "")
        texts = [f"{name}={json.dumps(value)}" for name, value in values.items()]
        assert settings_from_command(scene, texts)[0].values() == values
        assert type(chosen).checked(json.loads(json.dumps(values))).values() == values


@pytest.mark.parametrize("scene", CATALOGUE)
def test_settings_are_immutable(scene):
    chosen = draw(scene, 1, 1)
    before = chosen.values()
    for name, value in draw(scene, 1, 2).values().items():
        hash(value)
        if value is not before[name]:
            with pytest.raises(TypeError, match="onstant"):
                setattr(chosen, name, value)
    assert chosen.values() == before


def test_a_change_gives_new_settings_and_leaves_the_old_ones():
    chosen = BarSettings.checked({"load": [[0.0, 1.0], [1.0, 2.0]]})
    changed = chosen.replace(load="ramp")
    assert (chosen.load, changed.load) == (((0.0, 1.0), (1.0, 2.0)), "ramp")
    fewer = chosen.with_change("elements", 4)
    assert (fewer.elements, fewer.substructures, chosen.substructures) == (4, 4, 10)


def test_every_setting_says_what_it_is():
    for name, definition in BarSettings.definitions().items():
        assert definition.doc
        assert allowed(definition)
        assert parse(json.dumps(definition.default)) == definition.default
        given_again = BarSettings.checked({name: definition.default})
        assert given_again.values() == BarSettings().values()


def test_a_saved_file_takes_changes_from_the_command_line(tmp_path):
    saved = tmp_path / "saved.toml"
    saved.write_text(
        dump(BarSettings.checked({"peak": 700.0, "elements": 20})), encoding="utf-8"
    )
    found, _ = settings_from_command(str(saved), ["peak=800", "load=ramp"])
    assert (found.peak, found.elements, found.load) == (800.0, 20, "ramp")
