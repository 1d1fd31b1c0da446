"""The command `slipfront serve`: serves the page without a clone of the repository."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

APP = Path(__file__).resolve().parent


def add_serve(commands: Any) -> None:
    """Add the command; the engine finds this function by an entry point."""
    serve = commands.add_parser(
        "serve",
        help="serve the page, at /app; options are those of `panel serve`",
        add_help=False,
    )
    serve.set_defaults(command=_serve, passed_on=())


def _serve(chosen: argparse.Namespace) -> int:
    # Here and not above: other commands do without the second that it takes.
    from panel.command import main

    # A page that is older than Bokeh's five minutes may come back after its network was
    # gone.
    patient = [
        "--session-token-expiration",
        "86400",
        "--unused-session-lifetime",
        "120000",
    ]
    sys.argv = ["panel", "serve", str(APP), *patient, *chosen.passed_on]
    main()
    return 0
