"""Links of the papers lead somewhere, and what they promise is tested."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest
from benchmarks.draw_architecture import main as main_of_picture
from packaging.specifiers import SpecifierSet

from solver.commands.cli import main

ROOT = Path(__file__).resolve().parents[1]
FRONT = ROOT / "README.md"
PAGE = ROOT / "app" / "README.md"
ENGINE = ROOT / "solver" / "README.md"
MATHEMATICS = ROOT / "solver" / "MATHEMATICS.md"
MEASUREMENTS = ROOT / "solver" / "study" / "README.md"
LESSONS = ROOT / "app" / "lessons" / "README.md"
SWEEPS = ROOT / "solver" / "study" / "sweep" / "README.md"
CASES = ROOT / "solver" / "study" / "cases" / "README.md"
METHOD = ROOT / "solver" / "latin" / "README.md"
EXTENDING = ROOT / "solver" / "EXTENDING.md"
READMES = [FRONT, PAGE, LESSONS, CASES, ENGINE, METHOD, MEASUREMENTS, SWEEPS]
PAPERS = [*READMES, MATHEMATICS, EXTENDING]
CITED = {"MATHEMATICS.md": MATHEMATICS}
"""Papers that are cited by their name alone; others by their path."""
NAMES = [str(readme.relative_to(ROOT)) for readme in READMES]
PAPER_NAMES = [str(paper.relative_to(ROOT)) for paper in PAPERS]


def words(path: Path) -> str:
    """Text of a file with every line break as one space."""
    return " ".join(path.read_text(encoding="utf-8").split())


def headings(path: Path) -> list[str]:
    return re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)


def anchor(heading: str) -> str:
    """Heading in the form of an address."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def paths_in(readme: Path) -> set[str]:
    """Words in backticks that look like a file of the repository, or a folder."""
    text = re.sub(r"https?://\S+|`NAME[^`]*`", "", readme.read_text(encoding="utf-8"))
    files = re.findall(r"(?<![\w/.])[\w./-]+\.(?:py|md|png|svg|css)\b", text)
    return {*files, *re.findall(r"`([\w./-]+/)`", text)}


@pytest.mark.parametrize("readme", PAPERS, ids=PAPER_NAMES)
def test_every_path_that_is_named_exists(readme: Path) -> None:
    gone = [
        name
        for name in paths_in(readme)
        if not any((start / name).exists() for start in (readme.parent, ROOT))
    ]
    assert not gone


@pytest.mark.parametrize("readme", READMES, ids=NAMES)
def test_every_program_runs(readme: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for program in re.findall(
        r"^```python\n(.*?)^```", readme.read_text("utf-8"), re.M | re.S
    ):
        exec(compile(program, readme.name, "exec"), {})
        assert "converged" in capsys.readouterr().out


@pytest.mark.parametrize("readme", PAPERS, ids=PAPER_NAMES)
def test_every_link_leads_somewhere(readme: Path) -> None:
    for target in re.findall(r"\]\(([^)]+)\)", readme.read_text(encoding="utf-8")):
        if target.startswith("http"):
            continue
        name, _, place = target.partition("#")
        if name:
            page = (readme.parent / name).resolve()
        else:
            page = readme
        assert page.exists(), target
        assert not place or place in map(anchor, headings(page)), target


@pytest.mark.parametrize("readme", PAPERS, ids=PAPER_NAMES)
def test_every_command_that_is_named_is_one(
    readme: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    known = set(re.findall(r"^    (\w+) ", capsys.readouterr().out, re.MULTILINE))
    assert "run" in known
    assert set(re.findall(r"python -m solver (\w+)", words(readme))) <= known


PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROMISED = [
    line.rpartition(" :: ")[2]
    for line in PROJECT["project"]["classifiers"]
    if re.fullmatch(r"Programming Language :: Python :: 3\.\d+", line)
]


def minor(version: str) -> int:
    return int(version.split(".")[1])


def test_what_may_be_installed_is_what_is_promised() -> None:
    allowed = SpecifierSet(PROJECT["project"]["requires-python"])
    minors = sorted(map(minor, PROMISED))
    assert minors == list(range(minors[0], minors[-1] + 1))
    assert all(f"3.{number}" in allowed for number in minors)
    assert f"3.{minors[0] - 1}.99" not in allowed


def test_the_container_has_one_of_them() -> None:
    (version,) = re.findall(
        r"^FROM python:(3\.\d+)", (ROOT / "Dockerfile").read_text(), re.M
    )
    assert version in PROMISED


def test_the_version_is_one() -> None:
    version = PROJECT["project"]["version"]
    text = FRONT.read_text(encoding="utf-8")
    assert f"Slipfront, version {version}," in text
    _, _, changes = text.partition("## Changes")
    assert re.findall(r"^\*\*(.*)\*\*$", changes, re.MULTILINE)[0] == version


def test_the_front_is_short() -> None:
    assert len(FRONT.read_text(encoding="utf-8").split()) < 2500


def test_the_picture_of_the_rooms_names_every_package(tmp_path: Path) -> None:
    main_of_picture(tmp_path / "rooms.svg")
    for picture in (tmp_path / "rooms.svg", ROOT / "static" / "architecture.svg"):
        drawn = ElementTree.fromstring(picture.read_text(encoding="utf-8"))
        words = set(re.findall(r"\w+", " ".join(drawn.itertext())))
        for package in ("solver", "app"):
            for room in (ROOT / package).rglob("__init__.py"):
                assert room.parent.name in words, room


def citations(path: Path) -> list[tuple[str, list[str]]]:
    """Papers that a file cites, each with the numbers of sections."""
    text = path.read_text(encoding="utf-8")
    between = r"(?:,[\s#]+(?:and[\s#]+)?|[\s#]+and[\s#]+)"
    found = re.findall(rf"([\w./]+\.md)`?((?:{between}\d+\b)+)", text)
    return [(paper, re.findall(r"\d+", numbers)) for paper, numbers in found]


def test_every_section_that_is_cited_exists() -> None:
    count = 0
    for folder in ("app", "solver", "tests"):
        for path in (ROOT / folder).rglob("*"):
            if path.suffix not in (".py", ".md", ".toml", ".html"):
                continue
            for name, numbers in citations(path):
                paper = CITED.get(name, ROOT / name)
                assert paper.exists(), (path, name)
                known = {heading.split(".")[0] for heading in headings(paper)}
                assert set(numbers) <= known, (path, name)
                count += len(numbers)
    assert count > 40


def test_every_module_of_the_engine_is_named_once_in_its_map() -> None:
    text = ENGINE.read_text(encoding="utf-8")
    _, _, section = text.partition("## What is where")
    section = section.partition("\n[How to add](EXTENDING.md)")[0]
    named = re.findall(r"`([\w/]+\.py)`", section)
    paths = set(ENGINE.parent.rglob("*.py"))
    paths -= set(ENGINE.parent.rglob("__init__.py"))
    paths -= set(ENGINE.parent.glob("examples/*.py"))
    modules = [str(path.relative_to(ENGINE.parent)) for path in paths]
    assert sorted(named) == sorted(modules)


def test_mathematics_and_map_share_one_numbering() -> None:
    both = [*headings(MATHEMATICS), *headings(ENGINE)]
    numbers = [int(heading.split(".")[0]) for heading in both if heading[0].isdigit()]
    assert sorted(numbers) == list(range(1, len(numbers) + 1))
