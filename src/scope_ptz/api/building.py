"""Create the camera, planner and perception backend of a session from its options."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING

from scope_ptz.api.options import SessionOptions, check_type
from scope_ptz.builtin_names import SERVED_TRUTH
from scope_ptz.camera.base import Camera
from scope_ptz.camera.guard.dry_run import DryRunCamera
from scope_ptz.errors import InputError
from scope_ptz.factory.cameras import OpenCamera, open_camera
from scope_ptz.factory.models import (
    ResolvedPerception,
    dry_run_note,
    make_perception,
    make_planner,
    perception_note,
    resolve_models,
)
from scope_ptz.perception.base import Perception
from scope_ptz.perception.no_perception import NoPerception
from scope_ptz.planner.base import Planner

if TYPE_CHECKING:
    from scope_ptz.simulator.pack import Scene


@dataclass(frozen=True, slots=True)
class Parts:
    """The parts of an open session.

    Attributes:
        camera: The open camera.
        planner: The planner.
        perception: The perception backend.
        scene: The scene that provides the ground truth of the camera's frames; None if there is none.
        note: A sentence that describes a built-in perception backend, such as ground truth; empty for models.
        release: Function that closes the parts that were created for the session. Objects passed by the caller stay open.
    """

    camera: Camera
    planner: Planner
    perception: Perception
    scene: Scene | None
    note: str
    release: Callable[[], Awaitable[None]]


async def build_parts(options: SessionOptions) -> Parts:
    """Open the camera, and create the planner and the perception backend.

    Raises:
        InputError: An option is invalid.
        PackError: The files of a scene are damaged.
        CameraError: The camera failed or did not answer.
        BlenderError: Blender cannot be started, or cannot open the scene or the file.
    """
    pair = await resolve_models(options.served.model_options(options.planner, options.perception))
    async with AsyncExitStack() as stack:
        camera, opened = await _open_session_camera(options, stack)
        planner = make_planner(pair.planner)
        if pair.planner.instance is None:
            stack.push_async_callback(planner.close)
        perception = _create_perception(options, pair.perception, camera, opened)
        if pair.perception.instance is None:
            stack.push_async_callback(perception.close)
        scene = opened.scene if opened is not None else None
        note = "" if isinstance(perception, NoPerception) else perception_note(pair.perception)
        if options.dry_run:
            note = dry_run_note(note)
        return Parts(camera, planner, perception, scene, note, stack.pop_all().aclose)


async def _open_session_camera(options: SessionOptions, stack: AsyncExitStack) -> tuple[Camera, OpenCamera | None]:
    check_type("camera", options.camera, Camera)
    if not isinstance(options.camera, Camera):
        opened = await open_camera(
            options.camera,
            viewpoint=options.viewpoint,
            preset=options.preset,
            time_s=options.time_s,
            realtime=options.realtime,
            dry_run=(lambda _: None) if options.dry_run else None,
        )
        stack.push_async_callback(opened.aclose)
        return opened.camera, opened
    conflicting = [name for name in ("viewpoint", "time_s") if getattr(options, name) is not None]
    if conflicting:
        raise InputError(
            f"camera= is a Camera object, which cannot be combined with {' and '.join(conflicting)}. Remove the arguments."
        )
    camera = DryRunCamera(options.camera, lambda _: None) if options.dry_run else options.camera
    if options.preset is not None:
        await camera.go_to_preset(options.preset)
    return camera, None


def _create_perception(
    options: SessionOptions, resolved: ResolvedPerception, camera: Camera, opened: OpenCamera | None
) -> Perception:
    scenes = opened.scenes if opened is not None else _scenes_by_name() if camera.info.simulated else None
    served_truth = opened.served_truth if opened is not None else None
    if scenes is None and resolved.spec is None and resolved.instance is None and resolved.name != SERVED_TRUTH:
        if options.perception is None:
            return NoPerception("Pass perception= to scope_ptz.open with the name of a vision model or a Perception object.")
        raise InputError(
            f"The backend '{resolved.name}' reads the ground truth of a simulated scene, and the camera '{camera.info.name}' "
            "has none. Pass perception= with the name of a vision model or a Perception object."
        )
    return make_perception(resolved, scenes, options.seed, served_truth=served_truth)


def _scenes_by_name() -> Callable[[str], Scene]:
    """Return a function that opens scenes by name, for ground truth with a simulated camera created by the caller."""
    from scope_ptz.factory.scenes import scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.library import Library

    return Library(scene_search(load_settings()))
