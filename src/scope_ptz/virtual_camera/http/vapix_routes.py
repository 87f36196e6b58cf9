"""HTTP routes for VAPIX."""

from __future__ import annotations

from collections.abc import Callable
from urllib.parse import parse_qsl

import anyio
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from scope_ptz.errors import InputError
from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.device import REBOOT_DELAY_S, REBOOT_S
from scope_ptz.virtual_camera.http.access import AccessControl, Handler, is_local
from scope_ptz.virtual_camera.http.jpeg import SharedJpegs, picture_format, with_comment
from scope_ptz.virtual_camera.http.streams import MotionJpeg, StreamOptions
from scope_ptz.virtual_camera.http.truth_headers import TruthHeaders
from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.vapix.arguments import Arguments, check_camera
from scope_ptz.virtual_camera.vapix.json_apis import api_discovery, basic_device_info
from scope_ptz.virtual_camera.vapix.parameters import param
from scope_ptz.virtual_camera.vapix.ptz import ptz, ptz_config, ptz_queue
from scope_ptz.virtual_camera.vapix.replies import Client, Reply
from scope_ptz.virtual_camera.vapix.vapix_camera import VapixCamera

MAX_BODY_BYTES = 64 * 1024  # maximum size of a request body
MAX_ARGUMENTS = 200  # maximum number of arguments in the query and in the body, each

METHODS = ["GET", "POST"]

# The user groups that ``usergroup.cgi`` reports for each role.
USER_GROUPS = {Role.VIEWER: "viewer", Role.OPERATOR: "operator viewer ptz", Role.ADMINISTRATOR: "admin operator viewer ptz"}


class VapixRoutes:
    """A camera's routes below ``/axis-cgi/``.

    Args:
        camera: The camera's VAPIX state.
        source: The camera's live video.
        access: The access control, which authenticates clients.
        truth: Builds the ground truth that is sent with pictures to clients on this machine; None to send none.
        closing: An event that is set when the server shuts down.
    """

    def __init__(
        self, camera: VapixCamera, source: LiveSource, access: AccessControl, truth: TruthHeaders | None, closing: anyio.Event
    ) -> None:
        self._camera, self._source, self._access, self._truth, self._closing = camera, source, access, truth, closing
        self.jpegs = SharedJpegs(camera.device)

    def routes(self) -> list[Route]:
        """Return the routes."""
        camera = self._camera
        pages: list[tuple[str, Role, Handler]] = [
            ("com/ptz.cgi", Role.OPERATOR, _page(lambda arguments, client: ptz(camera, arguments, client))),
            ("com/ptzconfig.cgi", Role.ADMINISTRATOR, _page(lambda arguments, _: ptz_config(camera, arguments))),
            ("com/ptzqueue.cgi", Role.OPERATOR, _page(lambda arguments, client: ptz_queue(camera, arguments, client))),
            ("param.cgi", Role.VIEWER, _page(lambda arguments, client: param(camera, arguments, client))),
            ("usergroup.cgi", Role.VIEWER, _user_group),
            ("restart.cgi", Role.ADMINISTRATOR, self._restart),
            ("apidiscovery.cgi", Role.VIEWER, _json(camera, api_discovery)),
            ("basicdeviceinfo.cgi", Role.VIEWER, _json(camera, basic_device_info)),
            ("jpg/image.cgi", Role.VIEWER, self._image),
            ("mjpg/video.cgi", Role.VIEWER, self._video),
        ]
        return [Route(f"/axis-cgi/{path}", self._access.for_role(role, page), methods=METHODS) for path, role, page in pages]

    async def _restart(self, _: Request, __: Client) -> Response:
        self._camera.device.reboot(REBOOT_S, after_s=REBOOT_DELAY_S)
        return PlainTextResponse("Restarting.\n")

    async def _image(self, request: Request, _: Client) -> Response:
        arguments = await read_arguments(request)
        try:
            check_camera(arguments)
            requested = picture_format(self._camera.device, arguments.text("resolution"), arguments.text("compression"))
        except InputError as problem:
            return PlainTextResponse(f"Error: {problem}\n", 400)
        exposure, jpeg = await self.jpegs.snapshot(requested)
        headers = {"Cache-Control": "no-cache"}
        if self._truth is not None and is_local(request):
            extra, comment = self._truth.of(exposure)
            headers.update(extra)
            jpeg = with_comment(jpeg, comment)
        return Response(jpeg, media_type="image/jpeg", headers=headers)

    async def _video(self, request: Request, _: Client) -> Response:
        arguments = await read_arguments(request)
        try:
            check_camera(arguments)
            picture = picture_format(self._camera.device, arguments.text("resolution"), arguments.text("compression"))
            limits = {name: arguments.number(name, 0, 1e6) for name in ("fps", "nbrofframes", "duration") if name in arguments}
        except InputError as problem:
            return PlainTextResponse(f"Error: {problem}\n", 400)
        options = StreamOptions(
            picture,
            fps=limits.get("fps", 0.0),
            frames=int(limits.get("nbrofframes", 0)),
            duration_s=limits.get("duration", 0.0),
            truth=self._truth.of if self._truth is not None and is_local(request) else None,
        )
        return MotionJpeg(self._source, self.jpegs, options, self._closing)


async def read_body(request: Request) -> bytes:
    """Read the body of a request.

    Raises:
        HTTPException: The body is too large, or the client disconnected.
    """
    content = bytearray()
    try:
        async for chunk in request.stream():
            content += chunk
            if len(content) > MAX_BODY_BYTES:
                raise HTTPException(413)
    except ClientDisconnect as error:
        raise HTTPException(400) from error
    return bytes(content)


async def read_arguments(request: Request) -> Arguments:
    """Read the arguments of a request from the query and the body.

    The body is parsed as a form regardless of its media type. If a name is repeated, its first value is used.

    Raises:
        HTTPException: The body is too large, there are too many arguments, or the client disconnected.
    """
    query = request.scope["query_string"].decode("latin-1")
    body = (await read_body(request)).decode("utf-8", "replace").strip()
    try:
        pairs = [pair for text in (query, body) for pair in parse_qsl(text, keep_blank_values=True, max_num_fields=MAX_ARGUMENTS)]
    except ValueError as error:
        raise HTTPException(400) from error
    return Arguments(dict(reversed(pairs)))


def _page(answer: Callable[[Arguments, Client], Reply]) -> Handler:
    async def page(request: Request, client: Client) -> Response:
        return _response(answer(await read_arguments(request), client))

    return page


def _json(camera: VapixCamera, answer: Callable[[VapixCamera, str, bytes], Reply]) -> Handler:
    async def page(request: Request, _: Client) -> Response:
        return _response(answer(camera, request.method, await read_body(request)))

    return page


async def _user_group(_: Request, client: Client) -> Response:
    return PlainTextResponse(f"{client.name}\n{USER_GROUPS[client.role]}\n")


def _response(reply: Reply) -> Response:
    return Response(reply.body, reply.status, media_type=reply.content_type)
