"""The presets of a simulated camera, including its home preset."""

from __future__ import annotations

from scope_ptz.camera.base import PresetInfo
from scope_ptz.camera.capabilities import check_preset_name
from scope_ptz.errors import CameraError, UnknownNameError
from scope_ptz.geometry import Pose
from scope_ptz.simulator.models import SceneFile, ScenePreset


def preset_pose(preset: ScenePreset) -> Pose:
    """Return the pose of a preset."""
    return Pose(preset.pan_deg, preset.tilt_deg, preset.zoom)


def camera_home_preset(scene: SceneFile, viewpoint: str | None = None) -> ScenePreset:
    """Choose a camera's home preset.

    Args:
        scene: The scene.
        viewpoint: The camera's viewpoint; None for that of the scene's home preset.

    Returns:
        The scene's home preset if it is at this viewpoint; otherwise the first preset at the viewpoint, or a new preset that points
            straight ahead if there is none.

    Raises:
        UnknownNameError: The scene has no such viewpoint.
    """
    home = next(preset for preset in scene.presets if preset.name == scene.home_preset)
    if viewpoint is None or viewpoint == home.viewpoint:
        return home
    known = [place.name for place in scene.viewpoints]
    if viewpoint not in known:
        raise UnknownNameError("viewpoint", viewpoint, known)
    local = (preset for preset in scene.presets if preset.viewpoint == viewpoint)
    return next(local, ScenePreset(name="home", viewpoint=viewpoint, pan_deg=0.0, tilt_deg=0.0, zoom=1.0))


class ScenePresets:
    """A simulated camera's presets: those of its scene, and those saved since the camera was opened.

    Args:
        scene: The scene.
        viewpoint: The camera's viewpoint; None for that of the scene's home preset.

    Attributes:
        home: The camera's home preset.
    """

    def __init__(self, scene: SceneFile, viewpoint: str | None = None) -> None:
        self.home = camera_home_preset(scene, viewpoint)
        self._presets = {preset.name: preset for preset in scene.presets}

    def infos(self) -> list[PresetInfo]:
        """Return the presets in a stable order."""
        return [
            PresetInfo(preset.name, preset.description, preset.viewpoint, is_home=preset == self.home)
            for preset in self._presets.values()
        ]

    def find(self, name: str) -> ScenePreset:
        """Return a preset.

        Raises:
            UnknownNameError: There is no such preset.
        """
        if name not in self._presets:
            raise UnknownNameError("preset", name, self._presets)
        return self._presets[name]

    def save(self, name: str, description: str, viewpoint: str, pose: Pose) -> PresetInfo:
        """Save a pose as a preset. An existing preset with the same name is replaced.

        Raises:
            InputError: The name is empty or too long, or contains unprintable characters.
            CameraError: The preset with this name is the home preset.
        """
        check_preset_name(name)
        if name == self.home.name:
            raise CameraError(f"The preset '{name}' is the home preset and cannot be replaced. Choose another name.")
        # Scene files require kebab-case names, but operators may choose any name, so the model is constructed without validation.
        self._presets[name] = ScenePreset.model_construct(
            name=name, viewpoint=viewpoint, description=description, pan_deg=pose.pan_deg, tilt_deg=pose.tilt_deg, zoom=pose.zoom
        )
        return PresetInfo(name, description)

    def remove(self, name: str) -> None:
        """Remove a preset.

        Raises:
            UnknownNameError: There is no such preset.
            CameraError: The preset is the home preset.
        """
        if self.find(name).name == self.home.name:
            raise CameraError(f"The preset '{name}' is the home preset and cannot be removed.")
        del self._presets[name]
