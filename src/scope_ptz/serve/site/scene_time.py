"""Scene time for simulated cameras: play, pause, seek and speed."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.camera.base import Camera
from scope_ptz.serve.site.camera_kinds import has_scene_time
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.errors import NotSimulatedError
from scope_ptz.serve.site.station import Station
from scope_ptz.simulator.clock import SceneClock, check_speed, check_time


@dataclass(frozen=True, slots=True)
class SceneTime:
    """The scene time in seconds, whether it is playing, and its speed relative to real time."""

    time_s: float
    playing: bool
    speed: float


@dataclass(frozen=True, slots=True)
class SceneTimeChange:
    """A change to the scene time. Values that are None stay unchanged."""

    time_s: float | None = None
    playing: bool | None = None
    speed: float | None = None


def scene_time(camera: Camera) -> SceneTime | None:
    """Return a camera's scene time; None for a camera that shows the real world."""
    clock = _clock(camera)
    return None if clock is None else SceneTime(clock.now_s(), clock.playing, clock.speed)


async def read_scene_time(station: Station) -> SceneTime:
    """Return a camera's scene time. The camera is opened if necessary.

    Raises:
        NotSimulatedError: The camera shows the real world.
    """
    clock = await _require_clock(station)
    return SceneTime(clock.now_s(), clock.playing, clock.speed)


async def change_scene_time(station: Station, client: Client, change: SceneTimeChange) -> SceneTime:
    """Change scene time for all of a camera's clients. The camera's motors are not affected.

    Raises:
        NotSimulatedError: The camera shows the real world.
        NotInControlError: Another client controls the camera.
        BusyError: A run is in progress and relies on the scene time.
        InputError: The time or the speed is out of range. In this case, nothing is changed.
    """
    if change.time_s is not None:
        check_time(change.time_s)
    if change.speed is not None:
        check_speed(change.speed)
    clock = await _require_clock(station)
    await station.require_control(client)
    if change.playing is False:
        clock.pause()  # before seeking, so that the clock stops at exactly the requested time
    if change.time_s is not None:
        clock.seek(change.time_s)
    if change.speed is not None:
        clock.set_speed(change.speed)
    if change.playing:
        clock.play()
    return SceneTime(clock.now_s(), clock.playing, clock.speed)


async def _require_clock(station: Station) -> SceneClock:
    # Check the spec first, so that the server does not connect to a device only to refuse the request.
    clock = _clock(await station.camera()) if has_scene_time(station.spec) else None
    if clock is None:
        raise NotSimulatedError(
            f"{station.name} shows the real world, so its time cannot be paused or changed. Choose a simulated camera."
        )
    return clock


def _clock(camera: Camera) -> SceneClock | None:
    clock = camera.clock
    return clock if isinstance(clock, SceneClock) and camera.info.simulated else None
