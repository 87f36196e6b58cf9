"""A base class for cameras that wrap another camera."""

from __future__ import annotations

from collections.abc import AsyncGenerator, AsyncIterator, Iterator
from contextlib import aclosing, asynccontextmanager, contextmanager

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.lens import DEFAULT_STEP, FocusAction, IrisAction, LensState
from scope_ptz.geometry import Pose


class CameraWrapper(Camera):
    """A camera that delegates every call to another camera. Subclasses override the methods that they change.

    ``centre_on`` is not delegated. It uses ``pose`` and ``move``, so overriding these also affects ``centre_on``.

    Args:
        camera: The wrapped camera. Closing the wrapper closes it too.
    """

    def __init__(self, camera: Camera) -> None:
        self.inner = camera
        self.clock = camera.clock

    @property
    def info(self) -> CameraInfo:
        return self.inner.info

    async def pose(self) -> Pose:
        return await self.inner.pose()

    async def move(self, pose: Pose) -> Arrival:
        return await self.inner.move(pose)

    async def presets(self) -> list[PresetInfo]:
        return await self.inner.presets()

    async def go_to_preset(self, name: str) -> Arrival:
        return await self.inner.go_to_preset(name)

    async def go_home(self) -> Arrival:
        return await self.inner.go_home()

    async def frame(self) -> Frame:
        return await self.inner.frame()

    async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
        async with aclosing(self.inner.frames(rate_hz=rate_hz)) as stream:
            async for frame in stream:
                yield frame

    @property
    def frames_problem(self) -> str:
        return self.inner.frames_problem

    async def stop(self) -> None:
        await self.inner.stop()

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        await self.inner.drive(pan_dps, tilt_dps, zoom_rate, timeout_s=timeout_s)

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:
        return await self.inner.save_preset(name, description)

    async def remove_preset(self, name: str) -> None:
        await self.inner.remove_preset(name)

    async def lens(self) -> LensState:
        return await self.inner.lens()

    async def set_focus(self, action: FocusAction, *, step: float = DEFAULT_STEP) -> LensState:
        return await self.inner.set_focus(action, step=step)

    async def set_iris(self, action: IrisAction, *, step: float = DEFAULT_STEP) -> LensState:
        return await self.inner.set_iris(action, step=step)

    @asynccontextmanager
    async def control(self, holder: str) -> AsyncIterator[None]:
        async with self.inner.control(holder):
            yield

    async def close(self) -> None:
        await self.inner.close()

    @contextmanager
    def hold_time(self) -> Iterator[None]:
        with self.inner.hold_time():
            yield


def layers(camera: Camera) -> Iterator[Camera]:
    """Yield a camera and the cameras that it wraps, from the outermost to the innermost."""
    yield camera
    while isinstance(camera, CameraWrapper):
        camera = camera.inner
        yield camera


def innermost(camera: Camera) -> Camera:
    """Return the camera inside all wrappers."""
    *_, last = layers(camera)
    return last
