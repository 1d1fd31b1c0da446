"""Pages as tests open them, and what is found there."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

from browser import Chrome, Server
from playwright.sync_api import ConsoleMessage, Error, Locator, Page, expect

ENDLESS = (
    "method=paper&max_iterations=100000&tolerance=1e-30&k_scale=0.1&pace=20 a second"
)
"""In an address: a run that goes on."""
ANSWER = "start=nested&finish=at-once&pace=fastest&instant=0.75"
"""In an address: a run whose answer is there at once, and after it searches, as those
of lessons and cases, with as few pictures as there can be, where a new page looks."""
PHONE = {"width": 390, "height": 844, "has_touch": True, "is_mobile": True}
"""Window of a page on a phone."""
IGNORED = re.compile(
    "GL Driver Message|Failed to repull session"
    "|WebSocket connection to .* failed|Failed to connect to Bokeh server: Could not "
    "open websocket|not connected so cannot send"
)
"""In the console: a hint on speed, and what is said of a network that is cut, and
was."""
POLL_MS = 100.0
"""Time between two looks at a page, ms. By default Playwright looks with each frame
that is painted, and what goes through all models then takes a core."""
FAULT = re.compile(
    "Traceback|ERROR|WARNING|Warning:"
    "|Uncaught exception|error handling message|threw an exception"
)
"""In the server's log."""
CLOSED = re.compile(
    r"^[^\n]*(Failed sending message as connection was closed\n"
    r"|Task exception was never retrieved\n.*?WebSocketClosedError(?!\()[^\n]*\n)",
    re.DOTALL | re.MULTILINE,
)
"""What is said of a message that was on its way to a page that closed, and of nothing
else."""
ALLOWED = re.compile("Dropping a patch|session-lifetime")
"""Lines of it that a page leaves which is closed in the midst of a picture."""
MODEL = """(name) => {
  for (const document of window.Bokeh ? Bokeh.documents : []) {
    const model = document.get_model_by_name(name)
    if (model) { return model }
  }
}"""
GO = """(query) => {
  history.pushState(null, "", query)
  dispatchEvent(new PopStateEvent("popstate"))
}"""
Visit = Callable[..., Page]


@contextmanager
def visits(
    server: Server, chrome: Chrome, complaints: list[str] | None = None
) -> Iterator[Visit]:
    """Open pages, and close them;
    neither they nor the server may complain meanwhile.

    What the pages say is added to the complaints that are given.
    """
    pages: list[Page] = []
    if complaints is None:
        complaints = []
    before = len(server.log)

    def hear(message: ConsoleMessage) -> None:
        if message.type in ("error", "warning") and not IGNORED.search(message.text):
            complaints.append(f"{message.text} {message.location['url']}")

    def stumble(error: Error) -> None:
        complaints.append(error.stack or str(error))

    def visit(
        query: str = "",
        width: int = 1280,
        height: int = 720,
        root: str = "",
        **device: Any,
    ) -> Page:
        page = chrome.new_page(width, height, **device)
        page.on("console", hear)
        page.on("pageerror", stumble)
        pages.append(page)
        page.goto((root or server.root) + "/app" + query)
        return page

    yield visit
    for page in pages:
        page.remove_listener("console", hear)
        page.remove_listener("pageerror", stumble)
        chrome.leave(page)
    assert not complaints, complaints
    said = server.log[before:]
    lines = CLOSED.sub("", said).splitlines()
    faults = [line for line in lines if FAULT.search(line)]
    strange = [line for line in faults if not ALLOWED.search(line)]
    assert not strange, f"{strange}, in:\n{said}"


class Desk:
    """A page that stays open: an opening takes as long as half a journey.

    Each journey goes to an address of its own first, and leaves no dialog, file, theme
    or class behind. A page on which a journey failed is closed, and the next has a new
    one.

    Attributes
    ----------
    worker
        Process of the page, as it was when the page was opened or loaded again.
    """

    def __init__(
        self,
        server: Server,
        chrome: Chrome,
        query: str = f"?{ANSWER}",
        root: str = "",
        **device: Any,
    ) -> None:
        self._server = server
        self._chrome = chrome
        self._query = query
        self._root = root
        self._device = device
        self._opened = ExitStack()
        self._page: Page | None = None
        self._complaints: list[str] = []

    def page(self) -> Page:
        """The page, which is opened if there is none."""
        if self._page is None:
            self._open(self._query)
            self.arrive()
        # What comes under a pointer that rests on a figure would be looked for there.
        self._page.mouse.move(0.0, 0.0)
        return self._page

    def anew(self, query: str = "") -> Page:
        """A page that has just been opened, in place of the one that is there."""
        self.close()
        return self._open(query)

    def _open(self, query: str) -> Page:
        self._complaints = []
        visit = self._opened.enter_context(
            visits(self._server, self._chrome, self._complaints)
        )
        self._page = visit(query, root=self._root, **self._device)
        return self._page

    def arrive(self) -> None:
        """Wait until the page is there that was opened or loaded again last.

        Where it goes before, nobody hears.
        """
        is_solved(self.page())
        # Of its processes the server has begun that of this page last.
        self.worker = self._server.processes()[-1]

    def check(self) -> None:
        """Close a page that has complained."""
        if self._complaints:
            self.close()

    def close(self) -> None:
        """Close the page; neither it nor the server may have complained."""
        self._page = None
        self._opened.close()


