"""A simulated camera and its scene, with the synchronous interface that Gymnasium requires."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Awaitable, Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from scope_ptz.api.event_loop import EventLoopThread
from scope_ptz.bench.program_runner import BlankCamera
from scope_ptz.bench.scoring.episode import FrameGeometry
from scope_ptz.builtin_names import GROUND_TRUTH, NOISY
from scope_ptz.camera.base import Frame, FrameOrigin
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import InputError
from scope_ptz.factory.models import ModelOptions, ResolvedPerception, make_perception, resolve_models
from scope_ptz.geometry import Pose
from scope_ptz.gym.shared_scenes import shared_scene
from scope_ptz.perception.base import Perception
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.views import picture

MIN_FRAME_PX, MAX_FRAME_PX = 16, 4096  # width and height of the frames that an agent receives
MAX_SCENES = 2
"""Number of scenes that a world keeps open. A scene needs up to 400 MB of memory, and reopening it takes about a second."""

_T = TypeVar("_T")


class World:
    """The world of one environment: a scene, a camera in it, a clock, and perception. ``open`` starts an episode.

    The camera's coroutines run in a separate thread, so that environments also work in a notebook. The thread starts with the
    first episode. Scene time advances only by the duration of moves, independently of the wall clock.

    Attributes:
        scene: The scene of the episode.
        camera: The camera. Tools may move it.
        perception: The perception backend of the episode.
        pose: The camera's pose after the last move made through this object.

    Args:
        perception: Name of a perception backend, as in ``--perception``, or a backend that the caller closes.
        frame_size: Width and height, in pixels, of the frames that the agent receives.
        camera_size: Width and height, in pixels, of the frames that the tools take.
    """

    scene: Scene
    camera: SimulatedCamera
    perception: Perception
    pose: Pose

    def __init__(self, perception: str | Perception, frame_size: tuple[int, int], camera_size: tuple[int, int]) -> None:
        check_frame_size(frame_size)
        self._frame_size, self._camera_size = frame_size, camera_size
        self._options = perception
        self._resolved: ResolvedPerception | None = None
        self._owned: Perception | None = None
        self._scenes: OrderedDict[str, Scene] = OrderedDict()  # the least recently used first
        self._loop: EventLoopThread | None = None

    def scene_by_name(self, name: str) -> Scene:
        """Return a scene. It stays open until ``MAX_SCENES`` others have been used, or until the world is closed."""
        if name not in self._scenes:
            self._scenes[name] = shared_scene(name)
        self._scenes.move_to_end(name)
        while len(self._scenes) > MAX_SCENES:
            self._scenes.popitem(last=False)
        return self._scenes[name]

    def open(self, name: str, preset: str, time_s: float, seed: int) -> None:
        """Begin an episode.

        Args:
            name: Name of the scene or of a variation of one.
            preset: The preset at which the camera starts.
            time_s: Scene time at the start, in seconds.
            seed: Seed for the errors of noisy perception.

        Raises:
            UnknownNameError: The scene or the preset does not exist.
            InputError: The perception backend cannot be created.
        """
        self.scene = self.scene_by_name(name)
        clock = SceneClock(time_s)
        width, height = self._camera_size
        self.perception = self._make_perception(seed)
        # Backends that read the ground truth do not use pixels, so none are rendered.
        camera_class = BlankCamera if self._options in (GROUND_TRUTH, NOISY) else SimulatedCamera
        self.camera = camera_class(self.scene, clock=clock, width=width, height=height)
        with clock.hold():
            self.pose = self.run(lambda: self.camera.go_to_preset(preset)).pose

    def move(self, pose: Pose) -> None:
        """Move the camera to a pose, or as close to it as the limits allow. Scene time advances by the duration of the move."""
        self.pose = self.run(lambda: self.camera.move(pose)).pose

    def place(self, pose: Pose) -> None:
        """Move the camera to a pose without advancing scene time."""
        with self.camera.clock.hold():
            self.move(pose)

    def run(self, work: Callable[[], Awaitable[_T]]) -> _T:
        """Run a coroutine from the camera, the tools or perception, and return its result."""
        if self._loop is None:
            self._loop = EventLoopThread(self._close_perception)
        return self._loop.call(work)

    @property
    def time_s(self) -> float:
        """Scene time in seconds."""
        return self.camera.clock.now_s()

    @property
    def geometry(self) -> FrameGeometry:
        """The geometry of the frames that the agent receives."""
        info = self.camera.info
        return FrameGeometry(*self._frame_size, info.optics, info.limits)

    @property
    def camera_geometry(self) -> FrameGeometry:
        """The geometry of the frames that the tools take."""
        info = self.camera.info
        return FrameGeometry(*self._camera_size, info.optics, info.limits)

    def picture(self, pose: Pose, size: tuple[int, int] | None = None) -> NDArray[np.uint8]:
        """Render the view at a pose as (H, W, 3) RGB, by default in the agent's frame size."""
        info = self.camera.info
        geometry = FrameGeometry(*(size or self._frame_size), info.optics, info.limits)
        return picture(self.scene, self.camera.viewpoint, geometry.view(pose), self.time_s)

    def blank_frame(self, pose: Pose) -> Frame:
        """Return the agent's frame at a pose without pixels, for queries of the ground truth."""
        view = self.geometry.view(pose)
        image = np.broadcast_to(np.uint8(0), (view.height, view.width, 3))
        origin = FrameOrigin(self.scene.name, self.camera.viewpoint, pose, self.time_s)
        return Frame(image=image, pose=pose, hfov_deg=view.hfov_deg, time_s=self.time_s, projection=view, origin=origin)

    def close(self) -> None:
        """Close perception, stop the thread and release the scenes. Calling it again has no effect."""
        loop, self._loop = self._loop, None
        if loop is not None:
            loop.stop()
        self._scenes.clear()

    def _make_perception(self, seed: int) -> Perception:
        if isinstance(self._options, Perception):
            return self._options
        if self._owned is not None and self._options != NOISY:
            return self._owned
        if self._resolved is None:
            name = self._options
            self._resolved = self.run(lambda: resolve_models(ModelOptions(perception=name))).perception
        resolved = self._resolved

        async def make() -> Perception:
            return make_perception(resolved, self.scene_by_name, seed)

        self._owned = self.run(make)
        return self._owned

    async def _close_perception(self) -> None:
        owned, self._owned = self._owned, None
        if owned is not None:
            await owned.close()


def check_frame_size(size: tuple[int, int]) -> None:
    """Check the width and height of frames.

    Raises:
        InputError: The size is not two whole numbers of pixels within the limits.
    """
    valid = len(size) == 2 and all(isinstance(side, int) and MIN_FRAME_PX <= side <= MAX_FRAME_PX for side in size)
    if not valid:
        raise InputError(
            f"frame_size must be (width, height), each from {MIN_FRAME_PX} to {MAX_FRAME_PX} pixels; got {size!r}. "
            "The default is (320, 180)."
        )
