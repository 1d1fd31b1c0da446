"""A test that hangs fails, and the next one begins."""

from __future__ import annotations

import time

import pytest


@pytest.mark.timeout(0.1)
@pytest.mark.xfail(raises=pytest.fail.Exception, strict=True, reason="it is to be ended")
def test_a_test_has_a_limit() -> None:
    time.sleep(60.0)
