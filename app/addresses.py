"""The address by which other machines reach this page."""

from __future__ import annotations

import os
import socket
from contextlib import suppress
from functools import cache
from urllib.parse import urlsplit

import panel as pn

DOCUMENTATION = "192.0.2.1"
"""An address that is nobody's (RFC 5737)."""


def address_for_others() -> str:
    """Address of this page without its query, as other machines reach it; "" if they cannot."""
    href = pn.state.location.href if pn.state.location is not None else ""
    here = urlsplit(href or "")
    if not is_local(here.hostname or ""):
        return here._replace(query="", fragment="").geturl()
    port = f":{here.port}" if here.port else ""
    allowed = os.environ.get("BOKEH_ALLOW_WS_ORIGIN", "").split(",")
    names = [f"{name}{port}" for name in names_of_machine()]
    reached = next((name for name in names if "*" in allowed or name in allowed), "")
    return here._replace(netloc=reached, query="", fragment="").geturl() if reached else ""


def how_to_open() -> str:
    """What whoever serves a page as localhost has to do that others reach it (HTML)."""
    href = pn.state.location.href if pn.state.location is not None else ""
    name, port = names_of_machine()[0], urlsplit(href or "").port or 80
    return (
        "Others cannot open <b>localhost</b>, which is each machine's own name. For a class start "
        f"the server with <code>BOKEH_ALLOW_WS_ORIGIN={name}:{port}</code>, and open "
        f"<b>http://{name}:{port}/app</b>."
    )


def is_local(host: str) -> bool:
    """Whether a name is what every machine calls itself."""
    return host in ("", "localhost", "::1") or host.startswith("127.")


@cache
def names_of_machine() -> tuple[str, ...]:
    """What others call this machine: its name, and its address in the network."""
    names = [socket.gethostname()]
    with suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        # Nothing is sent: it only chooses the way that a packet would take.
        probe.connect((DOCUMENTATION, 9))
        names.append(probe.getsockname()[0])
    return tuple(name for name in names if not is_local(name)) or ("THIS-MACHINE",)
