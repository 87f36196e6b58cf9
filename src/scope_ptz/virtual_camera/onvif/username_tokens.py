"""WS-Security: determine who sent a request (UsernameToken Profile with a digest), and when."""

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
"""Maximum difference between the clocks of client and device, in seconds."""

_UTILITY = "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-wssecurity-utility-1.0.xsd"
_DIGEST = "#PasswordDigest"
_MAX_FIELD = 512  # maximum number of characters in a field of a token
_FRACTION = re.compile(r"\.\d")


@dataclass(frozen=True, slots=True)
class Stamp:
    """The time at which a client created a request, in Unix seconds.

    It is an interval, because most clients state their time only to whole seconds.
    """

    earliest_s: float
    latest_s: float


@dataclass(frozen=True, slots=True)
class Sender:
    """The authenticated account that sent a request, and the time at which the request was created."""

    account: Account
    stamp: Stamp


def not_authorized(reason: str, *, status: int = 400) -> SoapFault:
    """Return the fault for a request that the sender is not permitted to make."""
    return SoapFault(reason, "NotAuthorized", status=status)


class UsernameTokens:
    """Checks the tokens of requests. Each token is accepted only once, within ``CLOCK_TOLERANCE_S`` of its creation.

    Args:
        accounts: The accounts that may sign in.
        clock_s: Returns the time of the device's clock in Unix seconds.
    """

    def __init__(self, accounts: Accounts, clock_s: Callable[[], float]) -> None:
        self._accounts, self._clock_s = accounts, clock_s
        self._used: dict[tuple[bytes, str], float] = {}

    def sender(self, header: Any) -> Sender | None:
        """Return the sender of a request; None if its header has no token.

        Raises:
            SoapFault: The token is invalid, too old, or was used before.
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
        # An unknown name takes as long to reject as a wrong password, so that names cannot be found by timing.
        secret = secrets.token_hex(16) if account is None else account.password
        expected = hashlib.sha1(nonce + created.encode() + secret.encode()).digest()  # noqa: S324 - the profile requires SHA-1
        if not hmac.compare_digest(expected, digest) or account is None:
            raise not_authorized("The user name or the password is wrong.")
        stamp = _stamp(created)
        if abs(stamp.earliest_s - self._clock_s()) > CLOCK_TOLERANCE_S:
            raise not_authorized("The time in the token differs too much from the device's clock.")
        self._use(nonce, created)
        return Sender(account, stamp)

    def _use(self, nonce: bytes, created: str) -> None:
        now_s = self._clock_s()
        while self._used and next(iter(self._used.values())) <= now_s:  # expired tokens; the oldest is first
            del self._used[next(iter(self._used))]
        if (nonce, created) in self._used:
            raise not_authorized("The token was used before.")
        self._used[nonce, created] = now_s + 2 * CLOCK_TOLERANCE_S


def creation_time(header: Any) -> Stamp | None:
    """Return the creation time of a request to a device without accounts; None if the request does not state it."""
    token = _token(header)
    text = None if token is None else token.findtext(f"{{{_UTILITY}}}Created")
    return _stamp(text.strip()) if text else None


def _token(header: Any) -> Any:
    return None if header is None else header.find(f"{{{SECURITY}}}Security/{{{SECURITY}}}UsernameToken")


def _stamp(text: str) -> Stamp:
    try:
        time = datetime.fromisoformat(text)
        created_s = (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()
    except (ValueError, OverflowError) as error:
        raise not_authorized("The time in the token must be in ISO 8601 format.") from error
    return Stamp(created_s, created_s if _FRACTION.search(text) else created_s + 0.999)


def _text(token: Any, namespace: str, name: str) -> str:
    text = (token.findtext(f"{{{namespace}}}{name}") or "").strip()
    if not text or len(text) > _MAX_FIELD:
        raise not_authorized(f"The token has no usable {name}.")
    return str(text)


def _decode_base64(text: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError) as error:
        raise not_authorized("The token has a field that is not base64.") from error
