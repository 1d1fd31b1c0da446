"""The Pythons that are promised are those that are tested, and the container's is one of them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from packaging.specifiers import SpecifierSet

ROOT = Path(__file__).resolve().parents[1]
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


def test_the_code_is_linted_for_the_oldest_and_the_readme_names_it() -> None:
    oldest = min(PROMISED, key=minor)
    assert PROJECT["tool"]["ruff"]["target-version"] == f"py{oldest.replace('.', '')}"
    assert f"Python {oldest}" in (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_container_has_one_of_them() -> None:
    (version,) = re.findall(r"^FROM python:(3\.\d+)", (ROOT / "Dockerfile").read_text(), re.M)
    assert version in PROMISED
