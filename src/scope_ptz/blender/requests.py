"""Convert projections to parameters for worker requests."""

from __future__ import annotations

from typing import Any

from scope_ptz.geometry import Equirectangular, Perspective


def perspective_request(view: Perspective) -> dict[str, Any]:
    """Return the request parameters for a perspective view."""
    return {
        "kind": "perspective",
        "pan_deg": view.pan_deg,
        "tilt_deg": view.tilt_deg,
        "hfov_deg": view.hfov_deg,
        "width": view.width,
        "height": view.height,
    }


def panorama_request(view: Equirectangular) -> dict[str, Any]:
    """Return the request parameters for a band of the sphere. The worker renders all pans, from -180 to 180 degrees."""
    return {
        "kind": "equirectangular",
        "top_tilt_deg": view.top_tilt_deg,
        "bottom_tilt_deg": view.bottom_tilt_deg,
        "width": view.width,
        "height": view.height,
    }
