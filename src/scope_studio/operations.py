"""Operations of the worker. They take and return JSON values, and write images to files."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy

from scope_studio import blend_files, describe, meshes, render, sprites
from scope_studio.actor_bodies import ActorBodies
from scope_studio.kit.core.stage import Stage, Viewpoint

Progress = Callable[[int, int], None]
"""A function that is called with the number of finished steps of an operation and their total number."""


class Studio:
    """The currently loaded scene, and the operations on it."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._stage: Stage | None = None
        self._actor_bodies: ActorBodies | None = None
        self._file_cameras: tuple[Viewpoint, ...] = ()

    @property
    def stage(self) -> Stage:
        """The stage of the loaded scene.

        Raises:
            RuntimeError: No scene is loaded.
        """
        if self._stage is None:
            raise RuntimeError("no scene is loaded; request load_scene first")
        return self._stage

    @property
    def actor_bodies(self) -> ActorBodies:
        """The bodies of the scene's moving actors."""
        if self._actor_bodies is None:
            self._actor_bodies = ActorBodies(self.stage)
        return self._actor_bodies

    def viewpoint(self, name: str) -> Viewpoint:
        """Return the viewpoint with this name, from the loaded scene or the opened .blend file."""
        for candidate in self._file_cameras or self.stage.viewpoints:
            if candidate.name == name:
                return candidate
        names = ", ".join(v.name for v in self._file_cameras or self.stage.viewpoints)
        raise ValueError(f"the scene has no viewpoint '{name}'. Its viewpoints are: {names}")

    def load_scene(self, source: str) -> dict[str, Any]:
        """Build a scene in an empty Blender file and return its name, title, number of instances and render device.

        Args:
            source: Name of a module in ``scope_studio.scenes`` (kebab-case), or path of a Python file that
                defines ``build(stage)``.
        """
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.context.preferences.filepaths.use_scripts_auto_execute = False
        self._actor_bodies, self._file_cameras = None, ()
        module = _module(source)
        name = getattr(module, "NAME", Path(source).stem.replace("_", "-"))
        stage = Stage(name, getattr(module, "TITLE", name.replace("-", " ").capitalize()))
        module.build(stage)
        stage.finish()
        bpy.context.view_layer.update()
        self._stage = stage
        return {"name": stage.name, "title": stage.title, "instances": len(stage.instances), "device": render.use_gpu() or "CPU"}

    def open_file(self, path: str) -> dict[str, Any]:
        """Open a .blend file without running its embedded scripts, and return a description of its cameras."""
        description, self._file_cameras = blend_files.open_file(path)
        self._stage = self._actor_bodies = None
        render.use_gpu()
        return description

    def describe(self) -> dict[str, Any]:
        """Return the description of the loaded scene; see ``describe.scene``."""
        return describe.scene(self.stage, self.actor_bodies)

    def save(self, path: str) -> None:
        """Write the scene as a .blend file, to inspect it in Blender."""
        bpy.ops.wm.save_as_mainfile(filepath=path, compress=True)

    def meshes(self, out: str) -> None:
        """Write the triangles of all instances to an .npz file; see ``meshes.write``."""
        meshes.write(self.stage, Path(out))

    def colour(
        self, viewpoint: str, projection: dict[str, float], samples: int, seed: int, out: str, time_s: float | None = None
    ) -> None:
        """Render a denoised image (8-bit PNG). With ``time_s``, moving actors are shown at their positions at that time."""
        with self._show_actors(time_s):
            render.colour(self.viewpoint(viewpoint), projection, samples, seed, Path(out))

    def truth(self, viewpoint: str, projection: dict[str, float], out: str, time_s: float | None = None) -> None:
        """Write the instance mask (uint16) and the distances in metres (float32, 0 = sky) of a view to an .npz file."""
        with self._show_actors(time_s):
            render.truth(self.viewpoint(viewpoint), projection, Path(out))

    def sprites(self, actor: str, viewpoint: str, frames: list[dict[str, Any]], samples: int, out_dir: str) -> None:
        """Render the sprites of a moving actor; see ``sprites.render_frames``."""
        sprites.render_frames(
            self.stage, self.actor_bodies, actor, self.viewpoint(viewpoint), frames, samples, Path(out_dir), self._progress
        )

    def _show_actors(self, time_s: float | None) -> AbstractContextManager[None]:
        """Show the moving actors at a scene time while the context is active; none if it is None. Set the time of a .blend file."""
        if self._file_cameras and time_s is not None:
            blend_files.set_time(time_s)
        return nullcontext() if self._file_cameras or time_s is None else self.actor_bodies.show_at(time_s)


def _module(source: str) -> ModuleType:
    """Import a scene's module, which defines ``build(stage)`` and, optionally, ``NAME`` (kebab-case) and ``TITLE``."""
    if not source.endswith(".py"):
        return importlib.import_module(f"scope_studio.scenes.{source.replace('-', '_')}")
    spec = importlib.util.spec_from_file_location("scope_user_scene", source)
    if spec is None or spec.loader is None:
        raise ValueError(f"cannot load {source} as a Python module. Check that it is a Python file")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def operations(progress: Progress) -> dict[str, Callable[..., Any]]:
    """Return the worker's operations by name."""
    studio = Studio(progress)
    return {
        name: getattr(studio, name)
        for name in ("load_scene", "open_file", "describe", "save", "meshes", "colour", "truth", "sprites")
    }
