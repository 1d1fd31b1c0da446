"""Events of the browser: keys, window, address, history, network."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import panel as pn
from bokeh.core.properties import Bool, Int, String
from bokeh.events import DocumentReady
from bokeh.model import DataModel
from bokeh.models import CustomJS

from app.state import PageState
from app.views.parts import KEEP_SHEETS
from app.views.scene import NEAR

BEHIND = 200
"""Time for which a value that the browser sent before it told that it has shown all may
still be on its way, ms: Panel gathers values for 50 ms."""
TAKEN = (
    "input, textarea, select, [role=slider], [role=tab], [role=dialog]"
    ", [role=combobox], [role=listbox]"
)
"""Elements that take keys for themselves (a CSS selector)."""
COPY = """
const link = browser.copied
if (link) {
  navigator.clipboard?.writeText(link).catch(() => prompt("The link", link))
}
"""
MET = "localStorage.setItem('slipfront', 'met')"
"""Script that notes that this browser has met the page."""
SPEAK = "document.getElementById('spoken').textContent = browser.spoken"
"""Script that has a text spoken: in one element, of which screen readers follow the
text. A pane of Panel makes its content again, which they may pass over."""
GO = "if (browser.destination) { location.search = browser.destination }"
"""Script that opens the page of another address, also one that is there already."""
FADE = """
const style = document.documentElement.style
style.setProperty("--seen", browser.is_stale ? 0.3 : 1)
style.setProperty("--fading", browser.is_stale ? "0.1s 0.15s" : "0s")
"""
"""Script that fades what is of a run before the present one; a short wait is no change.
A class of the page's columns would have Bokeh lay out all figures again."""
TELL = """
// Once idle, React has shown all values, and sent back those that it sends back.
const idle = window.requestIdleCallback ?? ((tell) => setTimeout(tell, 500))
const given = browser.given
idle(() => { browser.shown = given }, {timeout: 5000})
"""
"""Script that tells that the values are shown which the page gave to widgets. Beside
pictures that follow each other the browser may never be idle, and a person's choice of
such a value is not to wait."""
ACTS = """
const count = ({repeat}) => { browser.acts += repeat ? 0 : 1 }
for (const kind of ["pointerdown", "keydown"]) {
  addEventListener(kind, count, {capture: true})
}
"""
"""Script that sends a message before that of any widget that a person uses. BokehJS
sends models whole that have come since its last message, and the server would warn of a
widget among them."""
LISTEN = """
const measure = () => {
  browser.setv({height: innerHeight, is_narrow: innerWidth < 900})
}
measure()
addEventListener("resize", measure)
const spoken = document.createElement("div")
spoken.id = "spoken"
spoken.setAttribute("role", "status")
spoken.style = "position: fixed; top: 0; overflow: hidden; clip-path: inset(50%)"
document.body.append(spoken)
spoken.textContent = browser.spoken
// A property that keeps its value tells nothing: the same address may come back twice,
// and an address may be empty.
addEventListener("popstate", () => {
  browser.search = ""
  browser.search = location.search || "?"
})
document.addEventListener("keydown", (event) => {
  const target = event.composedPath()[0]
  const isPressing = event.key == " " && target.closest?.("button")
  const isTaken = target.closest?.(taken) || isPressing
  const isBrowsers = event.ctrlKey || event.metaKey || event.altKey
  const isShifted = event.shiftKey && event.key.startsWith("Arrow")
  const name = (isShifted ? "Shift+" : "") + event.key
  if (isTaken || isBrowsers || !names.includes(name)) { return }
  event.preventDefault()
  browser.pressed = name
  browser.count += 1
})
// Without a storage every visit would be the first.
try {
  browser.is_new = !location.search && localStorage.getItem("slipfront") == null
} catch {}
"""
HOLD = f"""
const hold = (event) => {{
  const path = event.composedPath()
  const isScene = path.some((each) => each.getAttribute?.("aria-label") == "Scene")
  const canvas = path.find((each) => each.matches?.(".bk-events"))
  const handles = browser.document.get_model_by_name("handles")
  if (!isScene || !canvas || !handles) {{ return }}
  const [touch] = event.changedTouches
  const box = canvas.getBoundingClientRect()
  const at = [touch.clientX - box.x, box.bottom - touch.clientY]
  const {{x, y}} = handles.data
  const isNear = (x, y) => Math.hypot(at[0] - x, at[1] - y) <= {NEAR}
  if (Array.from(x).some((each, n) => isNear(each, y[n]))) {{ event.preventDefault() }}
}}
document.addEventListener("touchstart", hold, {{passive: false}})
"""
"""Script that has a finger on a handle of the picture drag it. Elsewhere on the picture
a finger scrolls the page, and then the browser breaks off what it drags."""

