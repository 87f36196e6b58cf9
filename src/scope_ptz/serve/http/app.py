"""The HTTP API's ASGI application, to be served alone or together with the console."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI
from fastapi.routing import APIRoute
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import BaseRoute, Mount, Route
from starlette.types import ASGIApp

from scope_ptz.serve.http import (
    add_on_routes,
    benchmark_routes,
    camera_routes,
    card_routes,
    conversation_routes,
    library_routes,
    live_routes,
    move_routes,
    run_routes,
    session_routes,
    simulation_routes,
    tool_routes,
)
from scope_ptz.serve.http.errors import add_error_handlers, http_error
from scope_ptz.serve.security.access import Access, AccessMiddleware
from scope_ptz.serve.security.sign_in import sign_in_route
from scope_ptz.serve.site.site import Site
from scope_ptz.version import __version__

API_PREFIX = "/api"
VERSION_PREFIX = "/v1"

_ROUTE_MODULES = (
    session_routes,
    camera_routes,
    card_routes,
    simulation_routes,
    move_routes,
    tool_routes,
    live_routes,
    library_routes,
    run_routes,
    conversation_routes,
    benchmark_routes,
    add_on_routes,
)


def api_application(site: Site, access: Access) -> FastAPI:
    """Return the API, to be mounted at ``/api`` behind an ``AccessMiddleware``.

    The caller must enter the context of ``site``; the application has no separate ASGI lifespan. Its schema is at
    ``/api/v1/openapi.json``. FastAPI's documentation pages are disabled, because they load scripts from other hosts.
    """
    app = FastAPI(
        title="SCOPE",
        version=__version__,
        summary="Talk to pan-tilt-zoom cameras in plain language.",
        openapi_url=f"{VERSION_PREFIX}/openapi.json",
        docs_url=None,
        redoc_url=None,
        generate_unique_id_function=_operation_id,
        servers=[{"url": API_PREFIX}],
        root_path_in_servers=False,
        redirect_slashes=False,
    )
    app.state.site, app.state.access = site, access
    for module in _ROUTE_MODULES:
        app.include_router(module.router, prefix=VERSION_PREFIX)
    add_error_handlers(app)
    if access.needs_token:
        _document_tokens(app)
    return app


def application(site: Site, access: Access, *routes: BaseRoute) -> ASGIApp:
    """Return the API behind its access checks, for a server without the console.

    ``routes`` are additional routes, such as the MCP route.
    """

    async def root(_: Request) -> Response:
        return PlainTextResponse(f"SCOPE {__version__}. The API is at {API_PREFIX}{VERSION_PREFIX}.\n")

    api = Mount(API_PREFIX, api_application(site, access))
    return AccessMiddleware(
        Starlette(routes=[Route("/", root), sign_in_route(access), api, *routes], exception_handlers={HTTPException: http_error}),
        access,
    )


def _operation_id(route: APIRoute) -> str:
    return route.name


def _document_tokens(app: FastAPI) -> None:
    """Document in the schema that all operations but sign-in and the health check need a token."""
    build_schema = app.openapi

    def openapi() -> dict[str, Any]:
        document = build_schema()
        schemes = document.setdefault("components", {}).setdefault("securitySchemes", {})
        if not schemes:
            schemes["token"] = {"type": "http", "scheme": "bearer"}
            document["security"] = [{"token": []}]
            for path in ("health", "session"):
                for operation in document["paths"][f"{VERSION_PREFIX}/{path}"].values():
                    operation["security"] = []
        return document

    app.openapi = openapi  # type: ignore[method-assign]
