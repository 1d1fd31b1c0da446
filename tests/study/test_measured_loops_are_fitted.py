"""A measured loop is as far from a run as it was made, and a fit finds what made it."""

from __future__ import annotations

import json
import re
from functools import cache

import numpy as np
import pytest
from bars import SMALL
from small_scenes import SMALL as SMALL_SCENES

from solver.commands.cli import main
from solver.files.amounts import Unit
from solver.files.saved import scene_settings, settings_from_toml
from solver.files.tables import read_table
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study import fit_report
from solver.study.fit import Combination, _correlation, fit
from solver.study.fit_report import Called, messages, write_fit
from solver.study.measured_loop import (
    CAN,
    LoopComparison,
    MeasuredLoop,
    branches,
    loop_in,
)
from solver.study.profile_likelihood import ProfileSide
from solver.study.quantities.finished import FinishedRun
from solver.study.scene_run import finished_run

BAR = {**SMALL, "load": "cycle", "peak": 900.0}
SPRUNG = {**BAR, "friction_law": "compliant"}
FEW = {"elements": 10, "instants": 13, "substructures": 2}
"""Sizes of a bar of which a fit takes hundreds of runs."""
SMALLEST = {"elements": 4, "instants": 9, "substructures": 1}
SCENES = {**SMALL_SCENES, "bar": BAR}


@cache
def run_of(scene: str) -> FinishedRun:
    settings = scene_settings(scene).checked(SCENES[scene])
    return finished_run(settings, errors=False, indicators=False)


def loop_from(
    run: FinishedRun, *, timed: bool = True, **changes: np.ndarray
) -> MeasuredLoop:
    """Loop of a run as if it were measured, some of it changed."""
    loop = run.settings.structure().loop(run.problem)
    pair = {"displacement": run.displacement, "force": run.force} | changes
    if timed:
        times = run.problem.instants
    else:
        times = None
    return MeasuredLoop(
        *pair.values(), times, (loop.across[1], loop.up[1]), "made.csv", ""
    )


def in_text(text: str, axes: tuple[tuple[str, str], tuple[str, str]]) -> MeasuredLoop:
    return loop_in(read_table(text, "theirs.csv", "--with", CAN), axes)


def beside(run: FinishedRun, measured: MeasuredLoop) -> LoopComparison:
    return LoopComparison(
        measured, run.settings.structure().loop(run.problem), run.problem
    )


def made(
    values: dict, settings: Settings, noise: float = 0.0, seed: int = 0
) -> MeasuredLoop:
    """Displacement of a bar under other values, with noise as a share of its range."""
    run = finished_run(settings.replace(**values), errors=False, indicators=False)
    rng = np.random.default_rng(seed)
    off = noise * np.ptp(run.displacement) * rng.standard_normal(len(run.displacement))
    return loop_from(run, displacement=run.displacement + off)


@pytest.mark.parametrize("scene", SCENES)
def test_loops_are_compared_with_or_without_times(scene: str) -> None:
    run = run_of(scene)
    finds_force = beside(run, loop_from(run)).finds_force
    assert finds_force == (scene not in ("bar", "strand", "fault", "belt"))
    if finds_force:
        name = "force"
    else:
        name = "displacement"
    values = getattr(run, name)
    shifted = values + 0.1 * np.ptp(values)
    # An arch thrusts before an abutment moves; wires are pressed before a plate does.
    for timed in (True,) if scene in ("arch", "bundle") else (True, False):
        assert beside(run, loop_from(run, timed=timed)).of(run.iterate) < 1e-9
        measured = loop_from(run, timed=timed, **{name: shifted})
        assert beside(run, measured).of(run.iterate) == pytest.approx(0.1, abs=1e-9)


def test_rows_lie_anywhere_in_time_and_along_the_path() -> None:
    run = run_of("bar")
    rng = np.random.default_rng(2)
    times = np.sort(rng.uniform(0.0, 1.0, 70))
    when = run.problem.instants
    pair = [np.interp(times, when, values) for values in (run.displacement, run.force)]
    units = ("m", "N")
    timed = beside(run, MeasuredLoop(*pair, times, units, "a.csv", ""))
    assert timed.of(run.iterate) < 1e-12
    longer = [np.append(values, 0.0) for values in pair]
    later = np.append(times, 2.0)
    also = beside(run, MeasuredLoop(*longer, later, units, "a.csv", ""))
    assert (also.counted.sum(), also.of(run.iterate)) == (70, timed.of(run.iterate))
    # Between two instants around a reversal the path is cut.
    assert (
        beside(run, MeasuredLoop(*pair, None, units, "a.csv", "")).of(run.iterate)
        < 5e-3
    )


