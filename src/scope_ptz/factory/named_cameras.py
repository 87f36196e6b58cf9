"""Cameras that ``scope.yaml`` names: their specs, and the rules of their site around them."""

from __future__ import annotations

from pathlib import Path

from scope_ptz.camera.base import Camera
from scope_ptz.errors import ConfigError
from scope_ptz.factory.camera_file import CameraFile, NamedCamera, load_camera_file
from scope_ptz.settings import find_camera_file, load_settings


def named_cameras() -> dict[str, NamedCamera]:
    """Return the cameras of ``scope.yaml`` by name.

    Raises:
        ConfigError: The file cannot be read, or its content is wrong.
    """
    return dict(_file()[0].cameras)


def apply_rules(camera: Camera, name: str, *, actor: str) -> Camera:
    """Return a camera that keeps the rules of a named camera, upright, with its audit log.

    Args:
        camera: The camera of the name's spec.
        name: The name in ``scope.yaml``.
        actor: Who controls it, for the audit log.

    Raises:
        ConfigError: The rules leave nothing of the device's limits.
        OutputError: The audit log cannot be written.
    """
    from scope_ptz.camera.guard.audit import AuditLog
    from scope_ptz.camera.guard.guarded import GuardedCamera
    from scope_ptz.camera.guard.mounted import MountedCamera
    from scope_ptz.camera.guard.rules import CameraRules, Mounting

    file, folder = _file()
    named = file.cameras.get(name)
    if named is None:
        raise ConfigError(f"The camera '{name}' is no longer in scope.yaml.")
    if named.mounting != Mounting():
        camera = MountedCamera(camera, named.mounting)
    if named.rules == CameraRules() and named.audit_log is None:
        return camera
    audit = None if named.audit_log is None else AuditLog(folder / named.audit_log, name, actor)
    try:
        return GuardedCamera(camera, named.rules, audit)
    except BaseException:
        if audit is not None:
            audit.close()
        raise


def _file() -> tuple[CameraFile, Path]:
    path = find_camera_file(load_settings())
    return load_camera_file(path), Path() if path is None else path.parent
