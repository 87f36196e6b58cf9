"""Endpoints: the URL, key and timeouts for a model server."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import SplitResult, urlsplit

from pydantic import BaseModel, ConfigDict, Field, SecretStr, field_validator

from scope_ptz.errors import ConfigError

MAX_KEY_CHARS = 8192
MAX_BODY_BYTES = 8 * 1024 * 1024
"""Maximum size of a reply body in bytes. Larger replies are rejected."""


class Timeouts(BaseModel):
    """Timeouts in seconds.

    Attributes:
        connect_s: Timeout for connecting.
        first_byte_s: Timeout for the start of the reply, and for each pause during the reply.
        total_s: Timeout for a call with all of its retries.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    connect_s: float = Field(default=5.0, gt=0, allow_inf_nan=False)
    first_byte_s: float = Field(default=60.0, gt=0, allow_inf_nan=False)
    total_s: float = Field(default=120.0, gt=0, allow_inf_nan=False)

    @classmethod
    def within(cls, total_s: float) -> Timeouts:
        """Return the timeouts for a call that may take ``total_s`` in total.

        With a long timeout, up to half of it may pass before the reply starts, because slow machines may take that long to generate
        the first token.
        """
        default = cls()
        return cls(
            connect_s=min(default.connect_s, total_s),
            first_byte_s=min(max(default.first_byte_s, total_s / 2), total_s),
            total_s=total_s,
        )


class Endpoint(BaseModel):
    """A model server and the model to use on it.

    Attributes:
        url: The base URL, including ``/v1`` for OpenAI-compatible servers.
        model: The model's served name; empty for servers with a single model.
        key: The API key, which is never shown.
        timeouts: The request timeouts.
        retries: The maximum number of retries per call.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)

    url: str
    model: str = ""
    key: SecretStr | None = None
    timeouts: Timeouts = Timeouts()
    retries: int = Field(default=2, ge=0, le=10)

    @field_validator("url")
    @classmethod
    def _url(cls, url: str) -> str:
        return validate_url(url)

    @field_validator("key")
    @classmethod
    def _key(cls, key: SecretStr | None) -> SecretStr | None:
        return validate_key(key.get_secret_value()) if key is not None else None

    @property
    def secret(self) -> str:
        """The key in clear text; empty if there is none. Use it only in request headers and to mask the key in text."""
        return self.key.get_secret_value() if self.key is not None else ""

    @property
    def host(self) -> str:
        return urlsplit(self.url).hostname or ""

    @property
    def is_loopback(self) -> bool:
        """Whether the server is on this machine, in which case requests never use a proxy."""
        return self.host == "localhost" or self.host.startswith("127.") or self.host == "::1"


def validate_url(url: str) -> str:
    """Validate an HTTP or HTTPS URL, and return it without a trailing slash.

    Raises:
        ConfigError: The text is not an HTTP or HTTPS URL, or contains a user name, password, query, fragment or invalid character.
    """
    url = url.strip()
    parts = _split(url)
    if parts is None or parts.scheme not in ("http", "https") or not parts.hostname:
        shown = _without_secrets(url)
        raise ConfigError(f"'{shown}' is not a valid model server URL. Use a full URL, such as http://127.0.0.1:8000/v1.")
    if parts.username is not None or parts.password is not None:
        raise ConfigError(f"The URL of {parts.hostname} contains a user name or password. Set the API key's variable instead.")
    if parts.query or parts.fragment:
        raise ConfigError(f"The URL {_without_secrets(url)} contains a query or fragment. Remove everything from ? or # onwards.")
    if any(character.isspace() or not character.isprintable() for character in url):
        raise ConfigError("The model server URL contains a space or an unprintable character. Remove the character.")
    return url.rstrip("/")


def _split(url: str) -> SplitResult | None:
    try:
        parts = urlsplit(url)
        _ = parts.port  # an invalid port raises ValueError only when it is read
    except ValueError:
        return None
    return parts


def _without_secrets(url: str) -> str:
    """Return a URL without user name, password, query and fragment, so that it is safe to show."""
    address = url.split("?", 1)[0].split("#", 1)[0]
    scheme, separator, rest = address.rpartition("://")
    return (scheme + separator + rest.rpartition("@")[2])[:200]


def validate_key(key: str) -> SecretStr | None:
    """Validate a key for use in a header, and return it; None if it is blank.

    Raises:
        ConfigError: The text is not a valid key. The message does not show the text.
    """
    key = key.strip()
    if not key:
        return None
    if len(key) > MAX_KEY_CHARS or not key.isascii() or not key.isprintable() or " " in key:
        raise ConfigError(
            "The model server's key is too long or contains invalid characters. "
            "Check that the file or variable contains only the key."
        )
    return SecretStr(key)


def key_from_file(path: Path) -> SecretStr | None:
    """Read a key from a file.

    Raises:
        ConfigError: The file cannot be read, or its content is not a valid key.
    """
    try:
        with path.open(encoding="utf-8") as file:
            return validate_key(file.read(MAX_KEY_CHARS + 2))
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise ConfigError(f"The key file {path} cannot be read: {reason}.") from None
