"""Digest authentication (RFC 7616) with an RTSP server."""

from __future__ import annotations

import hashlib
import re
import secrets
from base64 import b64encode
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from scope_ptz.camera.network.errors import CameraSignInError

if TYPE_CHECKING:
    from scope_ptz.camera.network.credentials import Credentials

_ALGORITHMS: dict[str, Callable[[bytes], hashlib._Hash]] = {"SHA-256": hashlib.sha256, "MD5": hashlib.md5}  # best first
_PARAMETER = re.compile(r'([\w*-]+)\s*=\s*(?:"((?:[^"\\]|\\.)*)"|([^\s,"]+))')


class RtspSignIn:
    """Answers a server's authentication challenges. Basic authentication is used only over TLS, because it reveals the password.

    Args:
        server: The host and port of the server, for error messages.
        credentials: The credentials; None if there are none.
        tls: Whether the connection is encrypted.
    """

    def __init__(self, server: str, credentials: Credentials | None, *, tls: bool) -> None:
        self._server, self._tls = server, tls
        self._account = credentials if credentials is not None and credentials.user else None
        self._challenge: dict[str, str] | None = None
        self._basic, self._count = False, 0

    @property
    def is_stale(self) -> bool:
        """Whether the last challenge says that the previous answer was rejected only because its nonce had expired."""
        return self._challenge is not None and self._challenge.get("stale", "").lower() == "true"

    def accept(self, challenges: Iterable[str]) -> None:
        """Choose the best of the challenges in a 401 reply.

        Args:
            challenges: The values of the ``WWW-Authenticate`` headers.

        Raises:
            CameraSignInError: There are no credentials, or no challenge can be answered without revealing the password.
        """
        if self._account is None:
            raise CameraSignInError(
                f"The RTSP server at {self._server} requires an account. Add the user name to the camera spec: user@host."
            )
        texts = (text.encode("latin-1", "replace").decode("utf-8", "replace").strip() for text in challenges)
        schemes = [(scheme.lower(), _parameters(rest)) for scheme, _, rest in (text.partition(" ") for text in texts)]
        digests = {fields.get("algorithm", "MD5").upper(): fields for scheme, fields in schemes if scheme == "digest"}
        usable = next((digests[name] for name in _ALGORITHMS if name in digests and "nonce" in digests[name]), None)
        self._challenge, self._count = usable, 0
        self._basic = usable is None and self._tls and any(scheme == "basic" for scheme, _ in schemes)
        if usable is None and not self._basic:
            raise CameraSignInError(
                f"The RTSP server at {self._server} does not offer digest authentication, so the password was not sent. Enable "
                "digest authentication in the camera's settings."
            )

    def answer(self, method: str, uri: str) -> str | None:
        """Return the ``Authorization`` header for a request; None before the first challenge.

        Args:
            method: The method of the request.
            uri: The URI in the first line of the request.
        """
        account, fields = self._account, self._challenge
        if account is None or (fields is None and not self._basic):
            return None
        if fields is None:
            return f"Basic {b64encode(f'{account.user}:{account.password}'.encode()).decode()}"
        algorithm = fields.get("algorithm", "MD5").upper()

        def digest(*parts: str) -> str:
            return _ALGORITHMS[algorithm](":".join(parts).encode()).hexdigest()

        realm, nonce = fields.get("realm", ""), fields["nonce"]
        secret, request = digest(account.user, realm, account.password), digest(method, uri)
        header_fields = {"username": account.user, "realm": realm, "nonce": nonce, "uri": uri}
        if "auth" in re.split(r"[\s,]+", fields.get("qop", "")):
            self._count += 1
            count, client_nonce = f"{self._count:08x}", secrets.token_hex(8)
            header_fields |= {"response": digest(secret, nonce, count, client_nonce, "auth", request), "cnonce": client_nonce}
            ending = f", qop=auth, nc={count}"
        else:
            header_fields["response"], ending = digest(secret, nonce, request), ""
        if "opaque" in fields:
            header_fields["opaque"] = fields["opaque"]
        if "algorithm" in fields:
            ending += f", algorithm={algorithm}"
        header = "Digest " + ", ".join(f'{name}="{_escape(value)}"' for name, value in header_fields.items()) + ending
        return header.encode().decode("latin-1")  # messages are encoded as Latin-1, but user names as UTF-8


def _parameters(text: str) -> dict[str, str]:
    fields = {}
    for name, quoted, plain in _PARAMETER.findall(text):
        fields[name.lower()] = plain or re.sub(r"\\(.)", r"\1", quoted)
    return fields


def _escape(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"')
