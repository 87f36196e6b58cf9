"""A client for a device's ONVIF services, based on ``onvif-zeep-async`` and a transport that connects to no other device."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import anyio

from scope_ptz.camera.network.errors import CameraReplyError, CameraSignInError, CameraUnreachableError
from scope_ptz.camera.network.http import BACKOFF_S
from scope_ptz.camera.onvif.faults import soap_errors
from scope_ptz.camera.onvif.transport import PinnedTransport, import_onvif, pinned_path, to_bytes, unchanged_proxies

if TYPE_CHECKING:
    from scope_ptz.camera.network.address import DeviceAddress
    from scope_ptz.camera.network.credentials import Credentials
    from scope_ptz.camera.network.http import DeviceHttp

NOT_RETRIED = ("ContinuousMove", "RelativeMove", "SetPreset", "RemovePreset")
"""Operations that are not idempotent, and are therefore not retried after a lost connection."""

_STOP_HEADERS = {"Content-Type": "application/soap+xml; charset=utf-8"}


class OnvifClient:
    """The connection to a device. Call ``connect`` first.

    Args:
        http: The HTTP connection to the device. Closing the client closes it too.
        credentials: The credentials for signing in.

    Raises:
        ConfigError: ``onvif-zeep-async`` is not installed.
    """

    def __init__(self, http: DeviceHttp, credentials: Credentials) -> None:
        self.http = http
        self._library = import_onvif()
        self._credentials = credentials
        self._camera: Any = None
        self._stop_service: Any = None
        self._stop_profile, self._signed_in = "", False

    def __repr__(self) -> str:
        return f"OnvifClient({self.address})"

    @property
    def address(self) -> DeviceAddress:
        return self.http.address

    async def connect(self) -> None:
        """Read the device's clock and the addresses of its services. Calling this again rereads them.

        Raises:
            CameraError: The device cannot be reached, rejects the credentials, or has no ONVIF services.
        """
        for adjust_time in (True, False):
            camera = self._make_camera(adjust_time)
            try:
                await _retry(partial(self._read_addresses, camera))
            except BaseException as error:
                with anyio.CancelScope(shield=True):
                    await _close(camera)
                if isinstance(error, CameraReplyError) and adjust_time:
                    continue  # the device's clock cannot be read, so assume that it is correct
                raise
            await self._close_services()
            self._camera = camera
            if self._stop_service is not None:
                await self.prepare_stop(self._stop_profile)
            return

    async def call(self, service: str, operation: str, **arguments: Any) -> Any:
        """Call an operation and return its reply.

        Idempotent operations are retried after a lost connection. If authentication fails after it has worked before, the device's
        clock is read again and the operation is retried.

        Args:
            service: ``devicemgmt``, ``media``, ``ptz`` or ``imaging``.
            operation: Name of the operation.
            arguments: Its arguments.

        Raises:
            CameraError: One of the errors in ``camera.network.errors`` or ``camera.onvif.faults``.
        """
        call_once = partial(self._authenticated_call, service, operation, arguments)
        return await (call_once() if operation in NOT_RETRIED else _retry(call_once))

    async def prepare_stop(self, profile: str) -> None:
        """Create the service that ``stop_blocking`` uses."""
        self._stop_profile = profile
        self._stop_service = await self.make_service("ptz")

    def stop_blocking(self) -> None:
        """Stop pan, tilt and zoom from a thread over a separate connection.

        Raises:
            CameraError: The stop command did not reach the device, or the device refused it.
        """
        service = self._stop_service  # a separate service, because those used in the event loop are not thread-safe
        with soap_errors(self.address, "Stop"):
            message = service.zeep_client.create_message(
                service.ws_client, "Stop", ProfileToken=self._stop_profile, PanTilt=True, Zoom=True
            )
            content = to_bytes(message)
        self.http.post_blocking(pinned_path(self.http, service.xaddr), content, _STOP_HEADERS)

    async def close(self) -> None:
        """Close all connections."""
        await self._close_services()
        await self.http.close()

    async def _read_addresses(self, camera: Any) -> None:
        with soap_errors(self.address, "GetServices"):
            await camera.update_xaddrs()

    async def _authenticated_call(self, service: str, operation: str, arguments: dict[str, Any]) -> Any:
        try:
            reply = await self._call(service, operation, arguments)
        except CameraSignInError:
            if not self._signed_in:
                raise
            self._signed_in = False
            await self.connect()  # the device's clock may have changed, for example after a reboot
            reply = await self._call(service, operation, arguments)
        self._signed_in = True
        return reply

    async def _call(self, service: str, operation: str, arguments: dict[str, Any]) -> Any:
        with soap_errors(self.address, operation):
            return await getattr(await self._camera.create_onvif_service(service), operation)(arguments)

    def _make_camera(self, adjust_time: bool) -> Any:
        address, account = self.address, self._credentials
        scheme = "https" if address.tls else "http"
        with unchanged_proxies():
            camera = self._library.ONVIFCamera(
                f"{scheme}://{address.host}", address.port, account.user, account.password, no_cache=True, adjust_time=adjust_time
            )
        # The library's own services use transports that follow redirects to any host.
        camera.create_onvif_service = partial(_cached_service, self, camera)
        return camera

    async def make_service(self, name: str, camera: Any = None) -> Any:
        """Return a new service that uses ``PinnedTransport``."""
        camera = camera or self._camera
        with soap_errors(self.address, f"the {name} service"):
            xaddr, wsdl, binding = camera.get_definition(name)
            service = self._library.ONVIFService(
                self.address.pin_http(xaddr), camera.user, camera.passwd, wsdl, no_cache=True, dt_diff=camera.dt_diff,
                binding_name=binding, binding_key=(name, None),
            )  # fmt: skip
            await service.close()  # closes its default transport
            service.transport = PinnedTransport(self.http)
            await service.setup()
        return service

    async def _close_services(self) -> None:
        if self._camera is not None:
            camera, self._camera = self._camera, None
            await _close(camera)


async def _retry(call: Callable[[], Awaitable[Any]]) -> Any:
    """Call a function, and retry it after a lost connection. Each call must send a new message with a new authentication header."""
    for pause_s in BACKOFF_S:
        try:
            return await call()
        except CameraUnreachableError:
            await anyio.sleep(pause_s)
    return await call()


async def _close(camera: Any) -> None:
    camera.services.clear()  # closing this client closes their transports
    await camera.close()


async def _cached_service(client: OnvifClient, camera: Any, name: str, *_: Any, **__: Any) -> Any:
    """Return a service, creating it on the first call."""
    key = (name.lower(), None)
    if key not in camera.services:
        camera.services[key] = await client.make_service(key[0], camera)
    return camera.services[key]


def stop_device(http: DeviceHttp, details: Mapping[str, Any]) -> None:
    """Stop all motion of a device from a process that is not connected to it yet. This call blocks.

    Args:
        http: The HTTP connection to the device.
        details: The token of the PTZ profile, under the key ``profile``.

    Raises:
        CameraError: The stop command did not reach the device.
    """

    async def connect() -> OnvifClient:
        client = OnvifClient(http, http.credentials)
        await client.connect()
        await client.prepare_stop(details["profile"])
        return client

    anyio.run(connect).stop_blocking()
