"""The parts know each other in one direction only, and the project keeps its shape."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import defaultdict
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
TOP_LEVEL = {"pyproject.toml", "app", "solver", "static", "tests", "Dockerfile", "README.md"}
LAYERS = [
    ["arrays"],
    ["refusal"],
    ["laws"],
    ["discrete"],
    ["reference"],
    ["reduction"],
    ["latin"],
    ["definitions"],
    ["disk"],
    ["units"],
    ["columns"],
    ["tables"],
    ["checked"],
    ["methods"],
    ["settings"],
    ["instants"],
    ["loads"],
    ["profiles"],
    ["scenes"],
    ["remarks"],
    ["curves"],
    ["files"],
    ["prepared"],
    ["running"],
    ["study"],
    ["lessons", "mesh_command", "report_commands", "compare_command"],
    ["sweep_command"],
    ["cli"],
    ["__main__"],
]
"""Parts of the solver; each may import itself and what stands before it. Problem and method stand
before all that knows settings and scenes."""
LONGEST_FILE, LONGEST_FUNCTION = 400, 50
GRAPHICS = {"panel", "bokeh", "holoviews", "panel_material_ui", "pandas", "app"}


def modules(package):
    """Give the path of every module of a package, by its full name."""
    found = {}
    for path in sorted((ROOT / package).rglob("*.py")):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        found[name.removesuffix(".__init__")] = path
    return found


SOLVER = modules("solver")
EVERY = SOLVER | modules("app")
PARTS = ["local", "linear", "acceleration", "direction", "start", "finish", "criteria"]
"""Folders of the method's parts; files beside them put parts to work."""
GROUND = ["blocks", "iterate", "indicators", "cycle"]
"""Files beside them on which parts stand."""


class AtWork(ast.NodeTransformer):
    """Leaves out what is imported for types."""

    def visit_If(self, node):  # named by the library
        return None if getattr(node.test, "id", "") == "TYPE_CHECKING" else node


@cache
def imports(path):
    """The names of all modules that a file imports, anywhere in it but for types alone."""
    found = set()
    for node in ast.walk(AtWork().visit(ast.parse(path.read_text(encoding="utf-8")))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            found.add(node.module)
            found.update(f"{node.module}.{alias.name}" for alias in node.names)
    return found


FLOORS = [
    ["units", "frame", "messages"],
    ["worker"],
    ["refusals", "state"],
    ["views"],
]
"""Parts of the page; each may import itself, what stands beside it and before it. All others are
above, and in no worker."""


def functions(path):
    """Give the name and the length of all functions of a file, docstrings included."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, node.end_lineno - node.lineno + 1


def layer(module):
    part = module.split(".")[1]
    return next(number for number, parts in enumerate(LAYERS) if part in parts)


def run(*command):
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_the_solver_imports_no_graphics():
    tops = {name: {one.split(".")[0] for one in imports(path)} for name, path in SOLVER.items()}
    assert [name for name, found in tops.items() if found & GRAPHICS] == []


def test_the_engine_runs_where_graphics_cannot_be_imported():
    program = (
        "import sys\n"
        f"sys.modules.update(dict.fromkeys({sorted(GRAPHICS)!r}))\n"
        "from solver.cli import main\n"
        "sys.exit(main(['run', 'bar', '--set', 'peak=0']))\n"
    )
    assert run(sys.executable, "-c", program).returncode == 0


def test_imports_inside_the_solver_go_one_way():
    parts = SOLVER.keys() - {"solver"}
    wrong = [
        f"{module} imports {name}"
        for module in parts
        for name in imports(SOLVER[module]) & parts
        if name.split(".")[1] != module.split(".")[1] and layer(name) >= layer(module)
    ]
    assert wrong == []


def test_no_module_of_the_solver_imports_itself_by_detours():
    graph = {module: imports(path) & SOLVER.keys() for module, path in SOLVER.items()}
    order = list(TopologicalSorter(graph).static_order())
    assert set(order) == set(SOLVER)


@pytest.mark.parametrize(
    "package",
    [
        "solver",
        "solver.discrete",
        "solver.reference",
        "solver.latin",
        "solver.study",
        "app.worker",
        "app.views",
    ],
)
def test_no_folder_imports_itself_by_detours(package):
    """A sub-folder counts as one place, and so does a file that stands beside it."""
    inside = {name: path for name, path in EVERY.items() if name.startswith(f"{package}.")}
    place = {name: name.removeprefix(f"{package}.").split(".")[0] for name in inside}
    graph = defaultdict(set)
    for name, path in inside.items():
        graph[place[name]] |= {place[other] for other in imports(path) & inside.keys()}
    for own, others in graph.items():
        others.discard(own)
    TopologicalSorter(graph).prepare()


def test_the_parts_of_the_method_stand_below_what_puts_them_to_work():
    inside = {name: path for name, path in SOLVER.items() if name.startswith("solver.latin.")}
    for name, path in inside.items():
        below = {other.split(".")[2] for other in imports(path) & inside.keys()}
        if name.split(".")[2] in PARTS:
            assert below <= {*PARTS, *GROUND}, name


def test_every_part_of_the_solver_has_its_layer():
    parts = {name.split(".")[1] for name in SOLVER if name != "solver"}
    assert parts == {part for parts in LAYERS for part in parts}


def test_files_and_functions_are_of_a_size_to_read():
    for path in (*SOLVER.values(), *modules("app").values()):
        assert len(path.read_text(encoding="utf-8").splitlines()) <= LONGEST_FILE, path
        long = {name: lines for name, lines in functions(path) if lines > LONGEST_FUNCTION}
        assert long == {}, path


@pytest.mark.parametrize("package", ["solver", "app"])
def test_a_class_name_has_one_meaning(package):
    places = defaultdict(list)
    for name, path in modules(package).items():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                places[node.name].append(name)
    assert {name: found for name, found in places.items() if len(found) > 1} == {}


def floor(module):
    part = module.split(".")[1]
    return next((n for n, parts in enumerate(FLOORS) if part in parts), len(FLOORS))


def test_imports_inside_the_page_go_one_way():
    page = {name: path for name, path in modules("app").items() if name != "app"}
    wrong = [
        f"{name} imports {other}"
        for name, path in page.items()
        for other in imports(path) & page.keys()
        if floor(other) > floor(name)
    ]
    assert wrong == []


def test_a_worker_imports_no_graphics():
    worker = [name for name in modules("app") if name.startswith("app.worker")]
    tops = {name: {each.split(".")[0] for each in imports(EVERY[name])} for name in worker}
    assert [name for name, names in tops.items() if names & (GRAPHICS - {"app"})] == []


def test_no_module_of_the_page_imports_itself_by_detours():
    page = modules("app")
    graph = {name: imports(path) & page.keys() for name, path in page.items()}
    TopologicalSorter(graph).prepare()


def test_continuous_integration_lints_types_and_tests_with_the_commands_of_the_readme():
    """A fresh clone is typed in twenty seconds, which whoever tests alone need not wait."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    done = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert done[-1].endswith("-m pytest")
    checks = [line for line in done if "ruff check" in line]
    assert "ruff format --check" in checks[0]
    assert checks[0].endswith("mypy")
    assert {*checks, done[-1]} <= {line.strip() for line in readme}


def test_the_top_level_is_what_the_design_names():
    done = run("git", "-c", "safe.directory=*", "ls-files")
    assert done.returncode == 0, done.stderr
    top = {line.split("/")[0] for line in done.stdout.splitlines()}
    assert {name for name in top if not name.startswith(".")} == TOP_LEVEL
