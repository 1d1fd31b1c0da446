"""The Dockerfile's steps without a container engine: install, serve, ask health.

The clean environment is lent what the project declares that it needs, and nothing else:
pip checks the versions, but unpacks no packages that these tests run on already.
Outside the tree, what is installed there has all that the command, the engine as a
library and the page need.
"""

from __future__ import annotations

import http.client
import json
import os
import re
import shlex
import shutil
import socket
import subprocess
import sys
import time
import tomllib
import urllib.request
import venv
from contextlib import closing
from importlib.metadata import distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from processes import PATIENCE, wait_for

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = """
from solver import End, Latin, Rods, discretise, solve
import numpy as np, solver
t = np.linspace(0.0, 1.0, 21)
rods = Rods(
    length=1.0,
    stiffness=1e6,
    elements=20,
    substructures=2,
    strength=np.full(21, 1500.0),
    left=End(displacement=0.0 * t),
    right=End(force=900.0 * t),
    instants=t,
    duration=1.0,
)
print(solve(discretise(rods), Latin()).status.ending, solver.__file__)
"""


WORKBOOK = """
import openpyxl
from pathlib import Path
from solver.files.tables import read_table
book = openpyxl.Workbook()
for row in (["u [mm]", "F [N]"], [0, 0], [2.5, 40]):
    book.active.append(row)
book.save("rig.xlsx")
table = read_table(Path("rig.xlsx").read_bytes(), "rig.xlsx", "--with", "a table")
print(table.numbers.tolist())
"""
EXAMPLE = """
import runpy
from solver.commands.cli import main
assert main(["example", "two_bricks"]) == 0
runpy.run_path("two_bricks.py", run_name="__main__")
"""
COMMANDS = """
try:
    main(["--help"])
except SystemExit as end:
    print("help ends with", end.code)
"""


def dockerfile() -> list[tuple[str, str]]:
    """Instructions of the Dockerfile, with joined lines and without comments."""
    text = (ROOT / "Dockerfile").read_text()
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    joined = "\n".join(lines).replace("\\\n", " ")
    return [tuple(line.split(None, 1)) for line in joined.splitlines() if line.strip()]


def instructions(name: str) -> list[str]:
    return [rest for word, rest in dockerfile() if word == name]


def installation():
    """Words of the command that installs the project."""
    (install,) = [run for run in instructions("RUN") if run.startswith("pip install")]
    return shlex.split(install)


def declared():
    """Distributions that the installation needs, directly or not."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))[
        "project"
    ]
    lines = list(project["dependencies"])
    # ".[NAME,...]" asks for extras; a name makes a requirement of it
    for extra in Requirement(f"slipfront{installation()[-1].removeprefix('.')}").extras:
        lines += project["optional-dependencies"][extra]
    found = {}
    for line in lines:
        needed = Requirement(line)
        if needed.name not in found and (
            not needed.marker or needed.marker.evaluate({"extra": ""})
        ):
            found[needed.name] = distribution(needed.name)
            lines += found[needed.name].requires or []
    return list(found.values())


def lend(found, environment):
    """Link a distribution's modules into an environment, and write its programs."""
    (packages,) = environment.glob("lib/python*/site-packages")
    for file in found.files:
        if file.parts[0] == "..":
            if file.parent.name == "bin":
                text = Path(found.locate_file(file)).read_text(encoding="utf-8")
                program = environment / "bin" / file.name
                program.write_text(
                    f"#!{environment / 'bin' / 'python'}\n{text.split(None, 1)[1]}"
                )
                program.chmod(0o755)
        elif not (packages / file.parts[0]).exists():
            (packages / file.parts[0]).symlink_to(found.locate_file(file.parts[0]))


@pytest.fixture(scope="module")
def image(tmp_path_factory):
    """Copy as the Dockerfile does, and run its installation in a clean environment."""
    folder = tmp_path_factory.mktemp("image")
    for copied in instructions("COPY"):
        *sources, target = copied.split()
        for source in sources:
            if (ROOT / source).is_dir():
                ignore = shutil.ignore_patterns("__pycache__")
                shutil.copytree(ROOT / source, folder / target, ignore=ignore)
            else:
                shutil.copy(ROOT / source, folder / target)
    environment = folder.parent / "environment"
    venv.create(environment, symlinks=True)
    for found in (*declared(), distribution("pip"), distribution("setuptools")):
        lend(found, environment)
    variables = dict(
        os.environ, PATH=f"{environment / 'bin'}{os.pathsep}{os.environ['PATH']}"
    )
    variables.pop("PYTHONPATH", None)
    for pair in re.findall(r"(\w+)=(\S+)", " ".join(instructions("ENV"))):
        variables[pair[0]] = pair[1]
    # what builds it is lent too, and what is served for seconds need not be compiled
    quick = [*installation(), "-q", "--no-build-isolation", "--no-compile"]
    subprocess.run(quick, cwd=folder, env=variables, check=True)
    return folder, variables


