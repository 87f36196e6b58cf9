"""An HTTP client for a single device, with authentication, timeouts, retries, and errors that tell the user what to do."""

from __future__ import annotations

import ssl
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from typing import Any

import anyio
import httpx2

from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.errors import (
    CameraReplyError,
    CameraSignInError,
    CameraTimeoutError,
    CameraUnreachableError,
    ForeignAddressError,
)
from scope_ptz.camera.network.sign_in import PinnedSignIn
from scope_ptz.camera.network.trust import PinnedContext
from scope_ptz.errors import CameraError

MAX_BODY_BYTES = 32 * 2**20
"""Maximum size of a reply in bytes. A 4K JPEG is about 4 MB."""

BACKOFF_S = (0.15, 0.4)
"""Pauses in seconds before each retry."""


@dataclass(frozen=True, slots=True)
class DeviceTimeouts:
    """Timeouts in seconds."""

    connect_s: float = 4.0
    reply_s: float = 8.0


@dataclass(frozen=True, slots=True)
class DeviceReply:
    """A reply from a device. Its body is untrusted.

    Attributes:
        status: HTTP status code: 2xx, or one that the caller accepts.
        content_type: Media type without parameters, in lower case.
        body: The decompressed body.
    """

    status: int
    content_type: str
    body: bytes = field(repr=False)


