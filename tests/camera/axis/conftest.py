"""A fake device for the tests of the AXIS driver."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.camera.axis.fake_vapix import FakeVapix


@pytest.fixture
def fake() -> Iterator[FakeVapix]:
    device = FakeVapix()
    with device.loopback:
        yield device
