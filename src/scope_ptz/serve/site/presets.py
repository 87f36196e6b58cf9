"""A camera's presets, with thumbnails and renaming, which cameras themselves do not support."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from anyio import to_thread

from scope_ptz.camera.base import Arrival, Camera, Frame, PresetInfo
from scope_ptz.camera.guard.mounted_camera import MountedCamera
from scope_ptz.camera.guard.wrapper import innermost, layers
from scope_ptz.camera.scene_presets import preset_pose
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.factory.scenes import open_scene
from scope_ptz.serve.site.camera_kinds import has_rules, scene_of
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.errors import RefusedByCameraError
from scope_ptz.serve.site.live_picture import encode_jpeg
from scope_ptz.serve.site.station import CameraPosition, Station
from scope_ptz.simulator.pack import Scene

THUMBNAIL_WIDTH = 320  # in pixels


@dataclass(frozen=True, slots=True)
class KnownPreset:
    """A preset, its position (if the camera reports it or has visited it), and whether it has a thumbnail."""

    preset: PresetInfo
    position: CameraPosition | None
    has_picture: bool


class Presets:
    """One camera's presets.

    A thumbnail is taken when a preset is saved or visited, and is stored in a folder. Missing thumbnails for a scene's presets are
    rendered.

    Args:
        station: The camera.
        folder: The folder for the thumbnails of all cameras.
    """

    def __init__(self, station: Station, folder: Path) -> None:
        self._station, self._folder = station, folder / station.name

    async def all(self) -> list[KnownPreset]:
        """Return the presets in the camera's order, with their positions and whether they have thumbnails."""
        camera = await self._station.camera()
        scene = (await self._station.get_open_camera()).scene
        rendered = set() if scene is None or has_rules(self._station.spec) else {preset.name for preset in scene.file.presets}
        return [
            KnownPreset(
                preset,
                _position_in_scene(camera, preset.name) or self._station.visited.get(preset.name),
                preset.name in rendered or self._path(preset.name).is_file(),
            )
            for preset in await camera.presets()
        ]

    async def go_to(self, client: Client, name: str) -> Arrival:
        """Go to a preset.

        Raises:
            UnknownNameError: There is no such preset.
        """
        async with self._station.command(client) as camera:
            await self._check(camera, name)
            arrival = await camera.go_to_preset(name)
            await self._visit(name)
            await self._store(name, await camera.frame())
        return arrival

    async def save(self, client: Client, name: str, description: str = "") -> PresetInfo:
        """Save the current view as a preset. An existing preset with the same name is replaced.

        Raises:
            RefusedByCameraError: The camera cannot save this preset.
        """
        camera = await self._station.require_control(client)
        with _translate_refusals():
            saved = await camera.save_preset(name, description)
        await self._visit(name)
        await self._store(name, await camera.frame())
        self._station.preset_changes += 1
        return saved

    async def rename(self, client: Client, name: str, new_name: str) -> PresetInfo:
        """Rename a preset. The camera goes to the preset and back, because only the device knows the preset's position.

        Raises:
            UnknownNameError: There is no such preset.
            InputError: The new name is in use or not permitted.
            RefusedByCameraError: The camera cannot save or remove this preset.
        """
        async with self._station.command(client) as camera:
            presets = {preset.name: preset for preset in await camera.presets()}
            if name not in presets:
                raise UnknownNameError("preset", name[:60], presets)
            if new_name in presets:
                raise InputError(f"A preset named '{new_name[:60]}' already exists. Choose another name.")
            position_before = await self._station.position()
            await camera.go_to_preset(name)
            frame = await camera.frame()
            await self._visit(new_name)
            try:
                with _translate_refusals():
                    saved = await camera.save_preset(new_name, presets[name].description)
                    try:
                        await camera.remove_preset(name)
                    except CameraError:
                        await camera.remove_preset(new_name)
                        raise
            finally:
                await self._station.return_to(camera, position_before)
            await self._store(new_name, frame)
            self._forget(name)
        self._station.preset_changes += 1
        return saved

    async def remove(self, client: Client, name: str) -> None:
        """Remove a preset.

        Raises:
            UnknownNameError: There is no such preset.
            RefusedByCameraError: The camera cannot remove it.
        """
        camera = await self._station.require_control(client)
        await self._check(camera, name)
        with _translate_refusals():
            await camera.remove_preset(name)
        self._forget(name)
        self._station.preset_changes += 1

    async def thumbnail(self, name: str) -> bytes:
        """Return a small JPEG of a preset's view.

        Raises:
            UnknownNameError: There is no such preset, or it has no thumbnail yet.
        """
        camera = await self._station.camera()
        await self._check(camera, name)
        path = self._path(name)
        if path.is_file():
            return await to_thread.run_sync(path.read_bytes)
        scene = (await self._station.get_open_camera()).scene
        if scene is None or name not in {preset.name for preset in scene.file.presets} or has_rules(self._station.spec):
            raise UnknownNameError("preset picture", name[:60], ())
        return await self._render(scene, name)

    async def home_picture(self) -> bytes:
        """Return a small JPEG of a scene's home view, without opening the camera.

        Raises:
            UnknownNameError: The camera shows no stored scene, or its rules change its pictures.
        """
        name = scene_of(self._station.spec)
        if name is None or has_rules(self._station.spec):
            raise UnknownNameError("camera picture", self._station.name, ())
        scene = await to_thread.run_sync(partial(open_scene, name, cache_pictures=True))
        path = self._path(scene.file.home_preset)
        if path.is_file():
            return await to_thread.run_sync(path.read_bytes)
        return await self._render(scene, scene.file.home_preset)

    async def _render(self, scene: Scene, name: str) -> bytes:
        renderer = SimulatedCamera(scene, width=2 * THUMBNAIL_WIDTH, height=2 * THUMBNAIL_WIDTH * 9 // 16)
        await renderer.go_to_preset(name)
        return await self._store(name, await renderer.frame())

    async def _visit(self, name: str) -> None:
        self._station.visited[name] = await self._station.position()

    async def _check(self, camera: Camera, name: str) -> None:
        names = [preset.name for preset in await camera.presets()]
        if name not in names:
            raise UnknownNameError("preset", name[:60], names)

    def _path(self, name: str) -> Path:
        # Preset names are untrusted input, so only their hashes become part of a path.
        return self._folder / f"{hashlib.sha256(name.encode('utf-8', 'replace')).hexdigest()[:24]}.jpg"

    async def _store(self, name: str, frame: Frame) -> bytes:
        def write() -> bytes:
            jpeg = encode_jpeg(frame.image, min(THUMBNAIL_WIDTH, frame.width))
            try:
                self._folder.mkdir(parents=True, exist_ok=True)
                self._path(name).write_bytes(jpeg)
            except OSError:  # a thumbnail that cannot be stored is taken again
                pass
            return jpeg

        return await to_thread.run_sync(write)

    def _forget(self, name: str) -> None:
        self._station.visited.pop(name, None)
        self._path(name).unlink(missing_ok=True)


def _position_in_scene(camera: Camera, name: str) -> CameraPosition | None:
    """Return a preset's position in the coordinates of ``camera`` if the camera is simulated; None for other cameras."""
    presets = getattr(innermost(camera), "scene_presets", None)
    if presets is None:
        return None
    preset = presets.find(name)
    pose = preset_pose(preset)
    for layer in layers(camera):
        if isinstance(layer, MountedCamera):
            pose = layer.world_pose(pose)
    return CameraPosition(pose, preset.viewpoint)


@contextmanager
def _translate_refusals() -> Iterator[None]:
    """Raise ``RefusedByCameraError`` if the camera refuses to edit a preset, such as its home position.

    For a refusal, cameras raise ``CameraError`` itself. For failures, they raise subclasses, which propagate unchanged.
    """
    try:
        yield
    except CameraError as error:
        if type(error) is CameraError:
            raise RefusedByCameraError(str(error)) from error
        raise
