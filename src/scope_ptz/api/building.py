"""Turn the options of a session into a camera, a planner and perception."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING

from scope_ptz.api.options import SessionOptions
from scope_ptz.camera.base import Camera
from scope_ptz.errors import InputError
from scope_ptz.factory.models import ResolvedPerception, resolve_models
from scope_ptz.factory.session import Start, make_perception, make_planner, open_camera, open_scene, scene_search
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import Planner

if TYPE_CHECKING:
    from scope_ptz.simulator.pack import Scene


@dataclass(frozen=True, slots=True)
class Parts:
    """The parts of an open session.

    Attributes:
        scene: the scene of a simulated camera, else None.
        note: a sentence on what perception is, empty for models.
        release: closes the parts that were made for the session. Objects that the caller passed stay open.
    """

    camera: Camera
    planner: Planner
    perception: Perception
    scene: Scene | None
    note: str
    release: Callable[[], Awaitable[None]]


async def build(options: SessionOptions) -> Parts:
    """Open the camera and make the planner and perception.

    Raises:
        InputError: an option is wrong.
        PackError: the files of a scene are damaged.
        CameraError: the camera does not answer.
    """
    pair = await resolve_models(options.served.model_options(options.planner, options.perception))
    async with AsyncExitStack() as stack:
        camera, scene = await _camera(options, stack)
        if isinstance(options.planner, Planner):
            planner = options.planner
        else:
            planner = make_planner(pair.planner)
            stack.push_async_callback(planner.close)
        if isinstance(options.perception, Perception):
            perception, note = options.perception, ""
        else:
            perception, note = _perception(pair.eyes, camera, scene, options.seed)
            stack.push_async_callback(perception.close)
        return Parts(camera, planner, perception, scene, note, stack.pop_all().aclose)


async def _camera(options: SessionOptions, stack: AsyncExitStack) -> tuple[Camera, Scene | None]:
    if isinstance(options.camera, Camera):
        placed = [name for name in ("viewpoint", "time_s") if getattr(options, name) is not None]
        if placed:
            raise InputError(f"The camera is an object of your own, so {' and '.join(placed)} has no effect. Leave it out.")
        if options.preset is not None:
            await options.camera.go_to_preset(options.preset)
        return options.camera, None
    name = options.camera.removeprefix("sim:")
    scene = open_scene(name)
    start = Start(name, options.viewpoint, options.preset, options.time_s)
    camera = await open_camera(start, scene, realtime=options.realtime)
    stack.push_async_callback(camera.close)
    return camera, scene


def _perception(resolved: ResolvedPerception, camera: Camera, scene: Scene | None, seed: int) -> tuple[Perception, str]:
    if scene is None and resolved.spec is None:
        raise InputError(
            f"The camera '{camera.info.name}' has no ground truth for '{resolved.name}' to read. Pass perception=, "
            "the name of a vision model or an object of your own."
        )
    return make_perception(resolved, scene, seed)  # type: ignore[arg-type]
