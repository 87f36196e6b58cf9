"""A fake device for the tests of the AXIS driver."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.camera.axis.fake_vapix import FakeVapix


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeVapix]:
    monkeypatch.setattr("scope_ptz.camera.network.lens.UNREPORTED_FOCUS_WAIT_S", 0.05)  # it reports no focus position
    device = FakeVapix()
    with device.loopback:
        yield device
