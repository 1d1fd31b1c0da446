"""The settings as one small browser component: a widget each on the server cost it 0.2 s a page.

What the user does comes as messages, each with its number; what holds goes back with the number of
the newest message that was obeyed. A control that the user has moved since does not jump back.
"""

from __future__ import annotations

import json
import math
from typing import Any, ClassVar

import param

from app.components.innards import Plain
from app.components.panes import script
from app.picture.units import KNOWN, SYSTEMS, steps
from solver.definitions import CurveParameter, Parameter, about

POINTS, USUAL = "table of points", "usual value"
"""What stands for values that the browser does not know."""
ENDS = "the-ends"
"""Among what is shown, the largest value that other settings leave to a slider, by its name."""
NAMED = "the-named"
"""Among what is shown, the names of controls that words on the page speak of: their sheets open."""
UNITS = "the-units"
"""Among what is shown, which of `SYSTEMS` values are shown and typed in."""
LADDERS = {
    unit: {units: [list(one) for one in steps(unit, units)] for units in SYSTEMS} for unit in KNOWN
}
"""The units that values of an SI unit are read in, of every system, the smallest first."""
LADDERS_SCRIPT = (
    f"const LADDERS = {json.dumps(LADDERS, ensure_ascii=False, separators=(',', ':'))}\n"
)
"""For `controls.js`."""
MOST_LISTED = 200
"""Points that a table on the page has; of more there is a drawing."""
STYLE = """
:host { font-size: 14px; line-height: 1.4; }
h4 { margin: 14px 0 2px; font-size: 12px; font-weight: 400; letter-spacing: 0.08em;
  text-transform: uppercase; }
div[title] { margin: 6px 0; }
label { display: block; }
.scenes { display: grid; grid-template-columns: repeat(auto-fit, minmax(40px, 1fr)); gap: 1px; }
.scenes label { position: relative; padding: 2px 1px 1px; text-align: center; font-size: 11px;
  text-transform: capitalize; border: 1px solid transparent; border-radius: 6px; }
.scenes label:hover { background: color-mix(in srgb, currentColor 8%, transparent); }
.scenes label:has(:checked) { border-color: var(--accent); font-weight: 600;
  background: color-mix(in srgb, var(--accent) 14%, transparent); }
.scenes label:has(:focus-visible) { outline: 2px solid var(--accent); outline-offset: 1px; }
.scenes input { position: absolute; inset: 0; margin: 0; opacity: 0; cursor: pointer; }
.scenes svg { display: block; width: 100%; max-width: 48px; height: 32px; margin: auto; fill: none;
  stroke: currentColor; stroke-width: 1.6; stroke-linejoin: round; stroke-linecap: round; }
.scenes .body { fill: color-mix(in srgb, var(--accent) 40%, transparent); }
.scenes .ground { opacity: 0.65; }
.scenes .load { stroke: #D55E00; }
.typed { display: flex; align-items: baseline; justify-content: space-between; gap: 8px; }
.sheet { margin-top: 8px;
  border-top: 1px solid color-mix(in srgb, currentColor 20%, transparent); }
summary { cursor: pointer; }
.sheet summary { padding: 6px 0 4px; font-weight: 500; }
summary small { display: block; padding-left: 18px; overflow: hidden; font-weight: 400;
  text-overflow: ellipsis; white-space: nowrap; opacity: 0.75; }
input[type=range] { display: block; width: 100%; margin: 4px 0 8px; cursor: pointer; }
input { accent-color: var(--accent); }
select { display: block; width: 100%; margin-top: 2px; }
select, td input, .number, button { box-sizing: border-box; font: inherit; color: inherit;
  background: transparent; border-radius: 4px;
  border: 1px solid color-mix(in srgb, currentColor 30%, transparent); }
select { padding: 6px 4px; }
.number { width: 84px; padding: 1px 4px; font-weight: 600; text-align: right; }
option, optgroup { color: #222; background: #fff; }
table { width: 100%; border-collapse: collapse; }
thead td { opacity: 0.75; }
td input { width: 100%; padding: 3px 4px; }
td input:invalid { border-color: #D55E00; }
button { width: 26px; cursor: pointer; }
button.wide { width: auto; padding: 4px 12px; margin: 4px 6px 8px 0; }
.typed[hidden] { display: none; }
.typed b { overflow: hidden; text-overflow: ellipsis; }
input[type=file] { display: block; width: 100%; margin-top: 4px; font: inherit; }
svg.path { display: block; width: 100%; touch-action: none; cursor: crosshair; }
svg.path circle { cursor: grab; }
.points { max-height: 240px; overflow-y: auto; }
"""


class Form(Plain):
    """Controls below each other, some in sheets that open, under the headings of their groups.

    Messages from the browser are `{name, value, hand, count}`: `hand` tells that more of the same
    drag may come, and a value of None that it has ended.

    Attributes
    ----------
    items
        What each control is, as `item_of` says it, with the titles of its sheet and its group.
    shown
        The value of each control that applies, by name; "" has the number of the newest message
        that was obeyed.
    """

    items = param.List(default=[])
    shown = param.Dict(default={})

    _esm = LADDERS_SCRIPT + script(
        *("say.js", "elements.js", "values.js", "points.js", "controls.js", "decoded.js"),
        "form.js",
    )
    _stylesheets: ClassVar[list[str]] = [STYLE]


def shown_value(value: Any) -> Any:
    """Give a setting's value as its control shows it: of a long table the ups and downs."""
    if not isinstance(value, tuple) or len(value) <= MOST_LISTED:
        return value
    size = math.ceil(2 * len(value) / MOST_LISTED)
    parts = [value[at : at + size] for at in range(0, len(value), size)]
    ends = [
        {min(part, key=lambda pair: pair[1]), max(part, key=lambda pair: pair[1])} for part in parts
    ]
    drawn = [value[0], *(pair for part in ends for pair in sorted(part)), value[-1]]
    return {"count": len(value), "drawn": drawn}


def item_of(name: str, definition: Parameter) -> dict[str, Any] | None:
    """Say what the control of a setting is; None where there is nothing to choose."""
    record = about(definition)
    item = {"name": name, "label": record.title, "help": definition.doc}
    if isinstance(definition, CurveParameter):
        titles = definition.abscissa, definition.ordinate
        columns = [list(one) for one in zip(titles, definition.units, strict=True)]
        options = [[value, value] for value in (*definition.presets, POINTS)]
        return {**item, "kind": "curve", "options": options, "columns": columns}
    if isinstance(definition, param.Boolean):
        return {**item, "kind": "flip"}
    if isinstance(definition, param.Selector):
        options = [[value, value] for value in definition.objects]
        return {**item, "kind": "choice", "options": options} if len(options) > 1 else None
    low, high = definition.softbounds
    return {
        **item,
        "kind": "slider",
        "start": low,
        "end": high,
        "step": 10.0 ** math.floor(math.log10((high - low) / 80)),
        "log": record.logarithmic,
        "whole": isinstance(definition, param.Integer),
        "usual": USUAL,
        "unit": record.unit,
    }
