"""The server side of digest authentication (RFC 7616) for HTTP and RTSP."""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets
from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Callable
from dataclasses import dataclass
from struct import Struct
from time import monotonic
from urllib.parse import urlsplit

from scope_ptz.virtual_camera.accounts import Account, Accounts

NONCE_LIFETIME_S = 300.0
"""Lifetime of a nonce in seconds. After that, a correct response receives a new challenge that is marked as stale."""

_ALGORITHMS: dict[str, Callable[[bytes], hashlib._Hash]] = {"SHA-256": hashlib.sha256, "MD5": hashlib.md5}

_OFFERED_ALGORITHMS = ("MD5", "SHA-256", "MD5")
"""The algorithms offered by the challenges in a reply, in order.

Some clients, such as Python's ``urllib``, read only the first challenge, and others, such as older versions of FFmpeg, only the
last one. Both kinds require MD5.
"""

_PARAMETER = re.compile(r'([\w*-]+)\s*=\s*(?:"((?:[^"\\]|\\.)*)"|([^\s,"]+))\s*(?:,|$)')
_NONCE = Struct("!d12s")  # the content of a nonce: its time of issue and random bytes, followed by a signature
_SIGNATURE_BYTES = 16
_WINDOW = 64  # number of recent nonce counts to track, because requests may arrive out of order


@dataclass(frozen=True, slots=True)
class DigestResult:
    """The result of an authentication check.

    Attributes:
        account: The authenticated account; None if the request must be rejected.
        stale: Whether only the nonce is invalid, so that the client can repeat the request with a new one.
    """

    account: Account | None = None
    stale: bool = False


class DigestAuthenticator:
    """Challenges clients and checks their responses. The password itself is never sent over the network.

    The server signs nonces instead of storing them, so unauthenticated requests use no memory.

    Args:
        accounts: The accounts that may sign in.
        realm: The authentication realm, which clients show to their users.
        qop: Whether to offer and require ``qop=auth``, which detects replayed requests. Many RTSP clients do not support it.
            Without it, challenges always say whether the nonce was stale, as on the RTSP servers of AXIS cameras.
        nonce_lifetime_s: Seconds for which a nonce is valid.
        now_s: A function that returns the current time in seconds, used to determine the age of nonces.
    """

    def __init__(
        self,
        accounts: Accounts,
        realm: str,
        *,
        qop: bool = True,
        nonce_lifetime_s: float = NONCE_LIFETIME_S,
        now_s: Callable[[], float] = monotonic,
    ) -> None:
        self._accounts, self.realm, self._qop = accounts, realm.replace("\\", "").replace('"', ""), qop
        self._lifetime_s, self._now_s = nonce_lifetime_s, now_s
        self._key = secrets.token_bytes(32)
        self._used_nonces: dict[str, _NonceCounts] = {}

    def challenges(self, *, stale: bool = False) -> list[str]:
        """Return the values of the ``WWW-Authenticate`` headers for a 401 reply."""
        nonce = self._new_nonce()
        ending = (', qop="auth"' + (", stale=true" if stale else "")) if self._qop else f", stale={str(stale).upper()}"
        return [f'Digest realm="{self.realm}", nonce="{nonce}", algorithm={name}{ending}' for name in _OFFERED_ALGORITHMS]

    def check(self, authorization: str | None, method: str, uri: str | None = None) -> DigestResult:
        """Check the ``Authorization`` header of a request.

        Args:
            authorization: The value of the header; None if there is none.
            method: The method of the request, such as ``GET`` or ``DESCRIBE``.
            uri: The request target (for HTTP, the path and query), which the URI in the header must match. None accepts any URI,
                as RTSP requires: for a single track, clients authenticate with the URI of the whole stream.
        """
        fields = _parse(authorization or "")
        algorithm = _ALGORITHMS.get(fields.get("algorithm", "MD5").upper())
        nonce, header_uri = fields.get("nonce", ""), fields.get("uri", "")
        issued_s = self._issued_s(nonce)
        if algorithm is None or issued_s is None or (uri is not None and not _same_target(header_uri, uri)):
            return DigestResult()
        if (self._qop or "qop" in fields) and not (fields.get("qop") == "auth" and fields.get("cnonce")):
            return DigestResult()
        account = self._accounts.find(fields.get("username", ""))
        # Rejecting an unknown name takes as long as rejecting a wrong password, so that timing does not reveal which names exist.
        password = secrets.token_hex(16) if account is None else account.password
        expected = self._response(algorithm, fields, password, method)
        if not hmac.compare_digest(expected.encode(), fields.get("response", "").lower().encode()) or account is None:
            return DigestResult()
        if fields.get("realm") != self.realm:
            return DigestResult()
        if self._now_s() - issued_s > self._lifetime_s or not self._is_first_use(nonce, issued_s, fields):
            return DigestResult(stale=True)
        return DigestResult(account)

    def _response(self, algorithm: Callable[[bytes], hashlib._Hash], fields: dict[str, str], password: str, method: str) -> str:
        def digest(*parts: str) -> str:
            return algorithm(":".join(parts).encode()).hexdigest()

        secret = digest(fields.get("username", ""), self.realm, password)
        request = digest(method, fields.get("uri", ""))
        if "qop" not in fields:
            return digest(secret, fields.get("nonce", ""), request)
        return digest(secret, fields.get("nonce", ""), fields.get("nc", ""), fields["cnonce"], fields["qop"], request)

    def _new_nonce(self) -> str:
        content = _NONCE.pack(self._now_s(), secrets.token_bytes(12))
        return urlsafe_b64encode(content + self._signature(content)).decode()

    def _issued_s(self, nonce: str) -> float | None:
        """Return the time at which this server issued a nonce; None if the nonce is invalid or was not issued by this server."""
        try:
            content = urlsafe_b64decode(nonce.encode())
        except ValueError:
            return None
        content, signature = content[: _NONCE.size], content[_NONCE.size :]
        if len(content) != _NONCE.size or not hmac.compare_digest(signature, self._signature(content)):
            return None
        return float(_NONCE.unpack(content)[0])

    def _signature(self, content: bytes) -> bytes:
        return hmac.digest(self._key, content, "sha256")[:_SIGNATURE_BYTES]

    def _is_first_use(self, nonce: str, issued_s: float, fields: dict[str, str]) -> bool:
        """Return whether this is the first request with its nonce and count. Without ``qop``, there is no count, so return True."""
        if "qop" not in fields:
            return True
        try:
            count = int(fields.get("nc", ""), 16)
        except ValueError:
            return False
        if nonce not in self._used_nonces:
            oldest_s = self._now_s() - self._lifetime_s
            self._used_nonces = {known: counts for known, counts in self._used_nonces.items() if counts.issued_s >= oldest_s}
            self._used_nonces[nonce] = _NonceCounts(issued_s)
        return self._used_nonces[nonce].add(count)


