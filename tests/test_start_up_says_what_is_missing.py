"""A start that cannot be says why in a line: a port in use, a browser that is not there."""

from __future__ import annotations

import socket
import subprocess
import sys
from pathlib import Path

from browser import ROOT


def test_a_port_in_use_is_named_in_a_line() -> None:
    panel = str(Path(sys.executable).with_name("panel"))
    with socket.socket() as taken:
        taken.bind(("", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        found = subprocess.run(
            [panel, "serve", "app", "--port", port],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )
    assert found.returncode != 0
    assert f"port {port} is already in use" in found.stderr.splitlines()[-1]
    assert "Traceback" not in found.stderr
