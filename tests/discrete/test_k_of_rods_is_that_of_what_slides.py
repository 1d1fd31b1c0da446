"""k of rods: the stiffness of the stretch that slides, whatever the mesh."""

from __future__ import annotations

from functools import partial
from itertools import islice

import numpy as np
import pytest

from solver.discrete.rods.cut_rods import problem_of
from solver.discrete.rods.end import End
from solver.discrete.rods.loads import sliding_length
from solver.discrete.rods.rods import Rods
from solver.latin import Auto, Latin, iterations
from solver.latin.direction.directions import automatic
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.settings.load_paths import PRESETS

TIME = np.linspace(0.0, 1.0, 11)
STIFFNESS = 6e5
CLAMPED = End(displacement=0.0 * TIME)
FREE = End()
PULLED = End(force=900.0 * TIME)


def rod(elements: int = 100, length: float = 2.0, **changes) -> Rods:
    """A rod of ES = 6e5 N, clamped at the left and pulled at the right by default."""
    given = {
        "length": length,
        "stiffness": STIFFNESS,
        "elements": elements,
        "substructures": 4,
        "strength": np.full(elements + 1, 450.0),
        "left": CLAMPED,
        "right": PULLED,
        "instants": TIME,
        "duration": 1.0,
    }
    return Rods(**given | changes)


def waves(number: int, elements: int = 400) -> np.ndarray:
    """Body force of a number of sines along a rod, N/m."""
    places = np.linspace(0.0, 2.0 * np.pi * number, elements + 1)
    return np.multiply.outer(np.sin(places), TIME)


@pytest.mark.parametrize("elements", [10, 300])
def test_all_of_a_rod_that_is_pulled_at_an_end_slides(elements: int) -> None:
    assert sliding_length(rod(elements)) == pytest.approx(2.0, rel=0.06)
    mirrored = rod(elements, left=PULLED, right=CLAMPED)
    assert sliding_length(mirrored) == pytest.approx(2.0, rel=0.06)


@pytest.mark.parametrize("number", [1, 3])
def test_a_wave_of_load_lets_its_share_of_a_clamped_rod_slide(number: int) -> None:
    found = sliding_length(
        rod(400, right=CLAMPED, body_force=waves(number, elements=400))
    )
    # A sine of wavelength l has |u| / |u'| = l / (2 pi).
    assert found == pytest.approx(np.sqrt(3.0) * 2.0 / number / (2.0 * np.pi), rel=0.02)


@pytest.mark.parametrize("elements", [1, 2, 3])
@pytest.mark.parametrize("right", [PULLED, CLAMPED], ids=["pulled", "clamped"])
def test_a_coarse_rod_has_a_length_that_slides(elements: int, right: End) -> None:
    coarse = {"substructures": 1, "body_force": 5.0 * TIME}
    found = sliding_length(rod(elements, right=right, **coarse))
    assert 0.4 < found <= 2.0


@pytest.mark.parametrize(
    "changes",
    [
        {"right": FREE},
        {"left": FREE},
        {"left": End(displacement=0.0 * TIME, spring=1.0), "body_force": 5.0 * TIME},
        {"left": End(displacement=1e-3 * TIME, spring=1e6), "right": FREE},
        {"left": End(displacement=0.0 * TIME, spring=1e-15)},
    ],
    ids=[
        "nothing moves",
        "nothing holds",
        "a soft spring",
        "a moved spring",
        "a spring as soft as rounding",
    ],
)
def test_all_of_it_counts_where_nothing_tells(changes: dict[str, object]) -> None:
    assert sliding_length(rod(**changes)) == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize(
    "changes",
    [
        {"right": End(displacement=1e-3 * TIME)},
        {"right": CLAMPED, "strain": np.multiply.outer(np.full(100, 1e-4), TIME)},
        {"right": CLAMPED, "body_force": 5.0 * TIME},
        {"right": CLAMPED, "elements": 2, "substructures": 1},
    ],
    ids=["moved", "heated between clamps", "loaded along", "coarse"],
)
def test_half_of_it_counts_between_ends_whose_displacement_is_given(
    changes: dict[str, object],
) -> None:
    given = {"strength": np.full(int(changes.get("elements", 100)) + 1, 450.0)}
    assert sliding_length(rod(**given | changes)) == pytest.approx(1.0, rel=1e-3)


def test_heat_and_settling_ground_slide_as_far_as_the_force_of_their_strain() -> None:
    strain = np.multiply.outer(np.cos(np.linspace(0.0, 3.0 * np.pi, 100)), TIME) * 1e-4
    ground = np.insert(np.cumsum(-strain, axis=0) * 0.02, 0, 0.0, axis=0)
    heated = rod(strain=strain, right=FREE)
    settled = rod(settlement=ground, right=FREE)
    assert sliding_length(heated) < 1.0
    assert sliding_length(settled) == pytest.approx(sliding_length(heated))


def test_k_of_a_node_is_pi_es_over_the_length_that_slides_whatever_the_mesh() -> None:
    for elements in (40, 160):
        problem = problem_of(rod(elements))
        scale = problem.scales.force / problem.scales.displacement
        rows = problem.contacts["friction"].tangent.above
        # The whole rod slides: 900 N are all that friction can carry.
        wanted = np.pi * STIFFNESS / 2.0
        cuts = np.isin(np.arange(elements + 4), [0, elements + 3])
        inner = automatic(problem)[rows][~cuts] * scale
        assert inner.max() == pytest.approx(wanted, rel=0.03)


SEARCHES = {name: {"load": name} for name in PRESETS} | {
    "heated": {"peak": 0.0, "temperature": 100.0},
    "heated far": {"peak": 0.0, "temperature": 400.0},
    "on ground that stretches": {
        "peak": 0.0,
        "settlement": 3e-3,
        "settlement_profile": "linear",
    },
    "moved": {
        "right_end": "held",
        "right_displacement": 1e-3,
        "right_load": "cycle",
    },
}


@pytest.mark.parametrize(
    "changes",
    SEARCHES.values(),
    ids=SEARCHES,
)
def test_a_search_from_zero_ends_within_sixty_iterations(
    changes: dict[str, object],
) -> None:
    settings = BarSettings.checked(changes)
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    for iterate in iterations(problem, Latin(finish=None)):
        if distance.of_friction_force(iterate) < 0.01:
            break
    # With the mean of ES/s and ES/h for k presets of the load take up to 93; heated far
    # it takes more than 200 with k of a rod of which two points alone slide.
    assert iterate.number <= 60


def test_a_search_without_macro_forces_ends_within_a_hundred_iterations() -> None:
    problem = discretise(BarSettings())
    distance = distance_to(reference_of(problem), problem)
    method = Latin(multiscale=False, finish=None)
    found = islice(iterations(problem, method), 100)
    # With the k on cuts that suits macro forces it is 13 % wrong after 200.
    assert any(distance.of_friction_force(iterate) < 0.01 for iterate in found)


def test_k_on_cuts_is_the_papers_only_where_long_waves_have_to_cross_them() -> None:
    problem = discretise(BarSettings())
    cuts = np.concatenate([first for first, _ in problem.cuts])
    paper = problem.direction[cuts]
    begin = partial(Auto().begin, problem, None)
    assert begin(multiscale=False).k[cuts] == pytest.approx(paper)
    assert begin(multiscale=True).k[cuts] == pytest.approx(10.0 * paper)
    short = begin(waves=0.04, multiscale=False)
    assert short.k[cuts] == pytest.approx(10.0 * paper)
