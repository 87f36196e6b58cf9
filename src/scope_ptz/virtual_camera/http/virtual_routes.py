"""Routes that real cameras do not have: faults, simulated reboots and ground truth. Only clients on this machine may use them."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from scope_ptz.errors import InputError
from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.device import REBOOT_S, VirtualDevice
from scope_ptz.virtual_camera.faults import Faults, validate_faults
from scope_ptz.virtual_camera.http.access import AccessControl, Handler, is_cross_origin, is_local
from scope_ptz.virtual_camera.http.vapix_routes import read_arguments, read_body
from scope_ptz.virtual_camera.truth import TOLERANCE_S, TruthLog, origin_fields
from scope_ptz.virtual_camera.vapix.replies import Client

MAX_WITHIN_S = 5.0
"""Maximum value of the argument ``within``: the tolerance in seconds between the requested time and that of an exposure."""


class VirtualRoutes:
    """A camera's routes below ``/virtual/``.

    Args:
        device: The camera.
        access: The access control, which authenticates clients.
        truth: The ground truth for frames; None for no route to it.
    """

    def __init__(self, device: VirtualDevice, access: AccessControl, truth: TruthLog | None) -> None:
        self._device, self._access, self._truth = device, access, truth

    def routes(self) -> list[Route]:
        """Return the routes."""
        routes = [
            Route("/virtual/faults", self._endpoint(self._faults), methods=["GET", "POST", "DELETE"]),
            Route("/virtual/reboot", self._endpoint(self._reboot), methods=["POST"]),
        ]
        if self._truth is not None:
            routes.append(Route("/virtual/truth", self._endpoint(self._origin, Role.VIEWER), methods=["GET"]))
        return routes

    def _endpoint(self, handler: Handler, role: Role = Role.ADMINISTRATOR) -> Callable[[Request], Awaitable[Response]]:
        guarded = self._access.for_role(role, handler)

        async def endpoint(request: Request) -> Response:
            if not is_local(request) or is_cross_origin(request):
                return JSONResponse({"error": "Only programs on the camera's own machine may use this URL."}, 403)
            return await guarded(request)

        return endpoint

    async def _faults(self, request: Request, _: Client) -> Response:
        if request.method == "POST":
            try:
                self._device.faults = apply_fault_changes(self._device.faults, await read_body(request))
            except InputError as problem:
                return JSONResponse({"error": str(problem)}, 400)
        elif request.method == "DELETE":
            self._device.faults = Faults()
        return JSONResponse(self._device.faults.model_dump(mode="json"))

    async def _reboot(self, request: Request, _: Client) -> Response:
        try:
            arguments = await read_arguments(request)
            down_s = arguments.number("down_s", 0, 600) if "down_s" in arguments else REBOOT_S
        except InputError as problem:
            return JSONResponse({"error": str(problem)}, 400)
        self._device.reboot(down_s)
        return JSONResponse({"down_s": down_s})

    async def _origin(self, request: Request, _: Client) -> Response:
        assert self._truth is not None  # noqa: S101 - otherwise, there is no such route
        try:
            arguments = await read_arguments(request)
            requested = {name: arguments.numbers(name, 1)[0] for name in ("time", "taken") if name in arguments}
            within_s = arguments.number("within", TOLERANCE_S, MAX_WITHIN_S) if "within" in arguments else TOLERANCE_S
        except InputError as problem:
            return JSONResponse({"error": str(problem)}, 400)
        match = self._truth.at(time_s=requested.get("time"), taken_s=requested.get("taken"), within_s=within_s)
        if match is None:
            return JSONResponse({"error": "No frame from that time is stored."}, 404)
        taken_s, origin = match
        hfov_deg = self._device.optics.hfov_deg(origin.pose.zoom)
        return JSONResponse({**origin_fields(origin), "hfov_deg": hfov_deg, "taken_s": taken_s})


def apply_fault_changes(faults: Faults, body: bytes) -> Faults:
    """Return the faults with the changes in a JSON object applied.

    Raises:
        InputError: The body is not a JSON object, or a fault is unknown or has an invalid value.
    """
    try:
        changes = json.loads(body)
    except (ValueError, RecursionError):
        changes = None
    if not isinstance(changes, dict):
        raise InputError('Expected a JSON object of faults, such as {"stall_s": 2}.')
    return validate_faults({**faults.model_dump(), **changes})
