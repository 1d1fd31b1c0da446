"""A tour of all controls of a scene on the page, each moved as by a user, and what follows."""

from __future__ import annotations

import math
import re
from html import unescape
from typing import Any

import param
from pages import Visit, choose, slider
from playwright.sync_api import Page, TimeoutError, expect
from tour import SIZES, Move, described, ends, has_errors, never_apply, small, tour

from app.form import POINTS
from solver.definitions import Curve, about
from solver.settings import Settings

ITERATIONS = 10
LONGEST = 1000
SMALL_ERROR = 2.0
"""Friction force error at the end, %."""
OVER = re.compile(r"after (\d+) iteration")
ERROR = re.compile(r"friction force error ([0-9.]+)(?:·10<sup>(-?\d+)</sup>)? %")
POLL_MS = 30
MODEL = """
const known = window.knownModels ??= new Map()
const model = (name) => {
  if (known.has(name)) { return known.get(name) }
  for (const found of Bokeh.documents[0]._all_models.values()) {
    if (found.css_classes && found.css_classes.includes(name)) {
      known.set(name, found)
      return found
    }
  }
}
const text = (name) => model(name).text.replaceAll("&lt;", "<").replaceAll("&gt;", ">")
const before = () => (text("figures").match(/before \\((.*?)\\)/) || ["", ""])[1]
"""


class Tour:
    """One page, and what its controls show."""

    def __init__(self, visit: Visit, scene: str) -> None:
        sizes = {**SIZES[scene], "max_iterations": ITERATIONS}
        query = "&".join(f"{name}={value}" for name, value in sizes.items())
        self.base = small(scene).replace(max_iterations=ITERATIONS)
        self.page: Page = visit(f"?scene={scene}&{query}")
        self._await_end("-", self.base)
        choose(self.page.get_by_role("combobox", name=re.compile("^Pace")), "as fast as it can")
        # What all views make of it is tested without a browser, which paints one the sooner.
        boxes = self.page.get_by_role("checkbox")
        # A menu hides all else from roles until it has closed.
        boxes.first.wait_for()
        for box in boxes.all()[1:]:
            box.press("Space")
        expect(self.page.locator(".card")).to_have_count(1)
        self.page.get_by_text("More settings").click()
        slider(self.page, "Most iterations").wait_for()
        self.touched: set[str] = set()

    def go(self) -> None:
        """Move all controls; after each move the run goes on, with its errors."""
        for move in tour(self.base, ends):
            self.touched.add(move.name)
            try:
                if move.after is None:
                    self._move(move)
                    self._await_value(move.name, move.before)
                elif move.starts_a_run:
                    self.run_after(move)
            except TimeoutError as late:
                words = self._evaluate('[text("status"), before()]')
                raise AssertionError(f"{described(move)}: {words}") from late
        missing = set(self.base.definitions()) - self.touched
        assert missing == never_apply(self.base.scene)

    def run_after(self, move: Move) -> str:
        """Make a move, and give what the status line says once the run has ended."""
        assert move.after is not None
        former = self._evaluate("before()")
        self._move(move)
        words = self._await_end(former, move.after)
        where = f"{described(move)}: {words}"
        assert OVER.search(words), where
        assert ERROR.search(words) or not has_errors(move.after), where
        return words

    def assert_errors_are_small(self) -> None:
        after = self.base.replace(max_iterations=LONGEST)
        words = self.run_after(Move("max_iterations", LONGEST, self.base, after))
        found = ERROR.search(words)
        assert found is not None
        assert float(found[1]) * 10.0 ** int(found[2] or 0) < SMALL_ERROR

    def _move(self, move: Move) -> None:
        """Press the key that moves a slider to its end, or have the widget send a value."""
        name, value = move.name, move.value
        definition = move.before.definitions()[name]
        place = self.page.locator(f".setting-{name}")
        if isinstance(definition, param.Boolean):
            place.get_by_role("switch").press("Space")
        elif isinstance(definition, param.Selector | Curve):
            # Also one that does not apply, and is hidden, as it is brought back last.
            place.locator("select").evaluate(
                """(select, value) => {
                  select.value = value
                  select.dispatchEvent(new Event("change"))
                }""",
                value if isinstance(value, str) else POINTS,
            )
        elif value in definition.softbounds:
            key = "Home" if value == definition.softbounds[0] else "End"
            place.get_by_role("slider").press(key)
        else:
            at = math.log10(value) if about(definition).logarithmic else value
            # What `fill` refuses as no step: the number nearest to it that the slider takes.
            place.locator("input[type=range]").evaluate(
                """(range, at) => {
                  range.value = at
                  range.dispatchEvent(new Event("input"))
                  range.dispatchEvent(new Event("change"))
                }""",
                at,
            )

    def _evaluate(self, expression: str) -> Any:
        return self.page.evaluate(f"() => {{{MODEL} return {expression}}}")

    def _await_value(self, name: str, settings: Settings) -> None:
        """Wait until a control has gone back to what holds."""
        value = getattr(settings, name)
        place = self.page.locator(f".setting-{name}")
        if isinstance(settings.definitions()[name], param.Selector | Curve):
            shown = value if isinstance(value, str) else POINTS
            expect(place.locator("select")).to_have_value(shown)
        elif isinstance(value, bool):
            expect(place.get_by_role("switch")).to_be_checked(checked=value)
        else:
            self.page.wait_for_function(
                """([range, value]) =>
                  Math.abs(range.ariaValueNow - value) <= 1e-3 * Math.abs(value)""",
                arg=[place.get_by_role("slider").element_handle(), value],
                polling=POLL_MS,
            )

    def _await_end(self, former: str, settings: Settings) -> str:
        """Wait until another run has ended, and its errors are told where it has any."""
        found = self.page.wait_for_function(
            f"""([former, hasErrors]) => {{{MODEL}
              if (!window.Bokeh || !Bokeh.documents.length || !model("status")) {{ return false }}
              const words = text("status")
              if (/broke|gave|stopped/.test(words)) {{ return words }}
              const isTold = !hasErrors || /force error/.test(words)
              return before() !== former && isTold && /after \\d+ iter/.test(words) && words
            }}""",
            arg=[former, has_errors(settings)],
            polling=POLL_MS,
        )
        return unescape(str(found.json_value()))
