"""The address of a model server, and how long to wait for it."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import SplitResult, urlsplit

from pydantic import BaseModel, ConfigDict, Field, SecretStr, field_validator

from scope_ptz.errors import ConfigError

MAX_KEY_CHARS = 8192
MAX_BODY_BYTES = 8 * 1024 * 1024
"""The longest reply that is read."""


class Timeouts(BaseModel):
    """Timeouts in seconds.

    Attributes:
        connect_s: The time to connect.
        first_byte_s: The longest silence while waiting for a reply.
        total_s: The time for a call with all its retries.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    connect_s: float = Field(default=5.0, gt=0, allow_inf_nan=False)
    first_byte_s: float = Field(default=60.0, gt=0, allow_inf_nan=False)
    total_s: float = Field(default=120.0, gt=0, allow_inf_nan=False)

    @classmethod
    def within(cls, total_s: float) -> Timeouts:
        """Return timeouts for a call that may take ``total_s``. A slow machine may need half of a long time for its first token."""
        usual = cls()
        return cls(
            connect_s=min(usual.connect_s, total_s),
            first_byte_s=min(max(usual.first_byte_s, total_s / 2), total_s),
            total_s=total_s,
        )


class Endpoint(BaseModel):
    """A model server. For OpenAI-compatible servers ``url`` includes ``/v1``. ``key`` is never shown anywhere."""

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)

    url: str
    model: str = ""
    key: SecretStr | None = None
    timeouts: Timeouts = Timeouts()
    retries: int = Field(default=2, ge=0, le=10)

    @field_validator("url")
    @classmethod
    def _url(cls, url: str) -> str:
        return checked_url(url)

    @field_validator("key")
    @classmethod
    def _key(cls, key: SecretStr | None) -> SecretStr | None:
        return checked_key(key.get_secret_value()) if key is not None else None

    @property
    def secret(self) -> str:
        """The key in clear text, empty when there is none. Only for request headers and for removing it from texts."""
        return self.key.get_secret_value() if self.key is not None else ""

    @property
    def host(self) -> str:
        return urlsplit(self.url).hostname or ""

    @property
    def loopback(self) -> bool:
        """Whether the server is on this machine, so that no proxy is used."""
        return self.host == "localhost" or self.host.startswith("127.") or self.host == "::1"


def checked_url(url: str) -> str:
    """Return an http(s) address without a trailing slash.

    Raises:
        ConfigError: It is no such address, or it contains a user, password, query or fragment.
    """
    url = url.strip()
    parts = _split(url)
    if parts is None or parts.scheme not in ("http", "https") or not parts.hostname:
        shown = _without_secrets(url)
        raise ConfigError(f"'{shown}' is no address of a model server. Give a full one, such as http://127.0.0.1:8000/v1.")
    if parts.username is not None or parts.password is not None:
        raise ConfigError(
            f"The address of {parts.hostname} has a user or password in it. Leave it out, and give the key by its variable."
        )
    if parts.query or parts.fragment:
        raise ConfigError(f"The address {_without_secrets(url)} has a query or fragment. Give it without what follows ? or #.")
    if any(character.isspace() or not character.isprintable() for character in url):
        raise ConfigError("The address of a model server has a space or an unprintable character in it.")
    return url.rstrip("/")


def _split(url: str) -> SplitResult | None:
    try:
        parts = urlsplit(url)
        _ = parts.port  # an invalid port raises only when it is read
    except ValueError:
        return None
    return parts


def _without_secrets(url: str) -> str:
    """Return an address that is safe to show: nothing before an @ and nothing after a ?."""
    bare = url.split("?", 1)[0].split("#", 1)[0]
    scheme, separator, rest = bare.rpartition("://")
    return (scheme + separator + rest.rpartition("@")[2])[:200]


def checked_key(key: str) -> SecretStr | None:
    """Return a key that fits into a header; None if it is blank.

    Raises:
        ConfigError: It cannot be a key. The message does not show it.
    """
    key = key.strip()
    if not key:
        return None
    if len(key) > MAX_KEY_CHARS or not key.isascii() or not key.isprintable() or " " in key:
        raise ConfigError(
            "The key of a model server contains characters that no key has. Check that the whole file or variable is the key."
        )
    return SecretStr(key)


def key_from_file(path: Path) -> SecretStr | None:
    """Return the key in a file.

    Raises:
        ConfigError: The file cannot be read, or its content cannot be a key.
    """
    try:
        with path.open(encoding="utf-8") as file:
            return checked_key(file.read(MAX_KEY_CHARS + 2))
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise ConfigError(f"The key file {path} cannot be read: {reason}.") from None