def test_the_image_is_slim_not_root_and_has_one_blas_thread():
    (base,) = instructions("FROM")
    assert base.endswith("-slim")
    (user,) = instructions("USER")
    assert user != "root"
    variables = " ".join(instructions("ENV"))
    assert "OPENBLAS_NUM_THREADS=1" in variables
    assert "BOKEH_ALLOW_WS_ORIGIN" not in variables


def handshake(port, origin):
    """Answer to a page of some origin that asks for a websocket."""
    asked = http.client.HTTPConnection("127.0.0.1", int(port), timeout=PATIENCE)
    with closing(asked):
        asked.request(
            "GET",
            "/app/ws",
            headers={
                "Connection": "Upgrade",
                "Upgrade": "websocket",
                "Sec-WebSocket-Key": "c2xpcGZyb250IHNsaXBmcg==",
                "Sec-WebSocket-Version": "13",
                "Origin": origin,
            },
        )
        return asked.getresponse().status


def listens(port):
    with socket.socket() as asking:
        return asking.connect_ex(("127.0.0.1", port)) == 0


def test_the_installed_page_serves_and_is_healthy(image, tmp_path):
    folder, variables = image
    (port,) = instructions("EXPOSE")
    with socket.socket() as free:
        # Whoever runs the page while the tests run has the container's own port.
        free.bind(("127.0.0.1", 0))
        other = str(free.getsockname()[1])
    (command,) = [json.loads(rest.replace(port, other)) for rest in instructions("CMD")]
    (health,) = instructions("HEALTHCHECK")
    check = json.loads(health[health.index("CMD") + 3 :].replace(port, other))
    program = shutil.which(command[0], path=variables["PATH"])
    python = shutil.which(check[0], path=variables["PATH"])
    with (tmp_path / "log").open("w") as log:
        server = subprocess.Popen(
            [program, *command[1:]], cwd=folder, env=variables, stdout=log, stderr=log
        )
    try:
        wait_for(lambda: listens(int(other)) or server.poll() is not None)
        end = time.monotonic() + PATIENCE
        while subprocess.run(
            [python, *check[1:]], capture_output=True, check=False
        ).returncode:
            assert time.monotonic() < end, (tmp_path / "log").read_text()
            assert server.poll() is None, (tmp_path / "log").read_text()
            time.sleep(0.5)
        with urllib.request.urlopen(
            f"http://127.0.0.1:{other}/app", timeout=PATIENCE
        ) as page:
            assert b"Slipfront" in page.read()
        assert handshake(other, f"http://localhost:{other}") == 101
        assert handshake(other, "http://elsewhere.example") == 403
    finally:
        server.terminate()
        server.wait(PATIENCE)


def run(image, place, *command):
    """Run a program of the image where nothing of the tree is."""
    _, variables = image
    program = shutil.which(command[0], path=variables["PATH"])
    return subprocess.run(
        [program, *command[1:]],
        cwd=place,
        env=variables,
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_command_runs_a_scene(image, tmp_path):
    done = run(image, tmp_path, "slipfront", "run", "bar", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["status"] == "converged"


@pytest.fixture(scope="module")
def lines(image, tmp_path_factory):
    """Lines that four programs print in one process, where nothing of the tree is."""
    place = tmp_path_factory.mktemp("outside")
    program = PROGRAM + WORKBOOK + EXAMPLE + COMMANDS
    done = run(image, place, "python", "-c", program)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_a_program_outside_the_tree_solves_a_problem_of_its_own(image, lines):
    folder, _ = image
    ending, home = lines[0].split()
    assert ending == "converged"
    assert Path(home).is_relative_to(folder.parent / "environment")


def test_a_workbook_is_read(lines):
    assert json.loads(lines[1]) == [[0.0, 2.5], [0.0, 40.0]]


def test_an_example_is_written_and_runs(lines):
    assert "certified: True" in lines[2:]


def test_the_command_lists_the_page_among_its_own(lines):
    assert any("serve the page" in line for line in lines)
    assert lines[-1] == "help ends with 0"


def test_a_port_in_use_is_named_in_a_line() -> None:
    panel = str(Path(sys.executable).with_name("panel"))
    with socket.socket() as taken:
        taken.bind(("", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        found = subprocess.run(
            [panel, "serve", "app", "--port", port],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )
    assert found.returncode != 0
    assert f"port {port} is already in use" in found.stderr.splitlines()[-1]
    assert "Traceback" not in found.stderr
