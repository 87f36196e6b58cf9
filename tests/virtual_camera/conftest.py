"""Devices with accounts, for tests over the network."""

from __future__ import annotations

import pytest

from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice

ACCOUNTS = [
    Account("root", "pass word", Role.ADMINISTRATOR),
    Account("guard", "secret-2", Role.OPERATOR),
    Account("visitor", "secret-3", Role.VIEWER),
]
"""An account of each role."""


@pytest.fixture
def served_device(analytic_scene: Scene) -> VirtualDevice:
    """A device with accounts, whose motors are a thousand times faster than real."""
    return VirtualDevice(analytic_scene, accounts=ACCOUNTS, width=320, height=180, time_scale=1000.0)