def test_a_loop_of_the_last_cycle_lies_on_the_last_cycle_of_the_run() -> None:
    settings = scene_settings("bar").checked(
        {**BAR, "cycles": 3, "friction_law": "slip-dependent"}
    )
    run = finished_run(settings, errors=False, indicators=False)
    begin, middle, end = branches(run.force)[-4:-1]
    last = slice(begin, end + 1)
    assert begin < middle < end
    measured = MeasuredLoop(
        run.displacement[last], run.force[last], None, ("m", "N"), "a.csv", ""
    )
    assert beside(run, measured).of(run.iterate) < 1e-12


@pytest.mark.parametrize("timed", [True, False])
def test_loops_that_the_run_cannot_meet_are_refused_in_words(timed: bool) -> None:
    run = run_of("bar")
    if timed:
        measured = loop_from(run)
        late = MeasuredLoop(
            measured.displacement,
            measured.force,
            measured.times + 5.0,
            ("m", "N"),
            "late.csv",
            "",
        )
        why = "late.csv.*5 s to 6 s.*leave the column of time out"
    else:
        force = 900.0 * np.sin(np.linspace(0.0, 30.0, 200))
        late = MeasuredLoop(1e-4 * force, force, None, ("m", "N"), "late.csv", "")
        why = "of the run goes one way 3 times, and the measured loop 10 times"
    with pytest.raises(SettingError, match=why):
        beside(run, late).of(run.iterate)


UNITS = (("End displacement", "m"), ("Force", "N"))


def test_heads_say_columns_and_units() -> None:
    rows = "\n".join(f"{n};{n**2 / 10};{n / 4}".replace(".", ",") for n in range(5))
    read = in_text("Zeit [ms];Kraft [kN];Weg [µm]\n" + rows, UNITS)
    assert np.allclose(read.times, 1e-3 * np.arange(5))
    assert np.allclose(read.force, 100.0 * np.arange(5) ** 2)
    assert np.allclose(read.displacement, 0.25e-6 * np.arange(5))
    assert "Kraft in kN" in read.message
    bare = in_text("u,F\n1,2\n2,3\n3,4\n5,9", UNITS)
    assert bare.times is None
    assert "u in m (no unit given), F in N (no unit given)" in bare.message
    assert np.array_equal(in_text(read.csv(), UNITS).force, read.force)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("1,2\n2,3\n3,4\n4,5", "name its columns in the first line"),
        (
            "time,force\n1,2\n2,3\n3,4\n4,5",
            "no displacement in m, .*End displacement, m",
        ),
        ("displacement,moment\n1,2\n2,3\n3,4\n4,5", "no force .*that of Force, N"),
        ("displacement,force [MPa]\n1,2\n2,3\n3,4\n4,5", "says MPa: give it in N"),
        ("displacement,force\n1,2\n2,3", "it has 2 rows: give at least 4"),
        (
            "displacement,force\n1,2\n2,2\n3,2\n4,2",
            "Force has the same value in all rows",
        ),
        ("displacement,force\n1,2\n2,x\n3,2\n4,2", "line 3 has 'x' as force"),
    ],
)
def test_tables_without_a_loop_are_refused_in_words(text: str, why: str) -> None:
    with pytest.raises(SettingError, match=why) as caught:
        in_text(text, UNITS)
    assert "theirs.csv" in str(caught.value)


@pytest.mark.parametrize(
    ("law", "true", "start"),
    [
        (BAR, {"friction": 0.37}, {"friction": 2.0}),
        # Nothing slips at the start.
        (SPRUNG | FEW, {"friction": 0.37}, {"friction": 50.0}),
        (
            SPRUNG | FEW,
            {"friction": 0.37, "contact_stiffness": 8.0},
            {"friction": 0.2, "contact_stiffness": 3.0},
        ),
    ],
)
def test_a_fit_finds_the_settings_of_the_loop(
    law: dict, true: dict, start: dict
) -> None:
    settings = scene_settings("bar").checked(law | start)
    found = fit(settings, made(true, settings), list(true))
    assert found.nearest.values == pytest.approx(list(true.values()), rel=1e-6)
    assert found.settings.friction == found.nearest.values[0]
    assert found.settings.finish == settings.finish
    assert messages(found) == []