NETWORK = """
const sign = document.createElement("div")
sign.id = "network"
sign.setAttribute("role", "status")
document.body.append(sign)
let isLost = false
const tell = () => {
  if (!navigator.onLine) {
    sign.textContent = "No network: what is shown stays as it is until there is one."
  } else if (isLost) {
    sign.textContent = "The server does not answer: the page tries again."
  } else {
    sign.textContent = ""
  }
}
addEventListener("offline", tell)
addEventListener("online", tell)
// Of a socket that is open again Bokeh tells only where it could pull the page anew.
const look = (connection) => {
  isLost = connection.deref()?.socket?.readyState != WebSocket.OPEN
  tell()
  if (isLost) { setTimeout(look, 500, connection) }
}
browser.document.on_event("connection_lost", (_, {connection}) => {
  if (!isLost) { look(connection) }
})
"""
"""Script that says that the device has no network, whose socket may close minutes
later, or that the socket has closed. Bokeh's own notifications, which Panel switches
off, cannot take back what they said of a network."""

CHOOSE = """
const openedBy = (keys) => (event) => {
  const target = event.composedPath()[0]
  if (target.matches?.("div[role=combobox]") && keys.includes(event.key)) {
    target.click()
  }
}
document.addEventListener("keydown", openedBy(["Enter", "ArrowDown", "ArrowUp"]))
// As it comes up, this key chooses what has the focus.
document.addEventListener("keyup", openedBy([" "]))
"""
"""Script that has keys open a select: a click alone opens panel-material-ui's."""
RETURN = """
let opener = null
const isClosing = ({key}, target) =>
  key == "Escape" || (key == "Enter" && target.closest("[aria-label=close]"))
const giveBack = (tries) => setTimeout(() => {
  if (document.activeElement == document.body) {
    opener?.focus()
  } else if (tries > 0) {
    giveBack(tries - 1)
  }
}, 100)
document.addEventListener("keydown", (event) => {
  const path = event.composedPath()
  if (!path.some((each) => each.matches?.("[role=dialog], [role=listbox]"))) {
    opener = path[0]
  } else if (isClosing(event, path[0])) {
    giveBack(20)
  }
}, {capture: true})
addEventListener("pointerdown", () => { opener = null }, {capture: true})
"""
"""Script that gives the focus back to where a key opened a dialog once a key closes it:
MUI would give it to the part of the page around that, which takes none."""


AT_ONCE = """
export function render({model, view}) {
  let isHeld = false
  const hold = (event) => { isHeld = event.type == "pointerdown" }
  for (const type of ["pointerdown", "pointerup", "pointercancel"]) {
    addEventListener(type, hold, {capture: true})
  }
  view.model.document.on_change((event) => {
    const isFinal = event.attr == "value_throttled"
    if (isFinal || (isHeld && event.attr == "value")) { model.send_msg("") }
  })
}
"""
"""Script that sends a message after each value that a pointer drags, and after each
final one. Of a key value and final value come together, and are one."""


