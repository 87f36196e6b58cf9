"""The web application for a virtual camera."""

from __future__ import annotations

from html import escape

import anyio
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import BaseRoute, Mount, Route
from starlette.types import ASGIApp

from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.http.access import AccessControl
from scope_ptz.virtual_camera.http.faults import FaultMiddleware
from scope_ptz.virtual_camera.http.truth_headers import TruthHeaders
from scope_ptz.virtual_camera.http.vapix_routes import VapixRoutes
from scope_ptz.virtual_camera.http.virtual_routes import VirtualRoutes
from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.truth import TruthLog
from scope_ptz.virtual_camera.vapix.replies import Client
from scope_ptz.virtual_camera.vapix.vapix_camera import VapixCamera

# A camera's home page.
PAGE = """<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>{name}</title>
<h1>{name}</h1><img src="/axis-cgi/mjpg/video.cgi" alt="Live video" style="max-width:100%">"""


class CameraApplication:
    """The web application for a camera.

    Args:
        camera: The camera's VAPIX state.
        source: The camera's live video.
        truth: The ground truth for its frames; None to withhold it from clients.
        onvif: An application for the paths below ``/onvif/``, which authenticates its own clients; None for no ONVIF services.

    Attributes:
        app: The ASGI application.
        closing: An event that is set when the server shuts down, which ends all streams.
        jpegs: The JPEG encoder, which all clients share.
    """

    def __init__(self, camera: VapixCamera, source: LiveSource, truth: TruthLog | None, onvif: ASGIApp | None) -> None:
        self.closing = anyio.Event()
        device = camera.device
        access = AccessControl(device.accounts, camera.realm)
        vapix = VapixRoutes(camera, source, access, TruthHeaders(truth) if truth is not None else None, self.closing)
        self.jpegs = vapix.jpegs

        async def page(_: Request, __: Client) -> Response:
            return HTMLResponse(PAGE.format(name=escape(device.name)))

        routes: list[BaseRoute] = [
            Route("/", access.for_role(Role.VIEWER, page)),
            *vapix.routes(),
            *VirtualRoutes(device, access, truth).routes(),
        ]
        if onvif is not None:
            routes.append(Mount("/onvif", onvif))
        faults = Middleware(FaultMiddleware, device=device, access=access, closing=self.closing)
        self.app = Starlette(routes=routes, middleware=[faults])

    def close(self) -> None:
        """End all streams."""
        self.closing.set()
