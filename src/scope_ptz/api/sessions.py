"""Create a session with a local camera or a camera on a server."""

from __future__ import annotations

from scope_ptz.api.async_scope import AsyncScope
from scope_ptz.api.options import SessionOptions


def new_session(options: SessionOptions) -> AsyncScope:
    """Create a session that is not open yet. A camera spec that begins with http:// or https:// names a camera on a server."""
    if isinstance(options.camera, str) and options.camera.strip().lower().startswith(("http://", "https://")):
        from scope_ptz.api.remote.session import RemoteSession

        return RemoteSession(options)
    return AsyncScope(options)
