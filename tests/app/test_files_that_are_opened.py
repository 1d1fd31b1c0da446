"""A file that is opened on the page is used, or refused with a reason."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

from app.files.opener import TableOpener
from app.setting_control import OWN, SettingControl
from app.state import PageState, default_settings
from solver.files.disk import LARGEST
from solver.files.saved import dump
from solver.scenes import mesh_files
from tests.helpers.mesh_files import ABAQUS


def of_scene(scene: str) -> PageState:
    return PageState(default_settings(scene))


def held(state: PageState, name: str) -> Any:
    return getattr(state.settings, name)


def opened(opener: TableOpener, name: str, data: str | bytes) -> str:
    """Message on a file that is opened."""
    if isinstance(data, str):
        data = data.encode()
    opener.file.param.update(filename=name, value=data)
    return str(opener.message.object)


def test_a_file_is_settings_or_results_of_another_program_or_a_load_path() -> None:
    state = of_scene("bar")
    opener = TableOpener(state, "Open", ".toml,.csv", 280)
    saved = dump(state.settings)

    assert "3 points" in opened(opener, "load.csv", "time,force\n0,0\n1,800\n2,0\n")
    assert state.settings.duration == 2.0
    points = product((0.2, 0.4), (0.5, 1.0))
    rows = "".join(f"{x},{t},{x * t}\n" for x, t in points)
    assert "4 points" in opened(opener, "other.csv", f"x,t,friction force\n{rows}")
    assert state.brought is not None
    assert state.brought.source == "other.csv"
    assert "outside of the body" in opened(
        opener, "far.csv", "x,t,friction force\n3,0,0\n"
    )
    assert state.brought.source == "other.csv"
    opened(opener, "bar.toml", saved)
    assert state.settings.values() == default_settings("bar").values()


def test_a_mesh_that_is_opened_is_run_and_is_a_choice_of_its_control() -> None:
    state = of_scene("bar")
    opener = TableOpener(state, "Open", ".msh", 280)
    source = Path(mesh_files.__file__).parent / "meshes" / "dovetail.msh"
    said = opened(opener, "mine.msh", source.read_bytes())
    assert "mine.msh: 2 bodies of a mesh" in said
    assert state.settings.scene == "mesh"
    control = SettingControl("mesh", state)
    assert control.field.value == OWN
    # It has no file to go back to: only another choice changes the mesh.
    assert control.field.options == ["bolted", "dovetail", OWN]
    control.field.value = "dovetail"
    control.update()
    assert held(state, "mesh") == "dovetail"
    assert control.field.options == ["bolted", "dovetail"]
    assert "broken.msh was refused" in opened(opener, "broken.msh", b"nothing")


def test_a_mesh_of_abaqus_is_run_unless_it_is_not_whole_or_too_large() -> None:
    state = of_scene("bar")
    opener = TableOpener(state, "Open", ".msh,.inp", 280)
    said = opened(opener, "other.inp", f"{ABAQUS}*INCLUDE, INPUT=/etc/hostname\n")
    assert said.startswith("other.inp was refused")
    assert "other files that it includes" in said
    said = opened(opener, "large.inp", f"{ABAQUS}{'**' * LARGEST}")
    assert "it has more than 4 MB" in said
    assert state.settings.scene == "bar"
    whole = ABAQUS.replace("NSET=top", "NSET=top_moved_x")
    assert "squares.inp: 2 bodies of a mesh" in opened(opener, "squares.inp", whole)
    assert state.settings.scene == "mesh"


def test_a_file_that_is_refused_is_called_so_and_its_message_goes() -> None:
    state = of_scene("bar")
    opener = TableOpener(state, "Open", ".toml,.csv", 280)
    said = opened(opener, "bad.csv", "time,force\n0,0\n1,much\n")
    assert said.startswith("bad.csv was refused. ")
    assert "much" in said
    # The button does not say what became of the file.
    assert opener.file.uploaded_label == "Open"
    # As the browser has an empty file: without a name.
    opener.file.param.update(filename=None, value=None)
    assert "The file was refused. The table" in str(opener.message.object)
    assert "bad.csv" not in opened(opener, "load.csv", "time,force\n0,0\n1,800\n")
    assert state.refusal == ""
    assert opener.columns_button.visible
    state.choose_scene("block")
    assert opener.message.object == ""
    assert not opener.columns_button.visible


def test_settings_are_read_as_tables_are_and_what_is_none_is_not_shown() -> None:
    state = of_scene("bar")
    opener = TableOpener(state, "Open", ".toml,.csv", 280)
    text = dump(state.settings.replace(peak=700.0))
    opened(opener, "of_an_editor.toml", text.encode("utf-16"))
    assert held(state, "peak") == 700.0
    cut = opened(opener, "cut.toml", text[:40].encode())
    assert cut.startswith("cut.toml was refused. The settings file cannot be “cut")
    picture = opened(opener, "picture.toml", bytes(range(1, 200)))
    assert "it is no text: save the settings again" in picture
    assert "scene cannot be missing" in opened(opener, "part.toml", b"peak = 600.0")
    assert held(state, "peak") == 700.0


def test_a_file_of_before_is_said_to_have_given_the_slip_of_one_side() -> None:
    opener = TableOpener(of_scene("bar"), "Open", ".toml", 200)
    old = b'scene = "fault"\nfriction_law = "slip-dependent"\nslip_length = 1e-3\n'
    opener.file.param.update(filename="old.toml", value=old)
    assert "Slip length: the file is of a version whose slip" in opener.message.object
    assert "give 0.002 m" in opener.message.object
