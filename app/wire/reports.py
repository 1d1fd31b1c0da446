"""Reports, from a worker process to the server."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from app.picture.shown import Manner


@dataclass(frozen=True)
class Facts:
    """What the page's buttons and sliders have to know of a picture.

    Attributes
    ----------
    iteration, done
        The one that is shown, and how many can be.
    searched
        How many of these are iterations: an answer beside them is none.
    instants, instant, time, duration
        How many can be chosen, the one that is, its time and that of the last, s.
    interface, interfaces
        The one that is looked at, and all with friction.
    is_over
        Whether the run has ended: only another one can go on.
    is_broken
        Whether it broke, was refused, or has not begun; then nothing else holds.
    asks
        Whether it is so long or large that it has not begun, until that is agreed to.
    was_warm
        Whether it started from the run before.
    """

    iteration: int = 0
    done: int = 0
    searched: int = 0
    instants: int = 1
    instant: int = 0
    time: float = 0.0
    duration: float = 1.0
    interface: str = ""
    interfaces: tuple[str, ...] = ()
    is_over: bool = False
    is_broken: bool = False
    asks: bool = False
    was_warm: bool = False


@dataclass(frozen=True)
class Picture:
    """One iterate of one run: all views that are seen, and the words about it.

    Attributes
    ----------
    block
        As `app.wire.block` packs it, for the browser alone.
    others
        The same for those of a class who have chosen other units, or another language.
    """

    ticket: int
    facts: Facts
    block: bytes
    others: Mapping[Manner, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class File:
    """Something to be saved or said now, for this page alone and not for a class that follows it.

    Attributes
    ----------
    block
        As in `Picture`.
    """

    block: bytes


@dataclass(frozen=True)
class Died:
    """The process is gone, and all that it had; the link says it in its stead."""


Report = Picture | File | Died
