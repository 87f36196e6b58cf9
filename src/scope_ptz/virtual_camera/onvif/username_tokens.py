"""WS-Security: authenticate the sender of a request with a digest UsernameToken, and determine the request's creation time."""

from __future__ import annotations

import base64
import binascii
import hashlib
import hmac
import re
import secrets
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from scope_ptz.virtual_camera.accounts import Account, Accounts
from scope_ptz.virtual_camera.onvif.soap import SECURITY, SoapFault

CLOCK_TOLERANCE_S = 60.0
"""Maximum difference in seconds between the client's clock and the device's."""

_UTILITY = "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-wssecurity-utility-1.0.xsd"
_DIGEST = "#PasswordDigest"
_MAX_FIELD = 512  # maximum number of characters in a token field
_FRACTION = re.compile(r"\.\d")


@dataclass(frozen=True, slots=True)
class CreationTime:
    """The time at which a client created a request, in Unix seconds.

    It is an interval, because most clients send the time in whole seconds.
    """

    earliest_s: float
    latest_s: float


@dataclass(frozen=True, slots=True)
class Sender:
    """The authenticated account that sent a request, and the request's creation time."""

    account: Account
    created_at: CreationTime


def not_authorized(reason: str, *, status: int = 400) -> SoapFault:
    """Return a fault for a request that the sender is not permitted to make."""
    return SoapFault(reason, "NotAuthorized", status=status)


class UsernameTokens:
    """Checks the tokens in requests. A token is accepted only once, within ``CLOCK_TOLERANCE_S`` of its creation.

    Args:
        accounts: The accounts that may sign in.
        clock_s: A function that returns the device's time in Unix seconds.
    """

    def __init__(self, accounts: Accounts, clock_s: Callable[[], float]) -> None:
        self._accounts, self._clock_s = accounts, clock_s
        self._used_tokens: dict[tuple[bytes, str], float] = {}

    def sender(self, header: Any) -> Sender | None:
        """Return the sender of a request; None if its header contains no token.

        Raises:
            SoapFault: The token is invalid or too old, or has been used before.
        """
        if (token := _token(header)) is None:
            return None
        password = token.find(f"{{{SECURITY}}}Password")
        if password is None or not password.get("Type", _DIGEST).endswith(_DIGEST):
            raise not_authorized("The device accepts only password digests.")
        created = _text(token, _UTILITY, "Created")
        nonce = _decode_base64(_text(token, SECURITY, "Nonce"))
        digest = _decode_base64(_text(token, SECURITY, "Password"))
        account = self._accounts.find(_text(token, SECURITY, "Username"))
        # Rejecting an unknown name takes as long as rejecting a wrong password, so that timing does not reveal which names exist.
        secret = secrets.token_hex(16) if account is None else account.password
        expected = hashlib.sha1(nonce + created.encode() + secret.encode()).digest()  # noqa: S324 - the profile requires SHA-1
        if not hmac.compare_digest(expected, digest) or account is None:
            raise not_authorized("The user name or the password is wrong.")
        created_at = _parse_creation_time(created)
        if abs(created_at.earliest_s - self._clock_s()) > CLOCK_TOLERANCE_S:
            raise not_authorized("The time in the token differs too much from the device's clock.")
        self._record_use(nonce, created)
        return Sender(account, created_at)

    def _record_use(self, nonce: bytes, created: str) -> None:
        now_s = self._clock_s()
        while self._used_tokens and next(iter(self._used_tokens.values())) <= now_s:  # remove expired tokens, oldest first
            del self._used_tokens[next(iter(self._used_tokens))]
        if (nonce, created) in self._used_tokens:
            raise not_authorized("The token has already been used.")
        self._used_tokens[nonce, created] = now_s + 2 * CLOCK_TOLERANCE_S


def creation_time(header: Any) -> CreationTime | None:
    """Return the creation time of a request without checking its token; None if the request does not include one."""
    token = _token(header)
    text = None if token is None else token.findtext(f"{{{_UTILITY}}}Created")
    return _parse_creation_time(text.strip()) if text else None


def _token(header: Any) -> Any:
    return None if header is None else header.find(f"{{{SECURITY}}}Security/{{{SECURITY}}}UsernameToken")


def _parse_creation_time(text: str) -> CreationTime:
    try:
        time = datetime.fromisoformat(text)
        created_s = (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()
    except (ValueError, OverflowError) as error:
        raise not_authorized("The time in the token must be in ISO 8601 format.") from error
    return CreationTime(created_s, created_s if _FRACTION.search(text) else created_s + 0.999)


def _text(token: Any, namespace: str, name: str) -> str:
    text = (token.findtext(f"{{{namespace}}}{name}") or "").strip()
    if not text or len(text) > _MAX_FIELD:
        raise not_authorized(f"The token has no valid {name}.")
    return str(text)


def _decode_base64(text: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError) as error:
        raise not_authorized("The token has a field that is not base64.") from error
