"""A control of every kind of a scene on the page, moved as by a user, and what follows."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import param
from pages import Visit, choose_scene, open_sheets, slider
from playwright.sync_api import Page, TimeoutError, expect
from processes import wait_for
from tour import SIZES, Move, back, described, has_choice, one_end, small

from app.components.form import POINTS
from solver.definitions import CurveParameter, Parameter, SettingError, about
from solver.scenes.entry import Entry
from solver.settings import Settings

ITERATIONS = 10
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
// Pictures that have come since this was first asked.
const pictures = () => {
  if (window.pictured === undefined) {
    window.pictured = 0
    const all = [...Bokeh.documents[0]._all_models.values()]
    all.find((one) => one.class_name === "Pulse").on_event("esm_event", () => { pictured += 1 })
  }
  return window.pictured
}
const text = (name) => model(name).text.replaceAll("&lt;", "<").replaceAll("&gt;", ">")
const FAILED = /broke|gave|given|stopped/
const over = () => /after \\d+ iter.*force error/.test(text("status"))
"""
WATCH = """(() => {
  window.broken = []
  const status = model("status")
  status.properties.text.change.connect(() => {
    if (FAILED.test(text("status"))) { window.broken.push(text("status")) }
  })
})()"""
"""Keeps what any status line says of a run that did not go on."""


def applying(base: Settings) -> set[str]:
    """Give the settings that are to have a control."""
    definitions = base.definitions().items()
    return {name for name, one in definitions if base.applies(name) and has_choice(one)}


def kind(definition: Parameter) -> str:
    """Tell controls apart that a page makes and hears otherwise."""
    if isinstance(definition, CurveParameter | param.Boolean | param.Selector):
        return type(definition).__name__
    return f"{type(definition).__name__}, logarithmic: {about(definition).logarithmic}"


def moves(base: Settings) -> Iterator[Move]:
    """Move the first control of each kind to an end that is not refused, and back."""
    seen: set[str] = set()
    for name in filter(applying(base).__contains__, base.definitions()):
        (value,) = one_end(base, name)
        try:
            after = base.with_change(name, value)
        except SettingError:
            continue
        if kind(base.definitions()[name]) not in seen:
            seen.add(kind(base.definitions()[name]))
            yield Move(name, value, base, after)
            yield from back(after, base)


class Tour:
    """One page, and what its controls show."""

    def __init__(self, visit: Visit, scene: str) -> None:
        asked = {**SIZES[scene], "max_iterations": ITERATIONS, "pace": "fastest", "plots": "Scene"}
        query = "&".join(f"{name}={value}" for name, value in asked.items())
        self.base = small(scene).replace(max_iterations=ITERATIONS)
        self.page: Page = visit(f"?scene={scene}&{query}", height=400)
        self._await("over()")
        open_sheets(self.page)
        # What all views make of it is tested without a browser, which has more to do than to paint.
        self.page.get_by_role("checkbox", name="Scene").press("Space")
        expect(self.page.locator(".card")).to_have_count(0)
        slider(self.page, "Most iterations").wait_for()
        self._evaluate(WATCH)

    def go(self) -> None:
        """Move a control of each kind to an end and back; after each move a picture comes.

        All other controls and ends, and the errors of the runs, are tested without a browser.
        """
        for move in moves(self.base):
            try:
                shown = self._evaluate("pictures()")
                self._move(move)
                self._await(f"pictures() > {shown}")
                self._await_value(move.name, move.after)
            except TimeoutError as late:
                words = self._evaluate('[text("status"), window.broken]')
                raise AssertionError(f"{described(move)}: {words}") from late
        assert self._evaluate("window.broken") == []

    def assert_there_is_a_control_for_all_that_applies(self, scene: Entry[Any]) -> None:
        """Choose a scene, and wait until its controls are there."""
        choose_scene(self.page, scene.title)
        base = scene.settings.checked({})
        names, expected = list(base.definitions()), applying(base)
        place = self.page.locator(".sidebar [class*=setting-]:visible")

        def seen() -> set[str]:
            classes = place.evaluate_all("(all) => all.flatMap((one) => [...one.classList])")
            return {one.removeprefix("setting-") for one in classes} & set(names)

        with suppress(AssertionError):
            wait_for(lambda: seen() == expected)
        assert seen() == expected

    def _move(self, move: Move) -> None:
        """Press the key that moves a slider to its end, or have the widget send a value."""
        name, value = move.name, move.value
        definition = move.before.definitions()[name]
        place = self.page.locator(f".setting-{name}")
        if isinstance(definition, param.Boolean):
            place.get_by_role("switch").press("Space")
        elif isinstance(definition, param.Selector | CurveParameter):
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
        if isinstance(settings.definitions()[name], param.Selector | CurveParameter):
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

    def _await(self, condition: str) -> None:
        """Wait until something is so on the page, or a run did not go on."""
        self.page.wait_for_function(
            f"""() => {{
              if (!window.Bokeh || !Bokeh.documents.length) {{ return false }}
              {MODEL}
              return model("status") && (FAILED.test(text("status")) || {condition})
            }}""",
            polling=POLL_MS,
        )
        assert not self._evaluate("FAILED.test(text('status')) && text('status')")
