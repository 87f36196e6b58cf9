"""Live Blender cameras. A worker process opens a scene or a .blend file and renders each frame."""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from anyio import CancelScope, to_thread

from scope_ptz.blender.bake import scene_file
from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.environment import is_ready, worker_command
from scope_ptz.blender.file_cameras import FileCameras, file_cameras
from scope_ptz.camera.blender import BlenderCamera
from scope_ptz.camera.spec import CameraSpec
from scope_ptz.errors import PackError, UnknownNameError
from scope_ptz.factory.scenes import open_scene
from scope_ptz.settings import load_settings
from scope_ptz.simulator.clock import SceneClock

if TYPE_CHECKING:
    from scope_ptz.simulator.models import SceneFile
    from scope_ptz.simulator.pack import Scene

_LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class LiveBlender:
    """A live Blender camera and its worker process.

    Attributes:
        camera: The camera.
        scene: The scene whose packs contain the ground truth for the camera's frames; None if there is none.
        release: A function that closes the worker process.
    """

    camera: BlenderCamera
    scene: Scene | None
    release: Callable[[], Awaitable[None]]


async def open_live_blender(spec: CameraSpec, *, viewpoint: str | None, time_s: float | None, realtime: bool) -> LiveBlender:
    """Start Blender and open a scene, given by name, by its Python file, or by a .blend file.

    On first use, this installs Blender's Python module (about 400 MB) and logs a warning.

    Raises:
        UnknownNameError: There is no such viewpoint.
        BlenderError: Blender cannot be started, or cannot open the scene or the file.
    """
    settings = load_settings()
    program = settings.blender_python or settings.blender
    if program is None and not is_ready(settings.cache_dir):
        _LOG.warning("note: installing Blender's Python module (about 400 MB). This happens only once.")
    command = await to_thread.run_sync(worker_command, settings.cache_dir, program)
    logs = tempfile.TemporaryDirectory(prefix="scope-blender-", ignore_cleanup_errors=True)
    worker = BlenderWorker(command, Path(logs.name) / "blender.log")

    async def release() -> None:
        with CancelScope(shield=True):
            await to_thread.run_sync(worker.close)
            logs.cleanup()

    try:
        await to_thread.run_sync(worker.start)
        clock = SceneClock(0.0 if time_s is None else time_s, realtime=realtime)
        size: dict[str, Any] = {name: int(value) for name, value in spec.options.items()}
        if spec.address.lower().endswith(".blend"):
            cameras = await _open_file(worker, spec.address)
            camera = BlenderCamera(
                worker, cameras.scene, viewpoint=viewpoint, clock=clock, optics=cameras.optics, limits=cameras.limits,
                has_truth=False, **size,
            )  # fmt: skip
            return LiveBlender(camera, None, release)
        file = await _build_scene(worker, spec.address)
        if time_s is None:
            clock = SceneClock(file.start_s, realtime=realtime)
        camera = BlenderCamera(worker, file, viewpoint=viewpoint, clock=clock, **size)
        return LiveBlender(camera, _stored_scene(file), release)
    except BaseException:
        await release()
        raise


async def _open_file(worker: BlenderWorker, path: str) -> FileCameras:
    description = await to_thread.run_sync(worker.request, "open_file", {"path": _absolute(path)})
    return file_cameras(description)


async def _build_scene(worker: BlenderWorker, source: str) -> SceneFile:
    if source.endswith(".py"):
        source = _absolute(source)
    await to_thread.run_sync(worker.request, "load_scene", {"source": source})
    return scene_file(await to_thread.run_sync(worker.request, "describe"), "live")


def _absolute(path: str) -> str:
    """Return an absolute path, because the worker may have a different working directory."""
    return str(Path(path).absolute())


def _stored_scene(live: SceneFile) -> Scene | None:
    """Return the stored scene with the ground truth for a live scene; None if none has the same objects and actors."""
    try:
        scene = open_scene(live.name)
    except (UnknownNameError, PackError):
        return None
    return scene if _numbered_ids(scene.file) == _numbered_ids(live) else None


def _numbered_ids(file: SceneFile) -> set[tuple[str, int]]:
    """Return the id and number of each object and actor in a scene."""
    return {(i.id, i.number) for i in file.instances} | {(a.id, a.number) for a in file.actors}
