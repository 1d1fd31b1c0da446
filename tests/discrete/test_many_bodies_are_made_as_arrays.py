"""An arch takes no work of Python for each voussoir but a few calls."""

from __future__ import annotations

from counting import calls_of
from shaped import arch

from solver.discrete import discretise


def test_a_further_voussoir_takes_few_calls() -> None:
    arches = {voussoirs: arch(voussoirs) for voussoirs in (31, 121)}
    # What is made once for all, and kept, does not count.
    for structure in arches.values():
        discretise(structure)

    def made(voussoirs: int) -> int:
        return calls_of(lambda: discretise(arches[voussoirs]))

    # Each voussoir is a substructure; its joint and what it shares are arrays. With
    # its own meshes, frames and laws it took several hundred.
    assert made(121) - made(31) <= 90 * 90
