"""HTTP authentication that sends credentials only to one device."""

from __future__ import annotations

from collections.abc import Generator
from typing import TYPE_CHECKING

import httpx2

from scope_ptz.camera.network.errors import CameraSignInError, ForeignAddressError

if TYPE_CHECKING:
    from scope_ptz.camera.network.address import DeviceAddress
    from scope_ptz.camera.network.credentials import Credentials


class PinnedSignIn(httpx2.Auth):
    """Digest authentication for one host and port. Basic authentication, which reveals the password, is used only over TLS.

    Args:
        address: The address of the device.
        credentials: The credentials for signing in.
    """

    def __init__(self, address: DeviceAddress, credentials: Credentials) -> None:
        self._address = address
        self._digest = httpx2.DigestAuth(credentials.user, credentials.password)
        self._basic = httpx2.BasicAuth(credentials.user, credentials.password)
        self._basic_required = False

    def auth_flow(self, request: httpx2.Request) -> Generator[httpx2.Request, httpx2.Response, None]:
        url = request.url
        if not self._address.has_origin(url.scheme, url.host, url.port):
            raise ForeignAddressError(
                f"A request to a host other than {self._address} was blocked, because credentials are sent only to the camera."
            )
        if self._basic_required:
            yield from self._basic.auth_flow(request)
            return
        flow = self._digest.auth_flow(request)
        response = yield next(flow)
        if response.status_code == 401 and (offers := _schemes(response)) and "digest" not in offers:
            yield from self._basic_auth_flow(request, offers)
            return
        try:
            while True:
                response = yield flow.send(response)
        except StopIteration:
            return

    def _basic_auth_flow(self, request: httpx2.Request, offers: set[str]) -> Generator[httpx2.Request, httpx2.Response, None]:
        if "basic" not in offers:
            raise CameraSignInError(
                f"The camera at {self._address} offers no supported authentication method. Enable digest authentication in the "
                "camera's settings."
            )
        if not self._address.tls:
            raise CameraSignInError(
                f"The camera at {self._address} accepts passwords in clear text only. Enable digest authentication, or add ?tls=on."
            )
        self._basic_required = True
        yield from self._basic.auth_flow(request)


def _schemes(response: httpx2.Response) -> set[str]:
    """Return the authentication schemes that a reply offers, in lower case."""
    return {value.split(" ", 1)[0].lower() for value in response.headers.get_list("www-authenticate")}
