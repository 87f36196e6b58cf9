"""The URIs of resources. They contain names and ids, never file paths on the server."""

from __future__ import annotations

from urllib.parse import quote

SCHEME = "scope"


def camera_uri(camera: str, part: str = "") -> str:
    """Return the URI of a camera, or of one of its parts such as ``presets``."""
    return f"{SCHEME}://cameras/{quote(camera, safe='')}{f'/{part}' if part else ''}"


def scene_uri(scene: str) -> str:
    """Return the URI of a scene."""
    return f"{SCHEME}://scenes/{quote(scene, safe='')}"


def run_uri(run: str) -> str:
    """Return the URI of a run."""
    return f"{SCHEME}://runs/{quote(run, safe='')}"


def picture_uri(run: str, name: str) -> str:
    """Return the URI of a picture from a run, given its name in the run folder, such as ``frames/001-view.jpg``."""
    return f"{run_uri(run)}/{quote(name)}"
