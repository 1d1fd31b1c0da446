"""How the time of an iteration, and the number of them, grow with the size of a problem."""

from __future__ import annotations

import statistics
from dataclasses import dataclass

from solver.definitions import SettingError
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.scenes import discretise, entry_of
from solver.settings import Settings
from solver.study.error_against_time import INCREMENTAL, by_increments, course_of, forms_of
from solver.study.exponent import Exponent, exponent_of
from solver.study.progress import Tell, silent

MEASURED = (
    "LATIN multiscale",
    "LATIN auto k, nested, Anderson",
    "LATIN auto k, Anderson",
)
LEVEL = 0.01
"""Error of the friction force up to which iterations are counted."""


@dataclass(frozen=True)
class Size:
    """One size of one method.

    Attributes
    ----------
    seconds
        Of an iteration (its median over the run), or of the whole incremental solution.
    iterations, total
        Iterations and seconds, set-up included, to 1 % of friction force error; None where 300
        do not suffice, and iterations None for the incremental solver.
    """

    size: int
    seconds: float
    iterations: int | None
    total: float | None


@dataclass(frozen=True)
class Growth:
    """A method's sizes along one setting."""

    setting: str
    method: str
    sizes: tuple[Size, ...]

    @property
    def exponent(self) -> Exponent | None:
        """With which the seconds grow with the size; None below two sizes."""
        return exponent_of([one.size for one in self.sizes], [one.seconds for one in self.sizes])


def growth(settings: Settings, tell: Tell = silent) -> list[Growth]:
    """Measure all sizes; those that the scene cannot have are left out."""
    found: dict[tuple[str, str], list[Size]] = {}
    sizes_of = entry_of(settings).sizes
    every = [(setting, size) for setting, sizes in sizes_of.items() for size in sizes]
    for number, (setting, size) in enumerate(every):
        tell(f"Growth: {size} {setting}", number / len(every))
        try:
            changed = settings.replace(**{setting: size})
        except SettingError:
            continue
        for method, measured in _one_size(changed, size).items():
            found.setdefault((setting, method), []).append(measured)
    return [Growth(setting, method, tuple(sizes)) for (setting, method), sizes in found.items()]


def _one_size(settings: Settings, size: int) -> dict[str, Size]:
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    seconds = statistics.median(by_increments(settings) for _ in range(3))
    found = {INCREMENTAL: Size(size, seconds, None, seconds)}
    for method, form in forms_of(settings).items():
        if method not in MEASURED:
            continue
        course = course_of(method, form, distance, LEVEL)
        reached = course.reached(LEVEL)
        found[method] = Size(
            size,
            course.seconds_per_iteration or float(course.seconds[0]),
            int(reached[1]) if reached else None,
            reached[0] if reached else None,
        )
    return found
