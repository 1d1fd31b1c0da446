"""The parts know each other in one direction only."""

import ast
import re
import subprocess
import sys
from collections import defaultdict
from functools import cache
from graphlib import TopologicalSorter
from itertools import chain
from pathlib import Path

import pytest

from solver.scenes import CATALOGUE

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "solver" / "examples"
LAYERS = [
    "arrays",
    "refusal",
    "checks",
    "cache",
    "laws",
    "discrete",
    "reference",
    "reduction",
    "latin",
    "settings",
    "scenes",
    "files",
    "study",
    "commands",
    "__main__",
]
"""Rooms of the solver; each may import itself and what stands before it. Problem and
method stand before all that knows settings and scenes."""
GRAPHICS = {"panel", "bokeh", "holoviews", "panel_material_ui", "pandas", "app"}
ABOVE = {"method", "run_cost", "stop_rules", "iteration", "solve", "slabs"}
"""Files of the method that put its parts to work."""


def floors():
    """Modules and folders of the page, line by line of the list in its README."""
    text = (ROOT / "app" / "README.md").read_text(encoding="utf-8")
    section = text.partition("## Where do I change what")[2].partition("\n## ")[0]
    lines = re.findall(r"^- (.*(?:\n  .*)*)", section, re.MULTILINE)
    return [
        [
            path.removesuffix(".py").rstrip("/").replace("/", ".")
            for path in re.findall(r"`([\w/]+(?:\.py|/))`", line)
        ]
        for line in lines
    ]


FLOORS = floors()
"""Parts of the page from the top to the bottom; each imports from its own line and from
those below."""


def modules(package):
    """Path of every module of a package, by its full name.

    The scripts of `solver/examples` are no modules: they are written beside a user, may
    import Panel, and nothing imports them.
    """
    found = {}
    for path in sorted((ROOT / package).rglob("*.py")):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        if path.parent != EXAMPLES:
            found[name.removesuffix(".__init__")] = path
    return found


SOLVER = modules("solver")
PAGE = modules("app")
EVERY = SOLVER | PAGE


@cache
def imports(module):
    """The names of all that a module imports, anywhere in it, also for types."""
    path = EVERY[module]
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            found.add(node.module)
            found.update(f"{node.module}.{alias.name}" for alias in node.names)
    return found


def place(module, places):
    """Number of the place that a module has, or that above all."""
    part = module.split(".")[1]
    for number, parts in enumerate(places):
        if part == parts or part in parts:
            return number
    return len(places)


def floor(module):
    """Line of the list in which a module of the page, or else its folder, stands."""
    name = module.removeprefix("app.")
    for part in (name, name.partition(".")[0]):
        for number, parts in enumerate(FLOORS):
            if part in parts:
                return number
    raise AssertionError(f"{module} is not in the list of app/README.md")


def graphics_in(some, graphics):
    return [
        one for one in some if {name.split(".")[0] for name in imports(one)} & graphics
    ]


def test_neither_the_solver_nor_a_worker_of_the_page_imports_graphics():
    assert graphics_in(SOLVER, GRAPHICS) == []
    worker = [name for name in PAGE if name.startswith("app.worker")]
    assert graphics_in(worker, GRAPHICS - {"app"}) == []


def all_imported_by(module):
    """A module of the page, and those of the page that it imports, directly or not."""
    found = set()
    waiting = {module}
    while waiting:
        one = waiting.pop()
        found.add(one)
        waiting |= (imports(one) & PAGE.keys()) - found
    return found


def test_a_command_that_draws_a_report_imports_no_widgets():
    """Widgets would take a sixth of the time in which its charts are imported."""
    drawing = all_imported_by("app.charts")
    assert "app.templates" in drawing
    assert graphics_in(drawing, {"panel_material_ui"}) == []


@pytest.fixture(scope="module")
def ran():
    """A command in a process in which graphics cannot be imported."""
    program = (
        "import sys\n"
        f"sys.modules.update(dict.fromkeys({sorted(GRAPHICS)!r}))\n"
        "from solver.commands.cli import main\n"
        "code = main(['run', 'bar', '--set', 'peak=0'])\n"
        "print(*sys.modules)\n"
        "sys.exit(code)\n"
    )
    return subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT,
        check=False,
        capture_output=True,
        text=True,
    )