def go(page: Page, query: str) -> None:
    """Have an open page show the state of another address, as Back and Forward do.

    An opening takes seconds of a processor. What is there may be of the state before:
    wait for something that both do not share.
    """
    page.evaluate(GO, query)


def status(page: Page) -> Locator:
    """The status line."""
    return inside(page, ".status")


def figures(page: Page) -> Locator:
    """The key figures at the selected instant."""
    return inside(page, ".figures")


def inside(page: Page, selector: str) -> Locator:
    """The first block in the element of a selector.

    For one selector of both, Playwright climbs from each block of the page to the root:
    a look takes twice as long, and whoever waits looks again and again.
    """
    return page.locator(selector).locator("div").first


def iteration(page: Page) -> int:
    """The iteration that the status line names."""
    words = status(page).inner_text()
    match = re.search(r"(?:iteration|search:|answer:) (\d+)", words)
    assert match, words
    return int(match[1])


def is_solved(page: Page) -> None:
    """Wait until a run has ended with its answer."""
    expect(status(page)).to_contain_text("certified")


def holds(page: Page, expression: str, arg: Any = None) -> None:
    """Wait until an expression of `model`, which finds models by name, holds."""
    comes(page, f"(arg) => {{ const model = {MODEL}; return ({expression}) }}", arg)


def comes(page: Page, script: str, arg: Any = None) -> None:
    """Wait until a function in the browser returns what counts as true."""
    page.wait_for_function(script, arg=arg, polling=POLL_MS)


def painted(page: Page, more: int = 1) -> None:
    """Wait until a number of further pictures are on the screen."""
    now = page.evaluate(f"({MODEL})('pulse').painted")
    holds(page, "model('pulse').painted >= arg", now + more)


def slider(page: Page, name: str) -> Locator:
    """The slider of a setting, by the beginning of its title."""
    return page.get_by_role("slider", name=re.compile(rf"^{re.escape(name)}"))


def field(page: Page, name: str) -> Locator:
    """The field of a setting, by the beginning of its title."""
    return page.get_by_role("textbox", name=re.compile(rf"^{re.escape(name)}"))


def enter(page: Page, name: str, text: str, over: str) -> None:
    """Type a value into a field, once it shows the one that it is to replace.

    A figure may be there before a field has its new value, which then would be written
    over what was selected.
    """
    typed = field(page, name)
    expect(typed).to_have_value(over)
    typed.fill(text)
    typed.press("Enter")


def button(page: Page, name: str) -> Locator:
    """The button in sight that a name begins with."""
    pattern = re.compile(rf"^{re.escape(name)}")
    return page.get_by_role("button", name=pattern).locator("visible=true").first


def figure(page: Page, number: int) -> Locator:
    """A figure of the page: 0 is the scene, 1 the time line, then those of cards."""
    return page.locator(".bk-Figure").nth(number)


def drag(
    page: Page, place: Locator, start: float, end: float, height: float = 0.5
) -> None:
    """Press on a place, at a share of its width, and drag to another."""
    box = place.bounding_box()
    assert box is not None
    y = box["y"] + height * box["height"]
    page.mouse.move(box["x"] + start * box["width"], y)
    page.mouse.down()
    page.mouse.move(box["x"] + end * box["width"], y, steps=6)


def close_controls(page: Page) -> None:
    """Close the controls of a phone; the picture is back where it was without them.

    The server hears of it after the browser: until then the picture stands above what
    is no longer there.
    """
    button(page, "Close drawer").click()
    expect(page.locator(".with-sheet")).to_have_count(0)


def close_dialog(page: Page) -> None:
    """Close what has opened over the page."""
    # Where its content is new, the focus is on the page until MUI looks after it, some
    # 50 ms later.
    expect(page.locator(".MuiDialog-root:focus-within")).not_to_have_count(0)
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog").locator("visible=true")).to_have_count(0)
