"""Serve the operator console and the HTTP API from one server."""

from __future__ import annotations

from collections.abc import AsyncIterator, MutableMapping
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import streamlit as st
from starlette.applications import Starlette
from starlette.responses import Response
from starlette.routing import Mount
from starlette.staticfiles import StaticFiles
from streamlit import config

from scope_ptz.serve.http.app import API_PREFIX, api_application
from scope_ptz.serve.security.access import Access, AccessMiddleware
from scope_ptz.serve.security.sign_in import sign_in_route
from scope_ptz.serve.server import mcp_route, serve
from scope_ptz.serve.site.site import Site

FOLDER = Path(__file__).parent
ASSETS_PREFIX = "/console"  # path of the page's scripts and styles

PAGE_POLICY = "; ".join(
    (
        "default-src 'self'",
        "script-src 'self' blob: 'unsafe-inline' 'wasm-unsafe-eval'",  # Streamlit starts with an inline script
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' blob: data:",
        "font-src 'self' data:",
        "connect-src 'self'",
        "worker-src 'self' blob:",
        "object-src 'none'",
        "frame-ancestors 'none'",
        "base-uri 'none'",
        "form-action 'self'",
    )
)
"""The page's content security policy. The page neither loads from nor sends to other hosts."""

_SETTINGS: dict[str, Any] = {
    "browser.gatherUsageStats": False,
    "client.showErrorDetails": "none",
    "client.toolbarMode": "viewer",
    "server.fileWatcherType": "none",
    "server.headless": True,
}


@asynccontextmanager
async def serve_console(site: Site, access: Access, *, port: int = 8000) -> AsyncIterator[int]:
    """Serve the page, the API and MCP while the context is open, and yield the port.

    Call this at most once per process, because Streamlit supports only one page in a process.

    Args:
        site: The cameras, models and runs to serve. This function enters the site's context.
        access: The access rules, including the host on which to listen.
        port: The port; 0 for any free one.

    Raises:
        ConfigError: The port is in use or not permitted.
    """
    for name, value in _SETTINGS.items():
        config.set_option(name, value)
    assets = Mount(ASSETS_PREFIX, _Assets(directory=FOLDER / "page"))
    api = Mount(API_PREFIX, api_application(site, access))
    async with mcp_route(site, access) as mcp:
        page = st.App(FOLDER / "ui.py", routes=[sign_in_route(access), api, mcp, assets])
        guarded_page = AccessMiddleware(page, access, page_policy=PAGE_POLICY)
        async with page.lifespan()(Starlette()), serve(site, access, port=port, app=guarded_page) as bound_port:
            yield bound_port


class _Assets(StaticFiles):
    """Serves the page's scripts and styles. Each time the page is loaded, browsers check whether a file has changed."""

    async def get_response(self, path: str, scope: MutableMapping[str, Any]) -> Response:
        response = await super().get_response(path, scope)
        response.headers["Cache-Control"] = "no-cache"
        return response
