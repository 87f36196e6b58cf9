"""The named cameras in ``scope.yaml``, and the rules that the file defines for them."""

from __future__ import annotations

from pathlib import Path

from scope_ptz.camera.base import Camera
from scope_ptz.errors import ConfigError
from scope_ptz.factory.cameras.site_file import CameraFile, NamedCamera, load_camera_file
from scope_ptz.settings import find_camera_file, load_settings


def named_cameras() -> dict[str, NamedCamera]:
    """Return the cameras in ``scope.yaml`` by name.

    Raises:
        ConfigError: The file cannot be read, or its content is invalid.
    """
    return dict(_read_camera_file()[0].cameras)


def audit_logs() -> list[Path]:
    """Return the paths of the audit logs in ``scope.yaml``, without duplicates. The files need not exist.

    Raises:
        ConfigError: The file cannot be read, or its content is invalid.
    """
    file, folder = _read_camera_file()
    return list(dict.fromkeys(folder / named.audit_log for named in file.cameras.values() if named.audit_log is not None))


def apply_rules(camera: Camera, name: str, *, actor: str) -> Camera:
    """Wrap a camera so that it follows the mounting, rules and audit log in its ``scope.yaml`` entry.

    Args:
        camera: The camera.
        name: The camera's name in ``scope.yaml``.
        actor: The name of the program or person that controls the camera, for the audit log.

    Raises:
        ConfigError: The rules exclude every pose within the device's limits, or the name is not in the file.
        OutputError: The audit log cannot be written to.
    """
    from scope_ptz.camera.guard.audit import AuditLog
    from scope_ptz.camera.guard.guarded_camera import GuardedCamera
    from scope_ptz.camera.guard.mounted_camera import MountedCamera
    from scope_ptz.camera.guard.rules import CameraRules, Mounting

    file, folder = _read_camera_file()
    named = file.cameras.get(name)
    if named is None:
        raise ConfigError(f"The camera '{name}' is not in scope.yaml. Add it to the file, or choose another camera.")
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


def _read_camera_file() -> tuple[CameraFile, Path]:
    path = find_camera_file(load_settings())
    return load_camera_file(path), Path() if path is None else path.parent