def test_with_noise_the_settings_of_the_loop_are_within_two_standard_errors() -> None:
    """At least three in four values are; 95 % are expected."""
    true = {"friction": 0.37, "contact_stiffness": 8.0}
    settings = scene_settings("bar").checked(
        SPRUNG | FEW | {"friction": 0.3, "contact_stiffness": 6.0}
    )
    within = []
    for seed in range(2):
        found = fit(settings, made(true, settings, 0.01, seed), list(true))
        off = np.abs(found.nearest.values - list(true.values())) / found.errors
        within.extend(off < 2.0)
        assert (found.errors / found.nearest.values < 0.05).all()
        assert np.abs(found.correlation[0, 1]) < 0.9
    assert np.mean(within) >= 0.75


def test_a_correlation_is_at_most_1_and_that_with_itself_is_1() -> None:
    """Also where rounding would make it 1.0000000000000002."""
    random = np.random.default_rng(1)
    for _ in range(50):
        jacobian = random.normal(size=(5, 2))
        found = _correlation(jacobian, np.zeros((0, 2)), np.ones(2, dtype=bool))
        assert np.abs(found).max() <= 1.0
        assert np.diagonal(found).tolist() == [1.0, 1.0]


def test_settings_determined_as_a_product_only_stay_near_their_start() -> None:
    """Displacement under a given force knows mu p alone."""
    true = {"friction": 0.37, "pressure": 6000.0}
    settings = scene_settings("bar").checked(
        {**BAR, "friction": 0.3, "pressure": 4800.0}
    )
    found = fit(settings, made(true, settings, 0.01), list(true))
    assert np.isinf(found.errors).all()
    assert np.prod(found.nearest.values) == pytest.approx(0.37 * 6000.0, rel=0.02)
    # Along what is not determined nothing moves: both change by the same factor.
    assert np.divide(*(found.nearest.values / found.first.values)) == pytest.approx(
        1.0, rel=0.05
    )
    only, apart, *_ = messages(found)
    assert only.startswith("Only friction * pressure is known: ")
    assert "does not tell friction and" in apart


def test_undetermined_settings_stay_at_their_start() -> None:
    stuck = scene_settings("bar").checked(
        SPRUNG | FEW | {"friction": 1e5, "contact_stiffness": 20.0}
    )
    found = fit(
        stuck,
        made({"contact_stiffness": 8.0}, stuck),
        ["friction", "contact_stiffness"],
    )
    assert found.nearest.values == pytest.approx([1e5, 8.0], rel=1e-6)
    assert np.isinf(found.errors).tolist() == [True, False]
    assert messages(found)[0].startswith("The loop does not tell friction:")


def test_a_sum_that_is_known_alone_is_not_taken_for_its_parts() -> None:
    law = {"friction_law": "general", "tangential_stiffness": 1e8, "cohesion": 600.0}
    settings = scene_settings("bar").checked(BAR | law | SMALLEST | {"friction": 0.35})
    found = fit(settings, made({"friction": 0.37}, settings), ["friction", "cohesion"])
    assert np.isinf(found.errors).all()
    assert found.nearest.values @ [5000.0, 1.0] == pytest.approx(
        0.37 * 5000.0 + 600.0, rel=1e-6
    )
    assert messages(found)[0].startswith("Only friction * cohesion^0.")


FLAT = {**BAR, "elements": 16, "instants": 21, "substructures": 1}


def flat_valley() -> tuple[Settings, dict[str, float], MeasuredLoop]:
    """A bar whose friction and Young's modulus are known together, in noise."""
    true = {"friction": 0.54, "young": 5.95e10}
    start = scene_settings("bar").checked(
        {**FLAT, "instants": 17, "friction": 0.436, "young": 7.35e10}
    )
    return start, true, made(true, start, 0.01, seed=3)


