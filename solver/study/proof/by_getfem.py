"""GetFEM, for whatever Python on this machine has it: the block of the catalogue, solved by it."""

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
from solver.discrete.stack.stack import Stack

NAME = "GetFEM"
PROGRAM = Path(__file__).with_name("getfem_block.py")
ASKED = "import getfem; print(getfem.getfem_env('version'))"
LONGEST = 120.0
"""Seconds after which it is given up."""


class Installed(NamedTuple):
    """An interpreter that has it, and which version."""

    python: str
    version: str


class GetfemFields(NamedTuple):
    """What it finds, SI.

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

    @property
    def moved(self) -> Array:
        """How far the nodes of the support have moved along it, shape (n_lowest, n_instants)."""
        return self.displacement[0, : len(self.tangential_force)]


@cache
def installed() -> Installed | None:
    """Find it, for this interpreter or for that of the system, of which its package mostly is."""
    for python in (sys.executable, shutil.which("python3", path=os.defpath)):
        if python is None:
            continue
        said = _run([python, "-c", ASKED])
        if said is not None:
            return Installed(python, said)
    return None


def solve_block(body: Stack, python: str) -> GetfemFields:
    """Have it solve a body of bilinear elements on a support, moved at its top alone.

    What it does not find is no number.
    """
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
    said = _run([python, str(PROGRAM)], json.dumps(asked))
    if said is None:
        along, up = (number + 1 for number in body.elements)
        nothing = np.full((2, along * up, len(body.instants)), np.nan)
        return GetfemFields(nothing[0, :along], nothing[0, :along], nothing)
    answer: dict[str, Any] = json.loads(said)
    normal, tangential, moved = (
        np.array(answer[name]).T for name in ("normal", "tangential", "moved")
    )
    force = body.young * body.length
    return GetfemFields(force * normal, force * tangential, body.length * moved)


def _run(command: list[str], given: str = "") -> str | None:
    """Give the last line that a program writes, or nothing if it fails."""
    try:
        ended = subprocess.run(
            command, input=given, capture_output=True, text=True, timeout=LONGEST, check=True
        )
    except (OSError, subprocess.SubprocessError):
        return None
    lines = ended.stdout.split("\n")
    return next((line for line in reversed(lines) if line), None)