@dataclass(slots=True)
class _NonceCounts:
    """The counts that have been used with a nonce.

    Attributes:
        issued_s: The time at which the nonce was issued.
        highest: The highest count so far.
        used_bits: Bit ``k`` is set if the count ``highest - k`` has been used.
    """

    issued_s: float
    highest: int = 0
    used_bits: int = 0

    def add(self, count: int) -> bool:
        """Record a count. Return whether it was unused and recent enough."""
        if count > self.highest:
            shift = min(count - self.highest, _WINDOW)
            self.used_bits = ((self.used_bits << shift) | 1) & ((1 << _WINDOW) - 1)
            self.highest = count
            return True
        offset = self.highest - count
        if count < 1 or offset >= _WINDOW or self.used_bits >> offset & 1:
            return False
        self.used_bits |= 1 << offset
        return True


def _parse(authorization: str) -> dict[str, str]:
    """Parse an ``Authorization`` header into its fields; empty if it is not a digest response."""
    scheme, _, rest = authorization.strip().partition(" ")
    if scheme.lower() != "digest":
        return {}
    parameters = _PARAMETER.findall(rest)
    return {name.lower(): re.sub(r"\\(.)", r"\1", quoted) or plain for name, quoted, plain in parameters}


def _same_target(header_uri: str, target: str) -> bool:
    """Return whether the URI in an ``Authorization`` header matches the request target.

    Some clients put the full URL in the header instead of the path and query.
    """
    if header_uri == target:
        return True
    parts = urlsplit(header_uri)
    return bool(parts.scheme) and (parts.path or "/") + (f"?{parts.query}" if parts.query else "") == target
