"""HTML from templates: what is filled in is text, whatever it says."""

import tomllib
from html.parser import HTMLParser
from pathlib import Path

import jinja2
import pytest
from hypothesis import given
from hypothesis import strategies as st

import app.widgets
from solver.files.templates import templates_in
from solver.study import page
from solver.study.page import Panel, PanelAxis, PlotSection, write_page

ROOT = Path(__file__).resolve().parents[2]
STUDY = Path(page.__file__).parent
MARKUP = "<img src=x onerror=go()> & \"'</pre><b>{{ 7 * 7 }}"
REPORTS = {
    "sweep.html": {
        "counts": MARKUP,
        "all_hold": False,
        "growth": [MARKUP],
        "rows": [[MARKUP], [MARKUP]],
        "settings": [MARKUP],
    },
    "fit.html": {"sentences": [MARKUP], "rows": [[MARKUP], ["1"]], "settings": MARKUP},
    "study.html": {
        "heading": MARKUP,
        "times": [[MARKUP], ["1"]],
        "sizes": [["1"], [MARKUP]],
        "notes": [MARKUP],
        "conditions": [MARKUP],
    },
    "figures.html": {
        "figures": [
            {
                "heading": MARKUP,
                "claim": MARKUP,
                "verdict": MARKUP,
                "sentences": [MARKUP],
                "caption": MARKUP,
            }
        ]
    },
    "stability.html": {
        "summary": MARKUP,
        "counts": [[MARKUP], [MARKUP]],
        "judges": [[MARKUP], [MARKUP]],
        "notes": [MARKUP],
        "names": [MARKUP],
        "runs": [([MARKUP], MARKUP)],
    },
    "proof.html": {
        "page": MARKUP,
        "summary": MARKUP,
        "names": [MARKUP],
        "parts": {
            MARKUP: [
                {
                    "address": MARKUP,
                    "case": MARKUP,
                    "mesh": MARKUP,
                    "source": MARKUP,
                    "rows": [[MARKUP]],
                }
            ]
        },
    },
}
"""Values of the reports' templates, all of which are markup."""
PARTS = {
    "status.html": {
        "lead": MARKUP,
        "rest": MARKUP,
        "details": [MARKUP],
        "said": MARKUP,
        "is_running": True,
    },
    "figures.html": {
        "owner": MARKUP,
        "figures": {MARKUP: MARKUP},
        "hints": {MARKUP: MARKUP},
    },
    "class_dialog.html": {"code": MARKUP, "link": MARKUP, "picture": "", "port": 1},
    "keys.html": {"curves": [{"label": MARKUP, "dash": MARKUP, "color": MARKUP}]},
    "charts.html": {"heading": MARKUP, "keys": "", "panels": []},
    "experiments/reports.html": {"title": MARKUP, "page": MARKUP},
}
"""The same of the page's templates that are filled with words."""


class Reader(HTMLParser):
    """A reader of HTML that notes its elements, attributes and texts."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[str] = []
        self.texts: list[str] = []
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append(tag)
        self.texts += [value or "" for _, value in attrs]

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def read_as_text(html: str) -> None:
    reader = Reader(html)
    assert "img" not in reader.elements
    assert "macro" not in reader.elements
    assert any(MARKUP in text for text in reader.texts)


@pytest.mark.parametrize("name", REPORTS)
def test_nothing_in_a_report_becomes_markup(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page, "renderer", lambda: None)
    axis = PanelAxis(MARKUP)
    plots = [PlotSection(MARKUP, [Panel(MARKUP, axis, axis, ())])]
    write_page(tmp_path / name, name, plots, title=MARKUP, **REPORTS[name])
    read_as_text((tmp_path / name).read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", PARTS)
def test_nothing_on_the_page_becomes_markup(name: str) -> None:
    read_as_text(app.widgets.html(name, **PARTS[name]))


def test_every_template_is_installed_with_its_package() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    data = tomllib.loads(text)["tool"]["setuptools"]["package-data"]
    for package in ("app", "solver"):
        folder = ROOT / package
        installed: set[Path] = set()
        for pattern in data[package]:
            installed.update(folder.glob(pattern))
        templates = {*folder.rglob("*.html"), *folder.rglob("*.svg")}
        assert templates
        assert templates <= installed


def test_every_report_has_its_values_here() -> None:
    frames = {"page.html", "parts.html"}
    assert {file.name for file in STUDY.glob("*.html")} == REPORTS.keys() | frames


@given(st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0\r")))
def test_a_text_is_read_as_it_was_filled_in(text: str) -> None:
    reader = Reader(
        app.widgets.html("figures.html", owner="", figures={"": f"|{text}|"}, hints={})
    )
    assert "".join(reader.texts).split("|", 1)[1].rsplit("|", 1)[0] == text


def test_a_value_that_is_missing_is_no_empty_text(tmp_path: Path) -> None:
    (tmp_path / "one.html").write_text("<p>{{ word }}</p>", encoding="utf-8")
    with pytest.raises(jinja2.UndefinedError, match="word"):
        templates_in(tmp_path).get_template("one.html").render()
