"""Widgets that follow the state, and echoes, which browsers send of what is shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn

from app.state import PageState


class Echoes:
    """Values that the page gave to widgets, to distinguish echoes from user input.

    Panel's React wrapper sends a value back after it has shown it. Where the page gave
    the next value meanwhile, that looks as if a person had chosen the one before
    (panel/models/react_component.ts, `useState`). A value is known until the browser
    has told that it has shown it, and what replaced it (`PageState.shown`).
    """

    def __init__(self, state: PageState) -> None:
        self._state = state
        self._given: list[tuple[int, Any]] = []
        self._last: Any = None

    def show(self, widget: Any, value: Any, **more: Any) -> None:
        """Set a widget's value and other parameters, and expect the echo."""
        # In one message: the number must not be there before the value.
        with pn.io.hold():
            if value != widget.value:
                self._forget()
                self._state.given += 1
                number = self._state.given
                # A browser that is never idle may report too early: then a replaced
                # value still comes back, but never a value of the user.
                if widget.value == self._last:
                    self._given.append((number, self._last))
                self._given.append((number, value))
                self._last = value
            widget.param.update(value=value, **more)

    def has(self, value: Any) -> bool:
        """Check whether a reported value may be an echo of one that the page set."""
        self._forget()
        return any(given == value for _, given in self._given)

    def _forget(self) -> None:
        """Drop the values that the browser has shown."""
        shown = self._state.shown
        self._given = [each for each in self._given if each[0] > shown]


def linked(
    widget: Any,
    state: PageState,
    present: Callable[[], Any],
    choose: Callable[[Any], object],
) -> Callable[[], None]:
    """Link a widget to a value, in both directions.

    The present value is None where the widget has no such choice. Returns the function
    that shows the present value.
    """
    echoes = Echoes(state)

    def show() -> None:
        value = present()
        if value is not None:
            echoes.show(widget, value)

    def take(event: Any) -> None:
        # The page itself sets the widget, too.
        if event.new == present():
            return
        if echoes.has(event.new):
            show()
        else:
            choose(event.new)

    widget.param.watch(take, "value")
    return show


def linked_to(state: PageState, name: str, widget: Any) -> Any:
    """Link a widget to a parameter of the state by name; return the widget."""

    def choose(value: Any) -> None:
        state.param.update(**{name: value})

    show = linked(widget, state, lambda: getattr(state, name), choose)
    state.param.watch(lambda event: show(), name)
    return widget