class DeviceHttp:
    """An HTTP client for a single device. It does not follow redirects or use proxies.

    Args:
        address: The address of the device.
        credentials: The credentials for signing in.
        timeouts: The timeouts.
        verify: Whether to verify the certificate, or a TLS context that verifies it.
    """

    def __init__(
        self,
        address: DeviceAddress,
        credentials: Credentials,
        *,
        timeouts: DeviceTimeouts | None = None,
        verify: ssl.SSLContext | bool = True,
    ) -> None:
        self.address, self.credentials = address, credentials
        # Without TLS there is nothing to verify, and reading the certificate store takes 50 ms.
        self._verify = verify if address.tls else False
        self._timeouts = timeouts or DeviceTimeouts()
        self._client = httpx2.AsyncClient(
            base_url=address.base_url,
            auth=PinnedSignIn(address, credentials),
            timeout=httpx2.Timeout(self._timeouts.reply_s, connect=self._timeouts.connect_s),
            # A device may close idle connections at any time, and that must not make a command fail.
            limits=httpx2.Limits(max_connections=8, max_keepalive_connections=4, keepalive_expiry=2.0),
            follow_redirects=False,
            trust_env=False,
            verify=self._verify,
        )

    def __repr__(self) -> str:
        return f"DeviceHttp({self.address})"

    @property
    def tls_context(self) -> ssl.SSLContext | None:
        """The TLS context that verifies the device's certificate; None to use the system's certificate authorities."""
        return self._verify if isinstance(self._verify, ssl.SSLContext) else None

    def description(self) -> dict[str, object]:
        """Return the values, including the password, from which another process can create an equivalent client."""
        address, account = self.address, self.credentials
        certificate = self._verify.certificate if isinstance(self._verify, PinnedContext) else None
        return {
            "host": address.host, "port": address.port, "tls": address.tls, "certificate": certificate,
            "user": account.user, "password": account.password,
        }  # fmt: skip

    @classmethod
    def from_description(cls, description: Mapping[str, Any]) -> DeviceHttp:
        """Create a client from a dictionary that ``description`` returned."""
        address = DeviceAddress(description["host"], description["port"], description["tls"])
        verify = True if description["certificate"] is None else PinnedContext.of(description["certificate"])
        return cls(address, Credentials(description["user"], description["password"]), verify=verify)

    async def get(
        self, path: str, parameters: Mapping[str, str] | None = None, *, retry: bool = True, accept: tuple[int, ...] = ()
    ) -> DeviceReply:
        """Send a GET request.

        Args:
            path: The path on the device.
            parameters: The query parameters.
            retry: Whether the request may be sent again after a lost connection. This must be false for relative moves, because
                the camera could move twice.
            accept: Status codes besides 2xx for which to return the reply instead of raising an error.

        Raises:
            CameraError: One of the errors in ``camera.network.errors``.
        """
        return await self._send("GET", path, parameters, retry=retry, accept=accept)

    async def post(
        self, path: str, content: bytes, headers: Mapping[str, str], *, retry: bool, accept: tuple[int, ...] = ()
    ) -> DeviceReply:
        """Send a POST request. ``headers`` describe the content; the other arguments are those of ``get``."""
        return await self._send("POST", path, None, content=content, headers=headers, retry=retry, accept=accept)

    async def _send(
        self,
        method: str,
        path: str,
        parameters: Mapping[str, str] | None,
        *,
        retry: bool,
        accept: tuple[int, ...],
        content: bytes | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> DeviceReply:
        for pause_s in (*(BACKOFF_S if retry else ()), None):
            try:
                with connection_errors(self.address), anyio.fail_after(self._timeouts.connect_s + self._timeouts.reply_s):
                    async with self._client.stream(method, path, params=parameters, content=content, headers=headers) as response:
                        check_status(self.address, response, accept)
                        body = await _read(self.address, response)
                        return DeviceReply(response.status_code, _media_type(response), body)
            except CameraUnreachableError:
                if pause_s is None:
                    raise
                await anyio.sleep(pause_s)
        raise AssertionError("the last attempt returns or raises")

    @asynccontextmanager
    async def stream(
        self, path: str, parameters: Mapping[str, str] | None = None
    ) -> AsyncIterator[tuple[str, AsyncIterator[bytes]]]:
        """Return a context manager that provides the content type of an endless reply and its body as chunks of bytes."""
        with connection_errors(self.address):
            async with self._client.stream("GET", path, params=parameters) as response:
                check_status(self.address, response, ())
                yield response.headers.get("content-type", ""), response.aiter_raw()

    def send_blocking(self, path: str, queries: tuple[Mapping[str, str], ...], *, timeout_s: float = 2.0) -> None:
        """Send GET requests from a thread over a separate connection. This works even if the event loop is blocked.

        Raises:
            CameraError: A request failed. The device received the requests before it.
        """
        with connection_errors(self.address), self._blocking_client(timeout_s) as client:
            for query in queries:
                check_status(self.address, client.get(path, params=query), ())

    def post_blocking(self, path: str, content: bytes, headers: Mapping[str, str], *, timeout_s: float = 2.0) -> None:
        """Send a POST request from a thread over a separate connection.

        Raises:
            CameraError: The request failed.
        """
        with connection_errors(self.address), self._blocking_client(timeout_s) as client:
            check_status(self.address, client.post(path, content=content, headers=dict(headers)), ())

    def _blocking_client(self, timeout_s: float) -> httpx2.Client:
        # The sign-in object counts its requests and is not thread-safe, so this client gets its own.
        return httpx2.Client(
            base_url=self.address.base_url, auth=PinnedSignIn(self.address, self.credentials), timeout=timeout_s,
            cookies=self._client.cookies, follow_redirects=False, trust_env=False, verify=self._verify,
        )  # fmt: skip

    async def close(self) -> None:
        """Close all connections."""
        await self._client.aclose()


@contextmanager
def connection_errors(address: DeviceAddress) -> Iterator[None]:
    """Return a context manager that converts transport errors to camera errors.

    The original error is dropped, because it holds the request's headers, and its text may contain a URL with credentials.
    """
    try:
        yield
    except (httpx2.TimeoutException, TimeoutError) as error:
        if isinstance(error, httpx2.ConnectTimeout):
            failure: CameraError = CameraUnreachableError(_unreachable_message(address, "there was no response"))
        else:
            failure = CameraTimeoutError(
                f"The camera at {address} did not respond in time. It may be rebooting. Check the network, then try again."
            )
    except httpx2.ConnectError as error:
        text = str(error).lower()
        if "certificate" in text or "ssl" in text:
            failure = CameraUnreachableError(
                f"The TLS connection to {address} failed. Either the camera's certificate is not trusted, or the camera does not "
                "use TLS on this port. If the certificate is self-signed, set its fingerprint in scope.yaml."
            )
        else:
            failure = CameraUnreachableError(
                _unreachable_message(address, "the connection was refused or the host name is unknown")
            )
    except (httpx2.NetworkError, httpx2.RemoteProtocolError):
        failure = CameraUnreachableError(
            f"The connection to the camera at {address} was lost. It may be rebooting. Check the network, then try again."
        )
    except (httpx2.HTTPError, httpx2.InvalidURL, NotImplementedError, ValueError):
        failure = CameraReplyError(
            f"The camera at {address} sent an invalid HTTP response. Check that the port is that of its web interface."
        )
    else:
        return
    raise failure from None


def check_status(address: DeviceAddress, response: httpx2.Response, accept: tuple[int, ...]) -> None:
    """Raise the corresponding camera error if the status code is neither 2xx nor accepted."""
    status = response.status_code
    if response.is_success or status in accept:
        return
    if status == 401:
        raise CameraSignInError(f"The camera at {address} rejected the user name or the password. Check both, then try again.")
    if status == 403:
        raise CameraSignInError(
            f"The camera at {address} does not permit this account to do that. Moving the camera requires an operator account with "
            "PTZ control, and changing presets requires an administrator account."
        )
    if 300 <= status < 400:
        raise ForeignAddressError(_redirect_message(address, response))
    if status in (502, 503, 504):
        raise CameraUnreachableError(f"The camera at {address} is not ready (HTTP {status}). It may be starting up. Try again.")
    raise CameraReplyError(f"The camera at {address} returned HTTP {status}. Check that its model and firmware are supported.")


def _redirect_message(address: DeviceAddress, response: httpx2.Response) -> str:
    try:
        target = httpx2.URL(response.headers.get("location", ""))
        destination = f"{target.scheme}://{target.host}"[:80] if target.host else "another path"
    except (httpx2.InvalidURL, ValueError):
        destination = "an unreadable address"
    hint = " Add ?tls=on to the camera spec." if destination == f"https://{address.host}" else ""
    return f"The camera at {address} redirects to {destination}. The redirect was not followed, and no credentials were sent.{hint}"


async def _read(address: DeviceAddress, response: httpx2.Response) -> bytes:
    body = bytearray()
    async for chunk in response.aiter_bytes():
        body += chunk
        if len(body) > MAX_BODY_BYTES:
            raise CameraReplyError(f"The camera at {address} sent more than {MAX_BODY_BYTES // 2**20} MB. The reply was discarded.")
    return bytes(body)


def _media_type(response: httpx2.Response) -> str:
    return str(response.headers.get("content-type", "")).partition(";")[0].strip().lower()


def _unreachable_message(address: DeviceAddress, cause: str) -> str:
    return f"The camera at {address} cannot be reached: {cause}. Check the address and the cable, and check that the camera is on."
