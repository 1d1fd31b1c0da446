"""The wheel, installed outside the tree: the command, the engine as a library, the page."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import ROOT, Chrome, Server
from pages import status, visits
from playwright.sync_api import expect
from test_server_leaves_nothing_behind import end_with_pages

PROGRAM = """
from solver import Latin, Rods, solve
import numpy as np, solver
t = np.linspace(0.0, 1.0, 21)
rods = Rods(length=1.0, stiffness=1e6, elements=20, substructures=2, bound=np.full(21, 1500.0),
            load=900.0 * t, instants=t, duration=1.0)
print(solve(rods.discretise(), Latin()).status.ending, solver.__file__)
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give an environment that has the wheel, and of the tests' own only what it depends on."""
    folder = tmp_path_factory.mktemp("installed")
    tree = folder / "tree"
    listed = subprocess.run(
        ["git", "-c", "safe.directory=*", "ls-files", "-co", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    for name in listed:
        if name.startswith(("app/", "solver/", "static/", "pyproject.toml", "README.md")):
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            (tree / name).write_bytes((ROOT / name).read_bytes())
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    build = ["wheel", "-q", "--no-build-isolation", "--no-deps", "-w", str(folder), str(tree)]
    subprocess.run([*pip, *build], check=True)
    (wheel,) = folder.glob("*.whl")
    home = folder / "environment"
    venv.create(home, with_pip=False, symlinks=True)
    python = home / "bin" / "python"
    own = Path(sysconfig.get_path("purelib", vars={"base": str(home), "platbase": str(home)}))
    install = ["install", "-q", "--no-compile", "--no-deps", "--target", str(own), str(wheel)]
    subprocess.run([*pip, *install], check=True)
    # Behind what is installed here; no .pth of that folder is read, so the tree stays unknown.
    program = f"import sys; sys.path.append({sysconfig.get_path('purelib')!r})\n"
    (own / "dependencies.pth").write_text(program)
    script = home / "bin" / "slipfront"
    script.write_text(
        f"#!{python}\nimport sys\nfrom solver.__main__ import main\nsys.exit(main())\n"
    )
    script.chmod(0o755)
    return home


def run(place: Path, *command: str) -> subprocess.CompletedProcess[str]:
    bare = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return subprocess.run(
        [str(place / "bin" / command[0]), *command[1:]],
        cwd=place,
        env=bare,
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_command_runs_a_scene(place: Path) -> None:
    done = run(place, "slipfront", "run", "bar", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["status"] == "converged"


def test_the_command_lists_the_page_among_its_own(place: Path) -> None:
    assert "serve the page" in run(place, "slipfront", "--help").stdout


def test_a_program_outside_the_tree_solves_a_problem_of_its_own(place: Path) -> None:
    done = run(place, "python", "-c", PROGRAM)
    ending, home = done.stdout.split()
    assert ending == "converged", done.stderr
    assert Path(home).is_relative_to(place)


@pytest.fixture
def served(place: Path, tmp_path: Path) -> Iterator[Server]:
    command = [str(place / "bin" / "slipfront"), "serve"]
    made = Server(tmp_path / "log", serves=command, place=place)
    try:
        made.wait()
        yield made
    finally:
        made.stop()


def test_the_page_of_the_wheel_runs_in_a_browser_and_an_interrupt_leaves_no_process(
    served: Server, chrome: Chrome
) -> None:
    with visits(served, chrome) as visit:
        page = visit("?lesson=best-k")
        expect(page.get_by_role("button", name="Show me")).to_be_visible()
        styled = "getComputedStyle(document.querySelector('.logo img, img')).height"
        assert page.evaluate("[...document.styleSheets].length") > 0, styled
        expect(status(page)).to_contain_text("onverged")
    end_with_pages(served, signal.SIGINT)
