"""Sign in to an RTSP server with digest authentication (RFC 7616)."""

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
    """Answers the challenges of one server. Basic authentication is used only over TLS, because it reveals the password.

    Args:
        place: The host and port of the server, for error messages.
        credentials: The account; None if there is none.
        tls: Whether the connection is encrypted.
    """

    def __init__(self, place: str, credentials: Credentials | None, *, tls: bool) -> None:
        self._place, self._tls = place, tls
        self._account = credentials if credentials is not None and credentials.user else None
        self._challenge: dict[str, str] | None = None
        self._basic, self._count = False, 0

    @property
    def stale(self) -> bool:
        """Whether the last challenge states that only the nonce of the previous answer was too old."""
        return self._challenge is not None and self._challenge.get("stale", "").lower() == "true"

    def accept(self, challenges: Iterable[str]) -> None:
        """Use the best of the challenges in a reply with status 401.

        Args:
            challenges: The values of its ``WWW-Authenticate`` headers.

        Raises:
            CameraSignInError: There is no account, or no challenge that can be answered without revealing the password.
        """
        if self._account is None:
            raise CameraSignInError(f"The RTSP server at {self._place} requires an account. Add its name to the camera: user@host.")
        texts = (text.encode("latin-1", "replace").decode("utf-8", "replace").strip() for text in challenges)
        offers = [(scheme.lower(), _parameters(rest)) for scheme, _, rest in (text.partition(" ") for text in texts)]
        digests = {fields.get("algorithm", "MD5").upper(): fields for scheme, fields in offers if scheme == "digest"}
        usable = next((digests[name] for name in _ALGORITHMS if name in digests and "nonce" in digests[name]), None)
        self._challenge, self._count = usable, 0
        self._basic = usable is None and self._tls and any(scheme == "basic" for scheme, _ in offers)
        if usable is None and not self._basic:
            raise CameraSignInError(
                f"The RTSP server at {self._place} does not offer digest authentication, so the password was not sent. Enable it "
                "in the camera's settings."
            )

    def answer(self, method: str, uri: str) -> str | None:
        """Return the ``Authorization`` header of a request; None before the first challenge.

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
        stated = {"username": account.user, "realm": realm, "nonce": nonce, "uri": uri}
        if "auth" in re.split(r"[\s,]+", fields.get("qop", "")):
            self._count += 1
            count, own = f"{self._count:08x}", secrets.token_hex(8)
            stated |= {"response": digest(secret, nonce, count, own, "auth", request), "cnonce": own}
            ending = f", qop=auth, nc={count}"
        else:
            stated["response"], ending = digest(secret, nonce, request), ""
        if "opaque" in fields:
            stated["opaque"] = fields["opaque"]
        if "algorithm" in fields:
            ending += f", algorithm={algorithm}"
        header = "Digest " + ", ".join(f'{name}="{_quoted(value)}"' for name, value in stated.items()) + ending
        return header.encode().decode("latin-1")  # messages are encoded as Latin-1, and names in UTF-8


def _parameters(text: str) -> dict[str, str]:
    found = {}
    for name, quoted, plain in _PARAMETER.findall(text):
        found[name.lower()] = plain or re.sub(r"\\(.)", r"\1", quoted)
    return found


def _quoted(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"')
