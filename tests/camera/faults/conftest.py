"""Every test of this folder runs for both drivers; those of the ONVIF driver are in the full tier."""

from __future__ import annotations

import pytest

from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.faults.drivers import AXIS, ONVIF, Driver, make_device


@pytest.fixture(params=[pytest.param(AXIS, id="axis"), pytest.param(ONVIF, id="onvif", marks=pytest.mark.full)])
def driver(request: pytest.FixtureRequest) -> Driver:
    found: Driver = request.param
    return found


@pytest.fixture
def device(analytic_scene: Scene) -> VirtualDevice:
    return make_device(analytic_scene)
