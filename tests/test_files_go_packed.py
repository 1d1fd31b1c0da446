"""What a page loads goes packed to a browser, a file packed once."""

from __future__ import annotations

import gzip
import urllib.request
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import pytest
from browser import Server
from tornado.httputil import HTTPHeaders

from app.server.packed import Packed

TEXT = b"function of x and t" * 5000
FILE = {"Accept-Ranges": "bytes"}


def sent(parts: list[bytes], said: Mapping[str, str], takes: str = "gzip") -> tuple[str, bytes]:
    """Give how an answer is coded, and all that is sent of it."""
    headers = HTTPHeaders({"Content-Type": "text/javascript", "Etag": '"one"', **said})
    asked: Any = SimpleNamespace(headers={"Accept-Encoding": takes})
    answer = Packed(asked)
    _, headers, first = answer.transform_first_chunk(200, headers, parts[0], finishing=False)
    rest = [answer.transform_chunk(part, i == len(parts) - 2) for i, part in enumerate(parts[1:])]
    whole = first + b"".join(rest)
    assert int(headers.get("Content-Length", len(whole))) == len(whole)
    return headers.get("Content-Encoding", ""), whole


def test_a_file_is_packed_once_and_a_page_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    kept: dict[str, bytes] = {}
    monkeypatch.setattr(Packed, "kept", kept)
    parts = [TEXT[:40000], TEXT[40000:], b""]
    for said in ({}, FILE):
        assert not kept
        coding, whole = sent(parts, said)
        assert coding == "gzip"
        assert gzip.decompress(whole) == TEXT
    assert kept == {'"one"': whole}
    monkeypatch.setattr(Packed, "GZIP_LEVEL", "not asked for again")
    with pytest.raises(TypeError):
        sent(parts, {})
    assert sent([b"only its name counts", b"", b""], FILE) == ("gzip", whole)
    assert sent(parts, FILE, takes="identity") == ("", TEXT)


def test_a_server_packs_what_a_page_loads(server: Server) -> None:
    def load(path: str, takes: str) -> tuple[str | None, bytes]:
        asked = urllib.request.Request(
            f"http://localhost:{server.port}{path}", headers={"Accept-Encoding": takes}
        )
        with urllib.request.urlopen(asked) as answer:
            return answer.headers["Content-Encoding"], answer.read()

    # It is a page that has the others packed.
    load("/app", "gzip")
    coding, plain = load("/static/js/bokeh.min.js", "identity")
    assert coding is None
    for _ in range(2):
        coding, packed = load("/static/js/bokeh.min.js", "gzip")
        assert (coding, gzip.decompress(packed)) == ("gzip", plain)
        assert len(packed) < 0.4 * len(plain)
