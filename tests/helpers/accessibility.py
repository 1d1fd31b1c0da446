"""Violations that axe-core finds of rules on what everybody can use."""

from __future__ import annotations

from typing import Any

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

OF_THE_WIDGETS = ("aria-prohibited-attr", "aria-progressbar-name", "button-name")
"""What panel-material-ui's own descriptions, bars and number fields break."""


RULES = {
    "type": "tag",
    "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"],
}
"""Rules of WCAG of level A and AA, and of good practice."""
COLOURS = {"type": "rule", "values": ["color-contrast", "link-in-text-block"]}
"""Those of them that ask for colours, which are all that differs between themes."""
LOOKS = 3
PAUSE = 1000
"""Number of looks at a page, ms apart: each widget takes the colours of a theme by
itself, on a busy machine a second after the others, and fades to them. What stays is a
fault."""


def violations(page: Page, rules: dict[str, Any]) -> list[str]:
    """Violations of some rules."""
    options = {
        # What passes would come with all its elements, half a megabyte.
        "resultTypes": ["violations"],
        "runOnly": rules,
    }
    response = Axe().run(page, options=options).response
    found = []
    for rule in response["violations"]:
        if rule["id"] not in OF_THE_WIDGETS:
            found += [f"{rule['id']}: {node['html'][:160]}" for node in rule["nodes"]]
    return found


def all_can_use(page: Page, rules: dict[str, Any] = RULES) -> None:
    """Check that axe finds nothing on a page as it stands."""
    # No tooltip is on its way.
    page.mouse.move(640.0, 5.0)
    expect(page.get_by_role("tooltip")).to_have_count(0)
    found = violations(page, rules)
    for _ in range(LOOKS - 1):
        if found:
            page.wait_for_timeout(PAUSE)
            found = violations(page, rules)
    assert not found, "\n".join(found)
