"""Small cameras without accounts, for tests that are not about passwords."""

from __future__ import annotations

import pytest

from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice


@pytest.fixture
def open_device(analytic_scene: Scene) -> VirtualDevice:
    """A camera without accounts in a scene that stands still, with motors a thousand times faster than real."""
    clock = SceneClock(analytic_scene.file.start_s)
    return VirtualDevice(analytic_scene, clock=clock, width=320, height=180, time_scale=1000.0)
