"""A start that cannot be says why in a line: a port in use, a browser that is not there."""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from browser import NO_BROWSER, ROOT, chromium


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


@pytest.mark.parametrize(
    ("promised", "outcome"), [("", pytest.skip.Exception), ("true", pytest.fail.Exception)]
)
def test_a_browser_that_is_missing_skips_a_test_and_where_one_is_promised_fails_it(
    promised: str, outcome: type[BaseException], monkeypatch: pytest.MonkeyPatch
) -> None:
    def nowhere(name: str, **options: Any) -> None:
        return None

    monkeypatch.setattr(shutil, "which", nowhere)
    monkeypatch.setenv("CI", promised)
    with pytest.raises(outcome, match="apt-get install chromium"):
        chromium()


def test_the_last_line_says_how_many_tests_were_skipped_for_want_of_a_browser(
    tmp_path: Path,
) -> None:
    tests = tmp_path / "test_page.py"
    tests.write_text(
        "def test_page(chrome): pass\ndef test_other(chrome): pass\ndef test_none(): pass\n",
        encoding="utf-8",
    )
    surroundings = {**os.environ, "PATH": "", "CI": "", "PYTHONPATH": f"{ROOT}:{ROOT / 'tests'}"}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "conftest", f"--rootdir={tmp_path}"]
    done = subprocess.run(
        [*command, str(tests)], cwd=tmp_path, env=surroundings, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.splitlines()[-1] == f"2 tests skipped: {NO_BROWSER}"


def test_the_readme_tries_to_install_a_browser_and_tests_without_one_too(tmp_path: Path) -> None:
    """Without apt, and where it may not, the line before the tests ends well."""
    (line,) = re.findall(r"^command -v chromium .*$", (ROOT / "README.md").read_text("utf-8"), re.M)
    shell = shutil.which("sh")
    assert shell is not None
    for refusal in (None, "echo denied; exit 100", "echo installed"):
        apt = tmp_path / "apt-get"
        if refusal is not None:
            apt.write_text(f"#!{shell}\n{refusal} $1\n", encoding="utf-8")
            apt.chmod(0o755)
        done = subprocess.run(
            [shell, "-ec", line], env={"PATH": str(tmp_path)}, capture_output=True, text=True
        )
        assert done.returncode == 0
        assert ("installed install" in done.stdout) == (refusal == "echo installed")