def test_the_engine_runs_where_graphics_cannot_be_imported(ran):
    assert ran.returncode == 0, ran.stderr


def test_a_command_imports_what_few_runs_need_only_when_it_is_needed(ran):
    """Some modules would take a quarter of the time in which a command begins."""
    imported = set(ran.stdout.splitlines()[-1].split())
    assert "scipy.sparse" in imported
    seldom = {"optimize", "ndimage", "spatial", "cluster", "special"}
    assert not {f"scipy.{part}" for part in seldom} & imported
    seldom = {"pebble", "meshio", "openpyxl"}
    assert not seldom & imported


def test_imports_inside_the_solver_go_one_way():
    parts = SOLVER.keys() - {"solver"}
    for module in parts:
        own = place(module, LAYERS)
        assert own < len(LAYERS), f"{module} has no room"
        for name in imports(module) & parts:
            same = name.split(".")[1] == module.split(".")[1]
            assert same or place(name, LAYERS) < own, f"{module} imports {name}"


def test_imports_inside_the_page_go_one_way():
    parts = PAGE.keys() - {"app"}
    for module in parts:
        for name in imports(module) & parts:
            assert floor(name) >= floor(module), f"{module} imports {name}"


def test_the_list_of_the_engine_has_all_its_rooms_and_no_other():
    assert set(LAYERS) == {name.split(".")[1] for name in SOLVER.keys() - {"solver"}}


def test_the_list_of_the_page_names_files_that_exist():
    assert FLOORS
    for name in chain.from_iterable(FLOORS):
        path = ROOT / "app" / name.replace(".", "/")
        assert path.is_dir() or path.with_suffix(".py").is_file(), name


@pytest.mark.parametrize("package", [SOLVER, PAGE], ids=["solver", "app"])
def test_no_module_imports_itself_by_detours(package):
    TopologicalSorter({one: imports(one) & package.keys() for one in package}).prepare()


@pytest.mark.parametrize(
    "package",
    [
        "solver",
        "solver.laws",
        "solver.discrete",
        "solver.discrete.plane",
        "solver.discrete.plane.makers",
        "solver.discrete.plane.rectangles",
        "solver.reference",
        "solver.reduction",
        "solver.latin",
        "solver.settings",
        "solver.scenes",
        "solver.files",
        "solver.study",
        "app",
        "app.worker",
        "app.views",
        "app.files",
        "app.lessons",
        "app.experiments",
    ],
)
def test_no_folder_imports_itself_by_detours(package):
    """A sub-folder counts as one place, and so does a file that stands beside it."""
    inside = {name for name in EVERY if name.startswith(f"{package}.")}
    places = {name: name.removeprefix(f"{package}.").split(".")[0] for name in inside}
    graph = defaultdict(set)
    for name in inside:
        graph[places[name]] |= {places[other] for other in imports(name) & inside}
    for own, others in graph.items():
        others.discard(own)
    TopologicalSorter(graph).prepare()


def test_the_parts_of_the_method_stand_below_what_puts_them_to_work():
    inside = {name for name in SOLVER if name.startswith("solver.latin.")}
    for name in inside:
        if name.split(".")[2] not in ABOVE:
            used = {other.split(".")[2] for other in imports(name) & inside}
            assert not used & ABOVE, name


def test_bodies_of_any_shape_know_none_of_their_makers():
    plane = "solver.discrete.plane"
    inside = {name for name in SOLVER if name.startswith(f"{plane}.")}
    makers = {name for name in inside if name.split(".")[3] == "rectangles"}
    assert makers
    for name in inside - makers:
        assert not imports(name) & makers, name


def test_scenes_are_reached_by_the_catalogue_alone():
    scenes = {f"solver.scenes.{scene}" for scene in CATALOGUE}
    for name in EVERY:
        assert name.startswith("solver.scenes") or not imports(name) & scenes, name


def test_examples_are_scripts_that_nothing_imports():
    assert not (EXAMPLES / "__init__.py").exists()
    for name in EVERY:
        assert not any(other.startswith("solver.examples") for other in imports(name))
