"""A figure of the paper, drawn again, with the claim that it tests and the numbers that decide."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from solver.study.chart import Panel

LOAD = (
    "The paper's load path (Fig. 2b) is lost; taken here: one period of a sine of 900 N, "
    "relaxation 0.8, all else as in Table 1."
)


@dataclass(frozen=True)
class Finding:
    """A measured answer to a claim, or to a part of it.

    Attributes
    ----------
    text
        One sentence with the numbers in it.
    values
        The same numbers by name.
    holds
        Whether they bear out the claim.
    """

    text: str
    values: Mapping[str, float]
    holds: bool


@dataclass(frozen=True, eq=False)
class PaperFigure:
    """A figure of the paper, drawn again.

    Attributes
    ----------
    number
        Its number in the paper.
    claim
        What the paper says that it shows, in one sentence.
    caption
        What is drawn, and the choices that the paper leaves.
    """

    number: int
    title: str
    panels: tuple[Panel, ...]
    claim: str
    findings: tuple[Finding, ...]
    caption: str

    @property
    def heading(self) -> str:
        """Number and title."""
        return f"Fig. {self.number}: {self.title}"

    @property
    def values(self) -> dict[str, float]:
        """All numbers of the findings, by name."""
        return {name: value for found in self.findings for name, value in found.values.items()}

    @property
    def verdict(self) -> str:
        """Whether the claim holds: "holds", "holds in part" or "does not hold"."""
        held = [found.holds for found in self.findings]
        return "holds" if all(held) else "holds in part" if any(held) else "does not hold"
