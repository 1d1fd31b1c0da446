"""A run as one page that needs nothing beside it: its plots at all instants, and its numbers."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Iterable, Mapping
from html import escape
from pathlib import Path

from app.languages.language import Language
from app.views.drawing.drawing import View
from app.views.scene import Scene
from app.worker.painter import Painter, caption, seen
from app.worker.tables import TABLES, table
from solver.checked import dump

OFFLINE = "page"
"""What it is asked for as, beside tables."""
MOST_INSTANTS = 60
"""That a page has pictures of."""
APP = Path(__file__).resolve().parents[1]
STYLE = APP.parent / "static" / "style.css"
PROGRAMS = APP / "components" / "unpacked.js", APP / "worker" / "offline.js"
PAGE = """<!DOCTYPE html>
<html lang="{lang}">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Slipfront: {name}</title>
<style>
{style}
body {{ font: 15px/1.5 Roboto, system-ui, sans-serif; max-width: 90rem; margin: 1rem auto;
  padding: 0 1rem; color: #222; background: #fff; }}
.plots {{ display: grid; gap: 0.5rem;
  grid-template-columns: repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); }}
.card {{ padding: 0.5rem; border: 1px solid #8884; border-radius: 6px; }}
.wide {{ grid-column: 1 / -1; }}
.plot {{ height: 300px; display: grid; }}
.time {{ position: sticky; top: 0; z-index: 1; display: flex; gap: 1rem; padding: 0.5rem 0;
  background: #fff; }}
.time input {{ flex: 1; }}
th, td {{ padding: 0.1rem 0.6rem; text-align: left; }}
pre {{ overflow-x: auto; }}
abbr {{ text-decoration: none; }}
.thing span {{ margin-right: 2rem; }}
.asks {{ display: block; font-size: 0; }}
.detail {{ font-size: 13px; }}
</style>
{library}
<h1>{name}</h1>
<p id="status"></p>
<label class="time">{instant} <input type="range" min="0" max="{last}" value="{at}" step="1">
<span id="caption"></span></label>
<div class="plots">{cards}</div>
<div id="figures"></div>
<p>{numbers} {tables}.</p>
<details><summary>{all_settings}</summary><pre>{settings}</pre></details>
{figures}
<script type="module">
const run = {run}
{program}
</script>
</html>
"""


def offline_page(
    scenes: Iterable[tuple[Scene, Mapping[str, str]]], looked_at: Scene, at: int
) -> str:
    """Write the page (HTML).

    Parameters
    ----------
    scenes
        At one instant after the other, with the words that stand beside each (HTML).
    looked_at
        What the page begins with, and tables are of.
    at
        Its place among the scenes.
    """
    # Only whoever takes a run away needs this, which takes longer than to begin.
    from bokeh.embed import components
    from bokeh.resources import Resources

    from app.views.drawing.figures import make_figure

    settings, look, say = looked_at.run.settings, looked_at.look, looked_at.look.say
    views = seen(settings, look)
    figures = [make_figure(view, say) for view in views]
    for figure in figures:
        # What stands above a plot is a part of this page.
        figure.tags = [one for one in figure.tags if not one.name.endswith(".title")]
    script, places = components(figures, wrap_script=True)
    painter, pictures, words = Painter(), [], []
    for scene, said in scenes:
        pictures.append(b64encode(painter.plots(scene)).decode())
        words.append({**said, "caption": escape(say(caption(scene)))})
    library = Resources(mode="inline", components=["bokeh"]).js_raw
    run = json.dumps({"pictures": pictures, "words": words})
    return PAGE.format(
        **_said(say),
        name=escape(say(settings.scene)),
        style=STYLE.read_text(encoding="utf-8"),
        library="\n".join(f"<script>{text}</script>" for text in library),
        last=len(pictures) - 1,
        at=at,
        cards="\n".join(_card(view, place) for view, place in zip(views, places, strict=True)),
        tables=", ".join(_link(what, looked_at) for what in TABLES),
        settings=escape(dump(settings)),
        figures=script,
        # Nothing within may end the script.
        run=run.replace("</", "<\\/"),
        program="\n".join(file.read_text(encoding="utf-8") for file in PROGRAMS),
    )


def _said(say: Language) -> dict[str, str]:
    """Give the words of the page in a language, which is one of them."""
    texts = {"instant": "Instant", "numbers": "Numbers, as CSV:", "all_settings": "All settings"}
    return {"lang": say.name, **{name: say(text) for name, text in texts.items()}}


def _card(view: View, place: str) -> str:
    wide = " wide" if view.plot.equal else ""
    title = f'<div class="title" id="{view.slug}.title"></div>'
    return f'<div class="card{wide}">{title}<div class="plot">{place}</div></div>'


def _link(what: str, scene: Scene) -> str:
    """Write a link to a table that the page has in it."""
    text = b64encode(table(what, scene).encode()).decode()
    name = f"slipfront-{scene.run.settings.scene}-{what}.csv"
    return f'<a download="{name}" href="data:text/csv;base64,{text}">{scene.look.say(what)}</a>'
