"""Find and store the credentials of network cameras. Passwords are never read from the command line."""

from __future__ import annotations

import getpass
import sys
from types import ModuleType

from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.spec import CameraSpec
from scope_ptz.errors import ConfigError, InputError
from scope_ptz.settings import load_settings, read_secret

KEYRING_SERVICE = "scope-ptz"
"""The service name for passwords in the operating system's keyring. The user name of an entry is ``USER@HOST``."""


def find_credentials(spec: CameraSpec) -> Credentials:
    """Return a camera's credentials: the user name from its spec, and the password from the configured source.

    The camera's entry in ``scope.yaml`` may specify the source. Otherwise, these sources are tried in order: the environment
    variable SCOPE_CAMERA_PASSWORD, the keyring, and a prompt if the program is running in a terminal.

    Args:
        spec: A spec such as ``axis://operator@10.0.0.7``.

    Raises:
        InputError: The spec contains no user name.
        ConfigError: There is no password.
    """
    account = camera_account(spec)
    password = _password(account, _password_source(spec))
    if not password:
        raise ConfigError(
            f"There is no password for {account[:80]}. Store one with `scope camera password {spec}`, or set the environment "
            "variable SCOPE_CAMERA_PASSWORD."
        )
    return Credentials(account.rpartition("@")[0], password)


def camera_account(spec: CameraSpec) -> str:
    """Return a spec's account as ``USER@HOST``, with the port if there is one.

    Raises:
        InputError: The spec contains no user name.
    """
    user, at, _ = spec.address.rpartition("@")
    if not at or not user:
        raise InputError(f"The camera spec must contain a user name: {spec.scheme}://USER@{spec.address[:80]}")
    return spec.address.rstrip("/")


def store_password(spec: CameraSpec, password: str) -> None:
    """Store a password in the operating system's keyring.

    Raises:
        InputError: The spec contains no user name, or the password is empty.
        ConfigError: No keyring is available, or the keyring did not store the password.
    """
    account = camera_account(spec)
    if not password:
        raise InputError("The password is empty. Enter a password.")
    keyring = _keyring()
    if keyring is None:
        raise ConfigError("No keyring is available. Install the `camera` extra, or set SCOPE_CAMERA_PASSWORD.")
    try:
        keyring.set_password(KEYRING_SERVICE, account, password)
    except Exception as error:  # each keyring backend raises its own exceptions
        raise ConfigError(f"The keyring did not store the password: {type(error).__name__}.") from None


def _password_source(spec: CameraSpec) -> str | None:
    if not spec.name:
        return None
    from scope_ptz.factory.cameras.named_cameras import named_cameras

    named = named_cameras().get(spec.name)
    return None if named is None else named.password


def _password(account: str, source: str | None) -> str | None:
    if source == "keyring":
        return _from_keyring(account)
    if source == "prompt":
        return _from_prompt(account)
    if source is not None:
        return read_secret(source.removeprefix("env:"))
    configured = load_settings().camera_password
    if configured is not None and configured.get_secret_value():
        return configured.get_secret_value()
    return _from_keyring(account) or _from_prompt(account)


def _from_prompt(account: str) -> str | None:
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        return None
    return getpass.getpass(f"Password for {account}: ", stream=sys.stderr)


def _from_keyring(account: str) -> str | None:
    keyring = _keyring()
    if keyring is None:
        return None
    try:
        password: str | None = keyring.get_password(KEYRING_SERVICE, account)
    except Exception:  # treat a locked or broken keyring as missing, because another source may have the password
        return None
    return password


def _keyring() -> ModuleType | None:
    """Return the keyring module; None if it is not installed."""
    try:
        import keyring
    except ImportError:
        return None
    return keyring
