"""The scene description that the add-on sends, and the pan-tilt-zoom camera that it defines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from scope_ptz.blender.file_cameras import FileCameras, file_cameras
from scope_ptz.camera.base import PresetInfo
from scope_ptz.errors import InputError
from scope_ptz.geometry import Limits, Optics, Pose, wrap_pan_deg

MAX_CAMERAS = 500
MAX_WIDTH, MAX_HEIGHT = 3840, 2160  # of a picture, in pixels


def _number(value: object) -> object:
    """Convert an integer to a float, because JSON does not distinguish the two."""
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


Name = Annotated[str, Field(min_length=1, max_length=80)]
Number = Annotated[float, Field(allow_inf_nan=False, ge=-1e9, le=1e9, strict=True), BeforeValidator(_number)]
Tilt = Annotated[float, Field(allow_inf_nan=False, ge=-90.0, le=90.0, strict=True), BeforeValidator(_number)]
FieldOfView = Annotated[float, Field(allow_inf_nan=False, ge=0.05, le=170.0, strict=True), BeforeValidator(_number)]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class SceneCamera(_Model):
    """A camera in the scene.

    Attributes:
        name: Its name, unique in the scene.
        title: Its name in Blender.
        position_m: Its position in scene coordinates.
        bearing_deg: Its bearing, measured clockwise (seen from above) from the scene's y axis.
        tilt_deg: Its tilt; positive is up.
        hfov_deg: Its horizontal field of view.
        viewpoint: For a preset, the name of the camera whose optical centre it shares; None for a camera that is its own viewpoint.
        saved: Whether it is a preset saved through SCOPE, which can be replaced and removed.
    """

    name: Name
    title: Annotated[str, Field(max_length=200)] = ""
    position_m: tuple[Number, Number, Number]
    bearing_deg: Number
    tilt_deg: Tilt
    hfov_deg: FieldOfView
    viewpoint: Name | None = None
    saved: bool = False


class SceneDescription(_Model):
    """The scene that is open in a Blender instance: its cameras, the active one, and the picture size in pixels.

    Raises:
        InputError: The camera names are inconsistent. This is not a ``ValidationError``, because a JSON schema cannot express
            these rules.
    """

    name: Name
    title: Annotated[str, Field(max_length=200)]
    blender_version: Annotated[str, Field(max_length=60)]
    active: Name
    cameras: Annotated[tuple[SceneCamera, ...], Field(min_length=1, max_length=MAX_CAMERAS)]
    width: Annotated[int, Field(ge=16, le=MAX_WIDTH)]
    height: Annotated[int, Field(ge=16, le=MAX_HEIGHT)]

    @model_validator(mode="after")
    def _check_names(self) -> Self:
        names = [camera.name for camera in self.cameras]
        if len(set(names)) != len(names):
            raise InputError("Two cameras in the scene have the same name.")
        viewpoints = {camera.name for camera in self.cameras if camera.viewpoint is None}
        if self.active not in viewpoints:
            raise InputError("The active camera must be a camera in the scene that is its own viewpoint.")
        if any(camera.viewpoint not in viewpoints for camera in self.cameras if camera.viewpoint is not None):
            raise InputError("The viewpoint of a preset must be a camera in the scene that is its own viewpoint.")
        return self


@dataclass(frozen=True, slots=True)
class WindowPreset:
    """A preset: a pose at a viewpoint.

    ``saved`` is True for presets saved through SCOPE, which can be replaced and removed.
    """

    info: PresetInfo
    viewpoint: str
    pose: Pose
    saved: bool


@dataclass(frozen=True, slots=True)
class WindowScene:
    """The cameras in an open scene, combined into one pan-tilt-zoom camera as for ``blender:FILE.blend``.

    Attributes:
        description: The scene description from which this was created.
        optics: The optics. Zoom 1 is the widest field of view among the cameras.
        limits: The limits of motion.
        presets: The presets by name: the cameras in the scene, and the presets saved through SCOPE.
    """

    description: SceneDescription
    optics: Optics
    limits: Limits
    presets: dict[str, WindowPreset]

    @property
    def home(self) -> WindowPreset:
        """The preset for the scene's active camera."""
        return self.presets[self.description.active]

    def viewpoint(self, name: str) -> SceneCamera:
        """Return the camera at a viewpoint."""
        return next(camera for camera in self.description.cameras if camera.name == name)


def window_scene(description: SceneDescription) -> WindowScene:
    """Return the pan-tilt-zoom camera that a scene defines."""
    viewpoint_cameras = [camera for camera in description.cameras if camera.viewpoint is None]
    combined = _combine(description, viewpoint_cameras)
    viewpoints = {camera.name: camera for camera in viewpoint_cameras}
    presets = {}
    for camera in (*viewpoint_cameras, *(camera for camera in description.cameras if camera.viewpoint is not None)):
        origin = viewpoints[camera.viewpoint or camera.name]
        pose = Pose(
            wrap_pan_deg(camera.bearing_deg - origin.bearing_deg), camera.tilt_deg, combined.optics.zoom_for_hfov(camera.hfov_deg)
        )
        info = PresetInfo(camera.name, camera.title)
        presets[camera.name] = WindowPreset(info, origin.name, pose, camera.saved)
    return WindowScene(description, combined.optics, combined.limits, presets)


def _combine(description: SceneDescription, viewpoint_cameras: list[SceneCamera]) -> FileCameras:
    """Return the optics and limits, as for a .blend file. The cameras are numbered, because their names may be free text."""
    cameras = [{**camera.model_dump(), "name": f"camera-{number}"} for number, camera in enumerate(viewpoint_cameras)]
    active = next(number for number, camera in enumerate(viewpoint_cameras) if camera.name == description.active)
    return file_cameras(
        {
            "name": "window",
            "title": description.title or "Blender",
            "blender_version": description.blender_version,
            "active": f"camera-{active}",
            "cameras": cameras,
        }
    )
