"""Sessions of signed-in browsers. A browser sends its token once; afterwards, a cookie identifies its session."""

from __future__ import annotations

import hashlib
import secrets
from collections import OrderedDict
from dataclasses import dataclass
from time import monotonic

from scope_ptz.serve.security.tokens import Token

COOKIE = "scope_session"
LIFETIME_S = 12 * 3600.0  # seconds until a session ends
MAX_SESSIONS = 1_000
"""Maximum number of sessions. A new session beyond this limit ends the oldest one."""


@dataclass(frozen=True, slots=True)
class Session:
    """A signed-in browser's session.

    Attributes:
        token: The token that the browser signed in with.
        key: A public identifier of the session. The cookie cannot be derived from it.
        ends_s: When the session ends, as a ``time.monotonic`` value.
    """

    token: Token
    key: str
    ends_s: float


class Sessions:
    """A server's sessions. They are kept only in memory, so a restart signs all browsers out."""

    def __init__(self, *, lifetime_s: float = LIFETIME_S) -> None:
        self._lifetime_s = lifetime_s
        self._sessions: OrderedDict[str, Session] = OrderedDict()

    def begin(self, token: Token) -> str:
        """Begin a session and return its cookie value."""
        secret = secrets.token_urlsafe(32)
        digest = _digest(secret)
        self._sessions[digest] = Session(token, digest[:16], monotonic() + self._lifetime_s)
        while len(self._sessions) > MAX_SESSIONS:
            self._sessions.popitem(last=False)
        return secret

    def find(self, secret: str) -> Session | None:
        """Return the session with this cookie value; None if there is none, or if it has ended."""
        digest = _digest(secret)
        session = self._sessions.get(digest)
        if session is not None and monotonic() > session.ends_s:
            del self._sessions[digest]
            return None
        return session

    def end(self, secret: str) -> None:
        """End the session with this cookie value. If there is none, the call has no effect."""
        self._sessions.pop(_digest(secret), None)


def _digest(secret: str) -> str:
    return hashlib.sha256(secret[:200].encode("utf-8", "replace")).hexdigest()
