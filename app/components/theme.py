"""Light or dark: as a link or the system has it; the browser remembers what one chooses."""

from __future__ import annotations

from functools import cache

from app.languages.language import SOURCE, Language

TEMPLATE = """
{% extends "base.html" %}
{% block preamble %}
{{ super() }}
<script>
  // Panel has modules read by a library; a browser that can do it by itself is quicker (0.25 s).
  self.esmsInitOptions = {shimMode: false}
  document.addEventListener("DOMContentLoaded", () => {
    importShim.addImportMap = () => {}
    // It says again what fonts there are, but not of which letters each has the shapes: browsers
    // would load all of them, one after the other, and lay out the page anew for each.
    document.querySelector("link[href*='material-icons.css']")?.remove()
  });
  (() => {
    const root = document.documentElement, dark = matchMedia("(prefers-color-scheme: dark)")
    const kept = () => { try { return localStorage.getItem("theme") } catch { return null } }
    const show = (theme) => { root.dataset.theme = root.style.colorScheme = theme }
    const follow = () => show(kept() ?? (dark.matches ? "dark" : "light"))
    const linked = new URLSearchParams(location.search).get("theme")
    if (["dark", "light"].includes(linked)) { show(linked) } else { follow() }
    dark.addEventListener("change", follow)
    document.addEventListener("click", (event) => {
      if (!event.composedPath().some((one) => one.ariaLabel === "Toggle theme")) { return }
      const chosen = root.dataset.theme === "dark" ? "light" : "dark"
      try { localStorage.setItem("theme", chosen) } catch {}
      show(chosen)
    }, {capture: true})
    // What is built light is covered until it is dark.
    const uncover = () => {
      const [page] = document.querySelectorAll(".bk-panel-models-esm-ReactComponent")
      const built = page?.shadowRoot?.querySelector(`.mui-${root.dataset.theme} .main`)
      if (built) {
        root.dataset.built = ""
        // The name beside it is the same link: once is enough for keys, and for who hears the page.
        const logo = page.shadowRoot.querySelector("img.logo")
        logo?.setAttribute("alt", "")
        const link = logo?.closest("a")
        if (link) { link.tabIndex = -1; link.ariaHidden = "true" }
      } else { requestAnimationFrame(uncover) }
    }
    uncover()
  })()
</script>
<style>
  /* Beside an accent that is too dark for it, browsers paint the track of a slider white. */
  html { --accent: #1976d2 }
  html[data-theme=dark] { --accent: #90caf9 }
  html[data-theme=dark] body { background: #121212; color: #fff }
  html[data-theme=dark]:not([data-built])::after { content: ""; position: fixed; inset: 0;
    z-index: 9998; background: #121212 }
</style>
{% endblock %}
"""
"""The page's document, whose head decides before anything is painted."""


@cache
def template_in(say: Language) -> str:
    """Give the document with the words of a language, for the programs in it."""
    if say.name == SOURCE:
        return TEMPLATE
    words = f"self.slipfrontWords = {say.in_browser}; document.documentElement.lang = '{say.name}'"
    script = f"<script>{{% raw %}}{words}{{% endraw %}}</script>"
    return TEMPLATE.replace("<script>", f"{script}\n<script>", 1)
