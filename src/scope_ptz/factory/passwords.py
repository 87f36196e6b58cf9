"""The credentials of network cameras. They never come from a command line."""

from __future__ import annotations

from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.spec import CameraSpec
from scope_ptz.errors import ConfigError, InputError
from scope_ptz.settings import load_settings


def find_credentials(spec: CameraSpec) -> Credentials:
    """Return the account for a camera: the user of its spec, and the password from ``SCOPE_CAMERA_PASSWORD``.

    Args:
        spec: A spec such as ``axis://operator@10.0.0.7``.

    Raises:
        InputError: The spec names no user.
        ConfigError: There is no password.
    """
    user, at, _ = spec.address.rpartition("@")
    if not at or not user:
        raise InputError(f"Name the account in the camera: {spec.scheme}://USER@{spec.address[:80]}")
    password = load_settings().camera_password
    if password is None or not password.get_secret_value():
        raise ConfigError(f"There is no password for {spec.address[:80]}. Set the environment variable SCOPE_CAMERA_PASSWORD.")
    return Credentials(user, password.get_secret_value())
