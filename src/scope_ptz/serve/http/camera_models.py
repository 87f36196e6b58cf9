"""Request and response bodies for the camera card, scene time and virtual camera routes."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, BeforeValidator, Field

from scope_ptz.serve.http.models import Body, ControlModel, Problem
from scope_ptz.serve.site.camera_cards import Ability, HealthState
from scope_ptz.serve.site.camera_kinds import CameraKind
from scope_ptz.serve.site.scene_time import SceneTime
from scope_ptz.serve.site.virtual_cameras import VirtualCamera
from scope_ptz.simulator.clock import MAX_SPEED, MAX_TIME_S, MIN_SPEED


def _to_float(value: object) -> object:
    """Convert an integer to a float; JSON does not distinguish the two."""
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


class SceneTimeModel(BaseModel):
    """The scene time in seconds, whether it is playing, and its speed relative to real time."""

    time_s: float
    playing: bool
    speed: float

    @classmethod
    def of(cls, scene_time: SceneTime | None) -> SceneTimeModel | None:
        """Create the model for a scene time; None for a camera that shows the real world."""
        return None if scene_time is None else cls(time_s=scene_time.time_s, playing=scene_time.playing, speed=scene_time.speed)


class SceneTimeBody(Body):
    """A change to the scene time. Omitted fields stay the same."""

    time_s: Annotated[float, Field(ge=0.0, le=MAX_TIME_S, allow_inf_nan=False), BeforeValidator(_to_float)] | None = None
    playing: bool | None = None
    speed: Annotated[float, Field(ge=MIN_SPEED, le=MAX_SPEED, allow_inf_nan=False), BeforeValidator(_to_float)] | None = None


class VirtualCameraBody(Body):
    """A virtual camera to turn on. ``viewpoint`` is one of the scene's viewpoints; by default, that of the home preset."""

    viewpoint: Annotated[str, Field(min_length=1, max_length=60)] | None = None


class VirtualCameraModel(BaseModel):
    """A virtual camera. While it is off, all fields but ``on`` are null.

    ``password`` is given only in the reply to the request that turns the camera on.
    """

    on: bool
    viewpoint: str | None = None
    vapix_url: str | None = None
    onvif_url: str | None = None
    rtsp_url: str | None = None
    account: str | None = None
    password: str | None = None

    @classmethod
    def of(cls, camera: VirtualCamera | None, password: str | None = None) -> VirtualCameraModel:
        """Create the model for a virtual camera; None means that it is off."""
        if camera is None:
            return cls(on=False)
        return cls(
            on=True, viewpoint=camera.viewpoint, vapix_url=camera.vapix_url, onvif_url=camera.onvif_url, rtsp_url=camera.rtsp_url,
            account=camera.account, password=password,
        )  # fmt: skip


class SceneModel(BaseModel):
    """A simulated camera's scene: the names of its viewpoints, and its numbers of presets and moving objects."""

    name: str
    title: str
    viewpoints: list[str]
    presets: int
    moving: int


class HealthModel(BaseModel):
    """Whether a camera works.

    ``state`` is "connected" if the camera answers, "ready" if it will be opened on first use, and "failed" if it cannot be used.
    ``problem`` states why the camera cannot be used; null otherwise.
    """

    state: HealthState
    problem: Problem | None


class CameraCardModel(BaseModel):
    """A camera's card in the camera list.

    ``configured`` is true for a camera in ``scope.yaml``. ``scene_time`` is null for a camera that is not simulated or has not been
    opened yet. ``has_picture`` is true if there is a thumbnail.
    """

    name: str
    title: str
    kind: CameraKind
    scene: SceneModel | None
    abilities: list[Ability]
    health: HealthModel
    configured: bool
    has_picture: bool
    open: bool
    run: str | None
    control: ControlModel
    scene_time: SceneTimeModel | None
    virtual_camera: VirtualCameraModel