def test_margins_in_a_flat_valley_are_those_of_the_valley() -> None:
    """The ends of a bar that slips in part tell E S mu p alone."""
    start, true, measured = flat_valley()
    found = fit(start, measured, list(true))
    values = np.array(list(true.values()))
    assert ((found.lower <= values) & (values <= found.upper)).all()
    assert np.isinf(found.errors).all()
    (product,) = found.together
    assert product.powers == pytest.approx({"friction": 1.0, "young": 1.0}, abs=0.05)
    made_of = np.prod(values ** list(product.powers.values()))
    assert product.lower <= made_of <= product.upper
    assert product.error < 0.02
    assert "friction * young" in messages(found)[0]


def test_a_fit_leaves_a_valley_that_is_not_the_deepest() -> None:
    """A front of few elements makes a valley for each of them."""
    true = {"friction": 0.233, "young": 2.71e11}
    sizes = FLAT | {"elements": 12, "substructures": 1, "peak": 233.0}
    start = scene_settings("bar").checked({**sizes, "friction": 0.162, "young": 2.5e11})
    measured = made(true, start, 0.01, seed=16)
    found = fit(start, measured, list(true))
    truth = finished_run(start.replace(**true), errors=False, indicators=False)
    assert found.nearest.distance < 1.1 * beside(truth, measured).of(truth.iterate)


def test_a_loop_straight_in_a_setting_has_a_profile_by_the_error_of_the_slope() -> None:
    settings = scene_settings("bar").checked({**FLAT, "friction_law": "compliant"})
    found = fit(settings, made({"friction": 0.37}, settings, 0.001), ["friction"])
    left = found.nearest.differences
    step = 1e-3
    moved = [
        finished_run(
            found.settings.replace(friction=found.nearest.values[0] * (1.0 + way)),
            errors=False,
            indicators=False,
        ).displacement
        for way in (-step, step)
    ]
    size = np.ptp(found.nearest.beside.measured.displacement)
    slope = (moved[1] - moved[0]) / (2.0 * step * found.nearest.values[0] * size)
    deviation = np.sqrt(left @ left / (len(left) - 1))
    assert found.errors == pytest.approx(deviation / np.linalg.norm(slope), rel=0.1)


def test_a_side_ends_where_the_misfit_last_rises_above_a_level() -> None:
    distances = np.array([0.0, 1.0, 2.0, 3.0])
    rises = np.array([0.0, 9.0, 1.0, 9.0])
    side = ProfileSide(distances, rises, is_at_bound=False)
    assert side.end(4.0) == pytest.approx(2.5)
    assert side.end(10.0) == np.inf
    at_bound = ProfileSide(distances, rises, is_at_bound=True)
    assert at_bound.end(10.0) == 3.0


def test_too_short_a_loop_is_refused() -> None:
    settings = scene_settings("bar").checked(BAR)
    four = MeasuredLoop(
        np.arange(4.0), 300.0 * np.arange(4.0), None, ("m", "N"), "a.csv", ""
    )
    with pytest.raises(
        SettingError, match="at least 5 rows for 3 settings; 4 are in the run"
    ):
        fit(settings, four, ["friction", "young", "pressure"])


@pytest.mark.parametrize(
    ("vary", "why"),
    [
        ("frction", "there is no such setting"),
        ("load", "it is no number"),
        ("elements", "it counts"),
        ("contact_stiffness", "does nothing with the other settings"),
        ("k_scale", "does not change what a run finds"),
        ("friction,friction", "one to 4 settings, each once"),
        ("friction,pressure,young,section,peak", "one to 4 settings"),
    ],
)
def test_the_command_refuses_settings_that_no_loop_tells(
    vary, why, tmp_path, capsys
) -> None:
    table, sizes = _written(tmp_path)
    options = ["--with", str(table), "--vary", vary, "--out", str(tmp_path / "out")]
    assert main(["fit", "bar", *sizes, *options]) == 2
    assert why in capsys.readouterr().err


def test_the_command_takes_settings_in_several_options(tmp_path, capsys) -> None:
    """Of two the last one alone was fitted; here it sees that both are one."""
    table, sizes = _written(tmp_path)
    options = ["--with", str(table), "--out", str(tmp_path / "out")]
    twice = ["--vary", "friction", "--vary", "friction"]
    assert main(["fit", "bar", *sizes, *options, *twice]) == 2
    assert "one to 4 settings, each once" in capsys.readouterr().err


