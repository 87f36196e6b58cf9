"""Determine a camera's kind from its spec, without opening the camera."""

from __future__ import annotations

from typing import Literal, get_args

from scope_ptz.builtin_names import BLENDER_WINDOW
from scope_ptz.camera.guard.rules import CameraRules, Mounting
from scope_ptz.factory.cameras import parse_camera
from scope_ptz.factory.cameras.named_cameras import named_cameras

CameraKind = Literal["simulated", "blender", "axis", "onvif", "plug_in"]

_KIND_BY_SCHEME = {"sim": "simulated", BLENDER_WINDOW: "blender"}


def kind_of(spec: str) -> CameraKind:
    """Return a camera's kind.

    Raises:
        InputError: The spec is invalid, or the camera is no longer in ``scope.yaml``.
    """
    scheme = parse_camera(spec).scheme
    name = _KIND_BY_SCHEME.get(scheme, scheme)
    return next((kind for kind in get_args(CameraKind) if kind == name), "plug_in")


def has_scene_time(spec: str) -> bool:
    """Return whether a camera shows a simulated world, in which time can be paused and changed."""
    return parse_camera(spec).scheme in ("sim", "blender")


def is_blender_window(spec: str) -> bool:
    """Return whether a camera is a Blender window's open scene, which an add-on connects to the server."""
    return parse_camera(spec).scheme == BLENDER_WINDOW


def scene_of(spec: str) -> str | None:
    """Return the name of the stored scene that a simulated camera shows; None for other cameras."""
    parsed = parse_camera(spec)
    return parsed.address if parsed.scheme == "sim" else None


def has_rules(spec: str) -> bool:
    """Return whether ``scope.yaml`` defines a mounting or rules for a camera, which change its pictures or restrict its poses."""
    name = parse_camera(spec).name
    if not name:
        return False
    configured = named_cameras()[name]
    return configured.mounting != Mounting() or configured.rules != CameraRules()
