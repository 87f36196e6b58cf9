"""Network cameras from specs such as ``axis://operator@10.0.0.7``: credentials, the driver, and the control lock."""

from __future__ import annotations

from scope_ptz.camera.base import Camera
from scope_ptz.camera.spec import CameraSpec
from scope_ptz.errors import InputError

NETWORK_SCHEMES: tuple[str, ...] = ()
"""The schemes of drivers for network cameras."""


async def open_network_camera(spec: CameraSpec) -> Camera:
    """Connect to a network camera.

    Raises:
        InputError: The spec or an option is wrong, or there is no password for the account.
        CameraError: The camera cannot be reached, or does not accept the account.
    """
    raise InputError(f"There is no driver for '{spec.scheme}' cameras.")
