"""The presets of a scene as poses, and the preset at which a camera starts."""

from __future__ import annotations

from scope_ptz.errors import UnknownNameError
from scope_ptz.geometry import Pose
from scope_ptz.simulator.models import SceneFile, ScenePreset


def preset_pose(preset: ScenePreset) -> Pose:
    """Return the pose of a preset."""
    return Pose(preset.pan_deg, preset.tilt_deg, preset.zoom)


def starting_preset(scene: SceneFile, viewpoint: str | None = None) -> ScenePreset:
    """Return the preset that is home for a camera.

    Args:
        scene: The scene.
        viewpoint: Where the camera stands, None for the viewpoint of the scene's home preset.

    Returns:
        The scene's home preset, or the first preset of another viewpoint. A viewpoint without presets gets one straight ahead.

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
