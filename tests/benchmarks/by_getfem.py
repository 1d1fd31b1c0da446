"""The block of the catalogue, solved by GetFEM where a Python of this machine has it.

`apt-get install python3-getfem`, then `python tests/benchmarks/by_getfem.py`
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.discrete.elements import elastic_matrix
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise

PROGRAM = Path(__file__).with_name("getfem_block.py")
VERSION = "import getfem; print(getfem.getfem_env('version'))"
LONGEST = 120.0
"""Seconds after which it is given up."""
SHEARED: dict[str, Any] = {"elements": 24, "elements_up": 12, "instants": 17}


class BlockFields(NamedTuple):
    """Fields of a block on its support, SI.

    Attributes
    ----------
    normal_force, tangential_force
        At the nodes of the support, shape (n_lowest, n_instants) each.
    displacement
        Of all nodes, row by row from below, shape (2, n_nodes, n_instants).
    """

    normal_force: Array
    tangential_force: Array
    displacement: Array


@cache
def interpreter() -> str | None:
    """Python that has GetFEM: this one, or that of the system; None without either."""
    for python in (sys.executable, shutil.which("python3", path=os.defpath)):
        if python is not None:
            try:
                _run([python, "-c", VERSION])
            except (OSError, subprocess.SubprocessError):
                continue
            return python
    return None


def by_getfem(settings: Any, python: str) -> BlockFields:
    """Solution of GetFEM of a block of bilinear elements on a support.

    The block is moved at its top alone.
    """
    body = settings.structure()
    assert body.support is not None
    top = body.sides["top"]
    asked = {
        "elements": list(body.elements),
        "height": body.height / body.length,
        "elastic": elastic_matrix(1.0, body.poisson, body.state).tolist(),
        "gap": (body.support.gap / body.length).tolist(),
        "friction": body.support.friction,
        "top": [(one.mean / body.length).tolist() for one in (top.x, top.y)],
    }
    answer = json.loads(_run([python, str(PROGRAM)], json.dumps(asked)))
    normal, tangential, moved = (
        np.array(answer[name]).T for name in ("normal", "tangential", "moved")
    )
    force = body.young * body.length
    return BlockFields(force * normal, force * tangential, body.length * moved)


def by_increments(settings: Any) -> BlockFields:
    """The same by the incremental solver."""
    problem = discretise(settings)
    reference = reference_of(problem)
    contact = reference.contact("support")
    inside = problem.inside
    assert contact.normal_force is not None
    assert inside is not None
    displacement = inside.displacement(reference.displacement, slice(None)).transpose(
        1, 0, 2
    )
    return BlockFields(contact.normal_force, contact.tangential_force, displacement)


def differences(settings: Any, python: str) -> dict[str, float]:
    """Largest difference at any node and instant, over the largest of the field."""
    theirs = by_getfem(settings, python)
    ours = by_increments(settings)
    force, moved = (
        float(np.abs(one).max()) for one in (ours.normal_force, ours.displacement)
    )
    return {
        name: float(np.abs(their - our).max()) / size
        for name, their, our, size in zip(
            BlockFields._fields, theirs, ours, (force, force, moved), strict=True
        )
    }


def _run(command: list[str], text: str = "") -> str:
    """The last line that a program writes."""
    ended = subprocess.run(
        command, input=text, capture_output=True, text=True, timeout=LONGEST, check=True
    )
    return ended.stdout.strip().split("\n")[-1]


if __name__ == "__main__":
    python = interpreter()
    if python is None:
        sys.exit("GetFEM is not installed: apt-get install python3-getfem")
    for name, difference in differences(
        CATALOGUE["block"].checked(SHEARED), python
    ).items():
        print(f"{name.replace('_', ' ')}, all nodes and instants: {difference:.1e}")
