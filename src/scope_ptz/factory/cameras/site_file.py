"""The file ``scope.yaml``, which names the cameras of a site."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from scope_ptz.camera.guard.rules import CameraRules, Mounting
from scope_ptz.errors import ConfigError

MAX_FILE_BYTES = 1_000_000

Name = Annotated[str, Field(pattern=r"^[a-z0-9]+(-[a-z0-9]+)*$", max_length=60)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class WhenIdle(_Part):
    """The view to which a server returns an idle camera.

    Attributes:
        after_s: Seconds since the last command after which the camera counts as idle.
        preset: The preset to go to; None for the home position.
    """

    after_s: float = Field(ge=1.0, le=7 * 86_400.0, allow_inf_nan=False)
    preset: str | None = Field(default=None, min_length=1, max_length=31)


class NamedCamera(_Part):
    """A camera at a site.

    Attributes:
        camera: The spec, such as ``axis://operator@10.0.0.7`` or ``sim:highway-works``. It must not contain a password.
        password: Source of the camera's password: the operating system's ``keyring``, a ``prompt``, or an environment variable
            (``env:YARD_GATE_PASSWORD``). By default, SCOPE_CAMERA_PASSWORD, the keyring and a prompt are tried in this order.
        fingerprint: SHA-256 fingerprint of a self-signed certificate, as printed by ``openssl x509 -fingerprint -sha256``.
        mounting: How the camera is mounted.
        rules: Limits, keep-out regions, masks, dead zone and minimum time between moves.
        audit_log: File for recording instructions, their authors and the moves, relative to the folder that contains
            ``scope.yaml``.
        when_idle: The view to which a server returns the camera when it is idle.
    """

    camera: str = Field(min_length=1, max_length=500)
    password: str | None = None
    fingerprint: str | None = None
    mounting: Mounting = Mounting()
    rules: CameraRules = CameraRules()
    audit_log: Path | None = None
    when_idle: WhenIdle | None = None

    @field_validator("password")
    @classmethod
    def _check_password_source(cls, value: str | None) -> str | None:
        if value is not None and value not in ("keyring", "prompt") and not re.fullmatch(r"env:[A-Za-z_][A-Za-z0-9_]*", value):
            # The message omits the value, which may be a password.
            raise ValueError("password must be keyring, prompt, or env:NAME with the name of an environment variable")
        return value

    @field_validator("fingerprint")
    @classmethod
    def _check_fingerprint(cls, value: str | None) -> str | None:
        if value is not None and len(value.replace(":", "")) != 64:
            raise ValueError("fingerprint must be a SHA-256 fingerprint with 64 hexadecimal digits, with or without colons")
        return value


class CameraFile(_Part):
    """The content of ``scope.yaml``."""

    version: Literal[1] = 1
    cameras: dict[Name, NamedCamera] = {}


def load_camera_file(path: Path | None) -> CameraFile:
    """Read a camera file. If ``path`` is None, return a file without cameras.

    Raises:
        ConfigError: The file cannot be read, or its content is invalid. The message names the invalid field or line.
    """
    if path is None:
        return CameraFile()
    import yaml

    try:
        text = path.read_bytes()
        if len(text) > MAX_FILE_BYTES:
            raise ConfigError(f"{path} has {len(text)} bytes, but a camera file may have at most {MAX_FILE_BYTES}.")
        content: Any = yaml.safe_load(text.decode("utf-8"))
    except OSError as error:
        raise ConfigError(f"The camera file {path} cannot be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"The camera file {path} is not UTF-8 text.") from error
    except (yaml.YAMLError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        line_text = f" on line {mark.line + 1}" if mark else ""
        raise ConfigError(
            f"The camera file {path} is not valid YAML{line_text}: {getattr(error, 'problem', 'it is nested too deeply')}."
        ) from error
    try:
        return CameraFile.model_validate({} if content is None else content)
    except ValidationError as error:
        first = error.errors(include_input=False, include_url=False)[0]
        location = ".".join(str(part) for part in first["loc"]) or "the top level"
        raise ConfigError(f"The camera file {path} is invalid at {location}: {first['msg']}.") from error


def schema() -> dict[str, Any]:
    """Return the JSON schema for ``scope.yaml``."""
    return CameraFile.model_json_schema()
