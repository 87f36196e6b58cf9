"""The cameras of a site by name, from a file ``scope.yaml``."""

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


class NamedCamera(_Part):
    """One camera of a site.

    Attributes:
        camera: The spec, such as ``axis://operator@10.0.0.7`` or ``sim:highway-works``. It never holds a password.
        password: Where its password comes from: the ``keyring`` of the operating system, a ``prompt``, or an environment variable
            (``env:YARD_GATE_PASSWORD``). The default is SCOPE_CAMERA_PASSWORD, then the keyring, then a prompt.
        fingerprint: SHA-256 of the certificate of a device that signed its own, as ``openssl x509 -fingerprint -sha256`` prints it.
        mounting: How it is mounted.
        rules: Limits, keep-out regions, masks, dead zone and shortest time between moves.
        audit_log: File that records who asked what and what moved, relative to the folder of ``scope.yaml``.
    """

    camera: str = Field(min_length=1, max_length=500)
    password: str | None = None
    fingerprint: str | None = None
    mounting: Mounting = Mounting()
    rules: CameraRules = CameraRules()
    audit_log: Path | None = None

    @field_validator("password")
    @classmethod
    def _check_password_source(cls, value: str | None) -> str | None:
        if value is not None and value not in ("keyring", "prompt") and not re.fullmatch(r"env:[A-Za-z_][A-Za-z0-9_]*", value):
            # The value is not repeated: it may be a password.
            raise ValueError("password says where the password comes from: keyring, prompt, or env:NAME of a variable")
        return value

    @field_validator("fingerprint")
    @classmethod
    def _check_fingerprint(cls, value: str | None) -> str | None:
        if value is not None and len(value.replace(":", "")) != 64:
            raise ValueError("fingerprint is a SHA-256 in 64 hexadecimal digits, with or without colons")
        return value


class CameraFile(_Part):
    """The content of ``scope.yaml``."""

    version: Literal[1] = 1
    cameras: dict[Name, NamedCamera] = {}


def load_camera_file(path: Path | None) -> CameraFile:
    """Read a camera file. Without one there are no named cameras.

    Raises:
        ConfigError: The file cannot be read, or its content is wrong. The message says where.
    """
    if path is None:
        return CameraFile()
    import yaml

    try:
        text = path.read_bytes()
        if len(text) > MAX_FILE_BYTES:
            raise ConfigError(f"{path} has {len(text)} bytes; a camera file has at most {MAX_FILE_BYTES}.")
        content: Any = yaml.safe_load(text.decode("utf-8"))
    except OSError as error:
        raise ConfigError(f"The camera file {path} cannot be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"The camera file {path} is not UTF-8 text.") from error
    except (yaml.YAMLError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        where = f" in line {mark.line + 1}" if mark else ""
        raise ConfigError(f"The camera file {path} is not valid YAML{where}: {getattr(error, 'problem', 'too deep')}.") from error
    try:
        return CameraFile.model_validate({} if content is None else content)
    except ValidationError as error:
        first = error.errors(include_input=False, include_url=False)[0]
        place = ".".join(str(part) for part in first["loc"]) or "the top level"
        raise ConfigError(f"The camera file {path} is wrong at {place}: {first['msg']}.") from error


def schema() -> dict[str, Any]:
    """Return the JSON schema of ``scope.yaml``."""
    return CameraFile.model_json_schema()
