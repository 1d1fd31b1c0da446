"""A test that hangs fails, and the next one begins."""

from __future__ import annotations

import asyncio
import time

import pytest
import web_pages


def test_what_waits_for_ever_fails_within_the_limit_of_a_test(pytestconfig: pytest.Config) -> None:
    limit = float(pytestconfig.getini("timeout"))
    assert 0.0 < web_pages.LONGEST < limit


@pytest.mark.timeout(0.1)
@pytest.mark.xfail(raises=pytest.fail.Exception, strict=True, reason="it is to be ended")
def test_a_test_has_a_limit() -> None:
    time.sleep(60.0)


def test_what_runs_apart_has_one_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_pages, "LONGEST", 0.1)
    with pytest.raises(TimeoutError):
        web_pages.run_apart(asyncio.sleep(60.0))