class Browser(DataModel):
    """The window of the browser, and pressed keys.

    The window has a `height` in px and may be narrow. `acts` grows whenever a person
    presses a key or a button of the mouse. `pressed` is the last key that the page
    takes, and `count` grows with every such key. `search` is the address to which the
    browser went back or on, `copied` a link that it is to copy, `spoken` a text for
    screen readers, `destination` an address whose page it is to open. `given` is the
    number of values that the page gave to widgets, `shown` of those that the browser
    has shown. What is seen is stale while it is of a run before the present one. A
    browser is new until somebody has done something on a page.
    """

    height: int = Int(default=0)  # type: ignore[assignment]
    is_narrow: bool = Bool(default=False)  # type: ignore[assignment]
    acts: int = Int(default=0)  # type: ignore[assignment]
    pressed: str = String(default="")  # type: ignore[assignment]
    count: int = Int(default=0)  # type: ignore[assignment]
    search: str = String(default="")  # type: ignore[assignment]
    copied: str = String(default="")  # type: ignore[assignment]
    spoken: str = String(default="")  # type: ignore[assignment]
    is_new: bool = Bool(default=False)  # type: ignore[assignment]
    destination: str = String(default="")  # type: ignore[assignment]
    given: int = Int(default=0)  # type: ignore[assignment]
    shown: int = Int(default=0)  # type: ignore[assignment]
    is_stale: bool = Bool(default=False)  # type: ignore[assignment]

    def tell(self, **values: Any) -> None:
        """Set properties in the browser.

        What Panel hands on may come without the document's lock, as where a person
        types a value and presses a button at once.
        """
        with pn.io.unlocked():
            self.update(**values)

    def listen(
        self, state: PageState, document: Any, actions: Mapping[str, Callable[[], Any]]
    ) -> None:
        """Call the actions of pressed keys by name; store the window's size.

        Keys that an element takes for itself (`TAKEN`) call nothing.
        """
        for size in ("height", "is_narrow", "is_new"):
            self.on_change(
                size, lambda name, old, new: state.param.update(**{name: new})
            )
        self.on_change("count", lambda name, old, new: actions[self.pressed]())
        args = {"browser": self, "names": list(actions), "taken": TAKEN}
        self.js_on_change("copied", CustomJS(args=args, code=COPY))
        self.js_on_change("spoken", CustomJS(args=args, code=SPEAK))
        self.js_on_change("is_new", CustomJS(code=f"if (!cb_obj.is_new) {{ {MET} }}"))
        self.js_on_change("destination", CustomJS(args=args, code=GO))
        self.js_on_change("given", CustomJS(args=args, code=TELL))
        self.js_on_change("is_stale", CustomJS(args=args, code=FADE))
        self.on_change(
            "shown",
            lambda name, old, new: document.add_timeout_callback(
                partial(state.param.update, shown=new), BEHIND
            ),
        )
        self.given = state.given
        # The state first: what is told without the document's lock comes to the browser
        # alone, and no callback of this model hears of it.
        state.param.watch(
            lambda *events: self.tell(**{event.name: event.new for event in events}),
            ["given", "is_stale", "is_new"],
        )
        document.add_root(self)
        scripts = (KEEP_SHEETS, ACTS, LISTEN, TELL, HOLD, NETWORK, CHOOSE, RETURN)
        for script in scripts:
            document.js_on_event(DocumentReady, CustomJS(args=args, code=script))


class AtOnce(pn.custom.JSComponent):
    """Invisible component that makes a slider send its values at once.

    Panel gathers values for 50 ms, but what comes before a message of a component is
    handed on before it.
    """

    _esm = AT_ONCE


def fade_first(state: PageState, act: Callable[[], None]) -> None:
    """Fade the present content, and replace it in the next step of the event loop.

    Within one step the browser would hear of the fading at its end.
    """
    state.is_stale = state.frame is not None
    pn.state.execute(act, schedule=True)