def _written(folder):
    """A measured loop as a file, and the options of its bar."""
    sizes = BAR | FEW
    settings = scene_settings("bar").checked(SPRUNG | sizes)
    table = folder / "measured.csv"
    measured = made({"friction": 0.37, "contact_stiffness": 8.0}, settings, 0.01)
    table.write_text(measured.csv())
    return table, [f"--set={name}={value}" for name, value in sizes.items()]


def test_a_page_on_a_fit_has_the_units_of_controls_and_of_the_file(tmp_path) -> None:
    settings = scene_settings("bar").checked(SPRUNG | FEW)
    run = finished_run(settings.replace(young=2.69e11), errors=False, indicators=False)
    rows = zip(1e6 * run.displacement, 1e-3 * run.force, strict=True)
    lines = [f"{u},{f}" for u, f in rows]
    opened = in_text(
        "\n".join(["Weg [µm],Kraft [kN]", *lines]), settings.structure().axes
    )
    # The page hands a loop that it has opened to the command as a table.
    table = opened.csv()
    assert table.startswith("displacement [µm],force [kN]\n")
    measured = in_text(table, settings.structure().axes)
    assert measured.displacement == pytest.approx(run.displacement, rel=1e-8)
    assert measured.force == pytest.approx(run.force, rel=1e-8)
    write_fit(fit(settings, measured, ["young"]), measured, tmp_path)
    page = (tmp_path / "fit.html").read_text()
    text = page.partition("<body")[2].partition("<pre>")[0]
    assert "displacement in µm, force in kN" in text
    assert re.search(r">269(\.\d+)? GPa<", text)
    assert not re.search(r"\d+e[+-]\d+</td>| Pa<", text)


def test_what_is_known_together_is_in_the_units_of_its_parts() -> None:
    both = Combination({"friction": 1.0, "young": 0.5}, 3e5, 2.9e5, 3.1e5, 2.0)
    called = {"friction": Called("μ", Unit("")), "young": Called("E", Unit("GPa", 1e9))}
    sentence = fit_report.known(both, called)
    assert sentence.startswith("Only μ * E^0.5 is known: 9.48683 with E in GPa, ")
    assert "(from 9.171 to 9.803 with two)" in sentence


def test_the_commands_compare_and_fit_and_write_what_they_found(
    tmp_path, capsys
) -> None:
    table, sizes = _written(tmp_path)
    law = [*sizes, "--set=friction_law=compliant", "--set=contact_stiffness=8"]
    assert main(["compare", "bar", *law, "--with", str(table), "--json"]) == 0
    before = json.loads(capsys.readouterr().out)
    out = tmp_path / "out"
    options = ["--with", str(table), "--vary", "friction", "--out", str(out)]
    assert main(["fit", "bar", *law, *options, "--json"]) == 0
    printed = capsys.readouterr()
    found = json.loads(printed.out)
    assert found["distance_before"] == pytest.approx(before["distance"])
    assert found["distance"] == pytest.approx(0.01, rel=0.3)
    assert found["parameters"]["friction"]["value"] == pytest.approx(0.37, rel=0.05)
    assert " % away" in printed.err
    saved = settings_from_toml((out / "settings.toml").read_text())
    assert saved.friction == found["parameters"]["friction"]["value"]
    lines = (out / "parameters.csv").read_text().splitlines()
    assert lines[0].startswith("setting,unit,start,value,standard_error,lower,upper")
    # A person reads titles, a program keys.
    report = (out / "fit.html").read_text()
    assert "<script" in report
    assert "Friction coefficient" in report
    # The settings and the loop that were written are those that were found.
    assert main(["compare", str(out / "settings.toml"), "--with", str(table)]) == 0
    away = f"{100.0 * found['distance']:.4g} % from measured.csv, at 16 of 16 rows"
    assert capsys.readouterr().out == f"End displacement: {away}\n"
    fitted = in_text((out / "loop.csv").read_text(), saved.structure().axes)
    run = finished_run(saved, errors=False, indicators=False)
    assert beside(run, fitted).of(run.iterate) < 1e-6
