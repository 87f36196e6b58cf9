"""Named tokens with roles. The token file stores only hashes, so a copy of it does not give access."""

from __future__ import annotations

import hashlib
import hmac
import os
import re
import secrets
from datetime import UTC, datetime
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.errors import ConfigError, OutputError, UnknownNameError
from scope_ptz.serve.site.clients import Role

PREFIX = "scope_"
"""The prefix of every token, by which scanners for leaked secrets can recognise tokens."""

MAX_TOKEN_CHARS = 200
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 ._@-]{0,59}")


class Token(BaseModel):
    """The stored data for a token.

    Attributes:
        name: The name of the person or program that uses the token.
        role: The role that the token grants. A viewer can only watch; an operator can also send commands.
        sha256: The hash of the token's secret. The secret has 256 random bits, so a hash without a salt is safe.
        created: When the token was created.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str = Field(pattern=rf"^{_NAME.pattern}$")
    role: Role
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")
    created: datetime


class _Content(BaseModel):
    model_config = ConfigDict(extra="forbid")

    version: int = Field(default=1, ge=1, le=1)
    tokens: list[Token] = []


class TokenFile:
    """The file that stores a server's tokens. Changes to it take effect without a restart.

    Args:
        path: The file's path. If the file does not exist, there are no tokens.

    Raises:
        ConfigError: The file cannot be read, or its contents are invalid.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.tokens: tuple[Token, ...] = ()
        self._file_state: tuple[int, int] | None = None
        self._read()

    def find(self, secret: str) -> Token | None:
        """Return the token with the secret that a client sent; None if there is none. If the file has changed, it is read again."""
        self._reload_if_changed()
        digest, match = _digest(secret[:MAX_TOKEN_CHARS]), None
        for token in self.tokens:  # no early exit: the duration must not depend on which token matches
            if hmac.compare_digest(token.sha256, digest):
                match = token
        return match

    def is_valid(self, token: Token) -> bool:
        """Return whether a token that ``find`` returned earlier is still in the file, unchanged."""
        self._reload_if_changed()
        return token in self.tokens

    def add(self, name: str, role: Role) -> str:
        """Create a token and return its secret. Only the hash is stored, so the secret cannot be shown again.

        Raises:
            ConfigError: The name is invalid or already used.
            OutputError: The file cannot be written.
        """
        if not _NAME.fullmatch(name):
            raise ConfigError(
                f"A token name must begin with a letter or a digit and consist of at most 60 letters, digits, spaces and . _ @ -; "
                f"got '{name[:60]}'."
            )
        if any(token.name == name for token in self.tokens):
            raise ConfigError(f"A token named '{name}' already exists. Remove it first, or choose another name.")
        secret = PREFIX + secrets.token_urlsafe(32)
        token = Token(name=name, role=role, sha256=_digest(secret), created=datetime.now(UTC))
        self._write((*self.tokens, token))
        return secret

    def remove(self, name: str) -> None:
        """Remove a token. A running server rejects it in all later requests.

        Raises:
            UnknownNameError: There is no token with this name.
            OutputError: The file cannot be written.
        """
        remaining = tuple(token for token in self.tokens if token.name != name)
        if len(remaining) == len(self.tokens):
            raise UnknownNameError("token", name[:60], [token.name for token in self.tokens])
        self._write(remaining)

    def _reload_if_changed(self) -> None:
        try:
            state = self.path.stat()
        except OSError:
            self.tokens = ()  # without a file, no token is valid
            return
        if (state.st_mtime_ns, state.st_size) != self._file_state:
            self._read()

    def _read(self) -> None:
        try:
            state = self.path.stat()
            content = _Content.model_validate_json(self.path.read_bytes())
        except FileNotFoundError:
            self.tokens, self._file_state = (), None
            return
        except OSError as error:
            raise ConfigError(f"The token file {self.path} cannot be read: {error.strerror}.") from error
        except ValidationError as error:
            # The message must not contain the file's contents.
            location = ".".join(str(part) for part in error.errors(include_input=False)[0]["loc"]) or "the top level"
            raise ConfigError(
                f"The token file {self.path} is invalid at {location}. "
                "Delete it and create the tokens again with `scope token add`."
            ) from None
        self.tokens, self._file_state = tuple(content.tokens), (state.st_mtime_ns, state.st_size)

    def _write(self, tokens: tuple[Token, ...]) -> None:
        partial_file = self.path.with_name(f".{self.path.name}.{os.getpid()}.part")
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with os.fdopen(os.open(partial_file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "w", encoding="utf-8") as file:
                file.write(_Content(tokens=list(tokens)).model_dump_json(indent=2) + "\n")
            partial_file.replace(self.path)
        except OSError as error:
            raise OutputError(f"The token file {self.path} cannot be written: {error.strerror}.") from error
        self._read()


def _digest(secret: str) -> str:
    return hashlib.sha256(secret.encode("utf-8", "replace")).hexdigest()
