"""A table of points that the user edits: two numbers a row, rows added and taken away."""

from __future__ import annotations

from typing import Any

import param
from panel.custom import JSComponent

STYLE = """
table { width: 100%; border-collapse: collapse; font-size: 14px; }
th { text-align: left; font-weight: 500; opacity: 0.75; }
input { width: 100%; box-sizing: border-box; font: inherit; padding: 3px 4px; color: inherit;
  background: transparent; border: 1px solid color-mix(in srgb, currentColor 30%, transparent);
  border-radius: 4px; }
input:invalid { border-color: #D55E00; }
button { font: inherit; width: 26px; cursor: pointer; color: inherit; background: transparent;
  border: 1px solid color-mix(in srgb, currentColor 30%, transparent); border-radius: 4px; }
div { max-height: 240px; overflow-y: auto; }
"""


class PointsTable(JSComponent):
    """Rows of two numbers.

    Attributes
    ----------
    columns
        Two headings.
    shown
        The rows that hold.
    wanted
        The rows as the user left them, whole numbers and all; sent after every edit, and emptied
        where other rows hold, which has the browser show those again.
    """

    columns = param.List(default=["", ""])
    shown = param.List(default=[])
    wanted = param.List(default=[])

    _esm = """
    export function render({model}) {
      const box = document.createElement("div")
      const table = document.createElement("table")
      box.append(table)
      const button = (text, title, action) => {
        const made = document.createElement("button")
        made.textContent = text
        made.title = title
        made.onclick = action
        return made
      }
      const cell = (row, child) => { const made = row.insertCell(); made.append(child) }
      const read = () => [...table.tBodies[0].rows].map((row) =>
        [...row.querySelectorAll("input")].map((input) => input.valueAsNumber))
      const send = (rows) => {
        if (rows.every((row) => row.every(Number.isFinite))) { model.wanted = rows }
      }
      const show = () => {
        table.replaceChildren()
        const head = table.createTHead().insertRow()
        for (const name of [...model.columns, "", ""]) {
          const title = document.createElement("th")
          title.textContent = name
          head.append(title)
        }
        const body = table.createTBody()
        model.shown.forEach((pair, place) => {
          const row = body.insertRow()
          for (const value of pair) {
            const input = document.createElement("input")
            input.type = "number"
            input.step = "any"
            input.required = true
            input.value = value
            input.onchange = () => send(read())
            cell(row, input)
          }
          cell(row, button("+", "Add a row below", () => {
            const rows = read()
            const [x, y] = rows[place]
            const next = rows[place + 1]
            const last = place > 0 ? x - rows[place - 1][0] : 1
            rows.splice(place + 1, 0, next ? [(x + next[0]) / 2, (y + next[1]) / 2] : [x + last, y])
            send(rows)
          }))
          cell(row, button("−", "Take this row away", () => {
            const rows = read()
            if (rows.length > 1) { rows.splice(place, 1); send(rows) }
          }))
        })
      }
      model.on("shown", show)
      model.on("wanted", () => { if (!model.wanted.length) { show() } })
      show()
      return box
    }
    """

    def __init__(self, **params: Any) -> None:
        super().__init__(stylesheets=[STYLE], **params)

    def show(self, rows: list[list[float]]) -> None:
        """Show the rows that hold, also in place of others that the user wanted."""
        self.shown = rows
        if self.wanted and self.wanted != rows:
            self.wanted = []
