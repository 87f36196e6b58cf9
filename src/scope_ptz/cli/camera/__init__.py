"""The ``scope camera`` commands, which are loaded when one of them is used or listed."""

from __future__ import annotations

from scope_ptz.cli.lazy_group import LazyGroup

HELP = """Real cameras on the network, and virtual ones for tests.

Start with `scope camera discover` to find cameras, or `scope camera serve` for a virtual one.
"""


class CameraGroup(LazyGroup):
    """The group of camera commands."""

    module = "scope_ptz.cli.camera.app"
    attribute = "camera_app"
