"""The thread between browser and server: painted frames, keys, and the clipboard."""

from __future__ import annotations

import panel as pn
import param
from panel.custom import JSComponent


class Pulse(JSComponent):
    """An invisible component that acknowledges frames when they are painted and hears keys."""

    # Panel gathers changes from the browser for 50 ms, which every painted frame would wait for.
    _debounce = 0

    frame = param.Integer(default=0, doc="Number of the newest frame sent.")
    painted = param.Integer(default=0, doc="Number of the newest frame painted.")
    hears = param.Boolean(default=True, doc="Whether keys move the run.")
    key = param.String(default="", doc="The last key pressed, with a count to tell repeats apart.")
    narrow = param.Boolean(default=False, doc="Whether the window has no room for a sidebar.")
    hidden = param.Boolean(default=False, doc="Whether the browser shows another page instead.")
    phone = param.Boolean(default=False, doc="Whether the header has no room for the tabs.")
    copy = param.String(default="", doc="A query to put into the address bar and the clipboard.")

    _esm = """
    export function render({model}) {
      let count = 0
      if (window.innerWidth < 640) { model.phone = true }
      if (window.innerWidth < 900) { model.narrow = true }
      model.on("frame", () => {
        const frame = model.frame
        requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(() => {
          model.painted = frame
        })))
      })
      model.on("copy", () => {
        const url = location.origin + location.pathname + model.copy.split("#")[0]
        history.replaceState(null, "", url)
        if (navigator.clipboard) { navigator.clipboard.writeText(url).catch(() => {}) }
      })
      const look = () => { model.hidden = document.visibilityState === "hidden" }
      document.addEventListener("visibilitychange", look)
      look()
      const press = (event) => {
        const typed = event.composedPath()[0]
        const writes = typed.tagName === "INPUT" && typed.type !== "range" ||
          typed.tagName === "TEXTAREA" || typed.isContentEditable
        if (writes || event.ctrlKey || event.metaKey || event.altKey) { return }
        if (!model.hears || event.repeat || ![" ", "s", "r"].includes(event.key)) { return }
        // In an open list letters choose; the space bar presses what has the focus.
        const lists = "[role=option], [role=menuitem], [role=listbox], [role=menu]"
        const presses = ", button, [role=combobox], [role=switch]"
        const keeps = event.key === " " ? lists + presses : lists
        if (typed.closest && typed.closest(keeps)) { return }
        event.preventDefault()
        count += 1
        model.key = event.key + count
      }
      document.addEventListener("keydown", press)
      model.on("remove", () => {
        document.removeEventListener("keydown", press)
        document.removeEventListener("visibilitychange", look)
      })
      return document.createElement("span")
    }
    """


def send_without_delay() -> None:
    """Let the present session's sockets send small messages at once.

    A message of Bokeh's protocol is three small writes or more. By default (Nagle's algorithm) the
    second waits until the browser acknowledges the first, and browsers put that off for 40 ms.
    """
    context = pn.state.curdoc.session_context if pn.state.curdoc else None
    for connection in context.session._subscribed_connections if context is not None else ():
        connection._socket.set_nodelay(True)
