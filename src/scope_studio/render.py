"""Render views from a viewpoint with Cycles: denoised images, instance masks and distances."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from scope_ptz.geometry.sphere import camera_axes
from scope_studio.kit.core.stage import Viewpoint

GPU_INTERFACES = ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI")
"""Interfaces through which Cycles can use a GPU, in order of preference."""

SKY_DEPTH_M = 1e9
"""Depth in metres above which a pixel is sky. Cycles reports 1e10 where a ray hits nothing."""


def colour(viewpoint: Viewpoint, projection: dict[str, float], samples: int, seed: int, out: Path, *, alpha: bool = False) -> None:
    """Render a denoised image with the scene's view transform and write it as an 8-bit PNG."""
    scene = _prepare(viewpoint, projection, samples, seed)
    scene.cycles.use_denoising = samples > 1
    scene.cycles.denoiser = "OPENIMAGEDENOISE"
    scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    scene.cycles.filter_width = 1.5
    scene.render.film_transparent = alpha
    _enable_passes(False)
    settings = scene.render.image_settings
    settings.media_type = "IMAGE"
    settings.file_format = "PNG"
    settings.color_mode = "RGBA" if alpha else "RGB"
    settings.color_depth = "8"
    settings.compression = 15
    _render(scene, out)


def truth(viewpoint: Viewpoint, projection: dict[str, float], out: Path) -> None:
    """Render one sample per pixel and write the arrays of ``truth_arrays`` to an .npz file, as ``ids`` and ``depth``."""
    ids, depth = truth_arrays(viewpoint, projection)
    with out.open("wb") as file:
        np.savez(file, ids=ids, depth=depth)


def truth_arrays(viewpoint: Viewpoint, projection: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the instance mask (H, W) uint16 and distances (H, W) float32 in metres (0 = sky) at the pixel centres."""
    scene = _prepare(viewpoint, projection, 1, 0)
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 0.01
    scene.render.film_transparent = False
    _enable_passes(True)
    settings = scene.render.image_settings
    settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    settings.exr_codec = "NONE"
    bounces = scene.cycles.max_bounces
    scene.cycles.max_bounces = 0
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "truth.exr"
            _render(scene, path)
            channels = _read_exr(path)
    finally:
        scene.cycles.max_bounces = bounces
    ids = np.rint(next(v for k, v in channels.items() if k.endswith("Object Index.X"))).astype(np.uint16)
    depth = next(v for k, v in channels.items() if k.endswith("Depth.Z")).astype(np.float32)
    sky = depth > SKY_DEPTH_M
    if projection["kind"] == "perspective":
        depth = depth * _ray_lengths(projection)
    return ids, np.where(sky, 0.0, depth).astype(np.float32)


def _ray_lengths(projection: dict[str, float]) -> np.ndarray:
    """Return an array (H, W) with the distance along each pixel's ray per metre along the optical axis."""
    width, height = int(projection["width"]), int(projection["height"])
    focal = width / 2 / math.tan(math.radians(projection["hfov_deg"]) / 2)
    x = (np.arange(width) + 0.5 - width / 2) / focal
    y = (np.arange(height) + 0.5 - height / 2) / focal
    return np.sqrt(1 + x[None, :] ** 2 + y[:, None] ** 2)


def use_gpu() -> str | None:
    """Configure Cycles to render on the GPUs that Blender finds.

    Returns:
        The name of the compute interface, or None if Cycles renders on the CPU.
    """
    cycles = bpy.context.preferences.addons["cycles"].preferences
    for interface in GPU_INTERFACES:
        try:
            cycles.compute_device_type = interface
        except TypeError:  # this build of Blender has no such interface
            continue
        cycles.refresh_devices()
        gpus = [device for device in cycles.devices if device.type == interface]
        if gpus:
            for device in cycles.devices:
                device.use = device in gpus
            bpy.context.scene.cycles.device = "GPU"
            return str(interface)
    return None


def _prepare(viewpoint: Viewpoint, projection: dict[str, float], samples: int, seed: int) -> bpy.types.Scene:
    """Set up the camera and the common render settings, and return the scene."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.use_persistent_data = True
    scene.render.use_compositing = False
    scene.render.use_sequencer = False
    scene.render.resolution_x, scene.render.resolution_y = int(projection["width"]), int(projection["height"])
    scene.render.resolution_percentage = 100
    scene.render.pixel_aspect_x = scene.render.pixel_aspect_y = 1.0
    scene.render.use_border = False
    scene.render.dither_intensity = 0.0
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_auto_tile = False
    scene.cycles.seed = seed
    scene.camera = _camera(scene)
    data = scene.camera.data
    data.dof.use_dof = False
    data.clip_start, data.clip_end = 0.02, 1e5
    pan, tilt = (projection["pan_deg"], projection["tilt_deg"]) if projection["kind"] == "perspective" else (0.0, 0.0)
    right, up, ahead = camera_axes(viewpoint.pan0_bearing_deg + pan, tilt)
    axes = np.stack([right, up, -ahead], axis=1)
    scene.camera.matrix_world = Matrix.Translation(viewpoint.position) @ Matrix(axes.tolist()).to_4x4()
    if projection["kind"] == "perspective":
        data.type = "PERSP"
        data.sensor_fit = "HORIZONTAL"
        data.angle_x = math.radians(projection["hfov_deg"])
    else:
        data.type = "PANO"
        data.panorama_type = "EQUIRECTANGULAR"
        data.longitude_min, data.longitude_max = -math.pi, math.pi
        data.latitude_min = math.radians(projection["bottom_tilt_deg"])
        data.latitude_max = math.radians(projection["top_tilt_deg"])
    return scene


def _camera(scene: bpy.types.Scene) -> bpy.types.Object:
    """Return the camera object, which is created on first use."""
    name = "scope camera"
    existing = bpy.data.objects.get(name)
    if existing is None:
        existing = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        scene.collection.objects.link(existing)
    return existing


def _enable_passes(on: bool) -> None:
    """Turn the passes for the instance mask and depth on or off."""
    layer = bpy.context.view_layer
    layer.use_pass_object_index = on
    layer.use_pass_z = on
    layer.use_pass_combined = True


def _render(scene: bpy.types.Scene, out: Path) -> None:
    """Render a still image to ``out``.

    Raises:
        RuntimeError: Blender wrote no file.
    """
    scene.render.use_file_extension = False
    scene.render.filepath = str(out)
    bpy.ops.render.render(write_still=True)
    if not out.exists():
        raise RuntimeError(f"Blender rendered no image to {out}; see its output for the cause")


def _read_exr(path: Path) -> dict[str, Any]:
    """Read an EXR file and return a float array (H, W) for each channel name.

    The Blender application ships with OpenImageIO. Environments that use the ``bpy`` wheel have OpenEXR instead.
    """
    try:
        import OpenEXR
    except ImportError:
        import OpenImageIO

        image = OpenImageIO.ImageInput.open(str(path))
        spec = image.spec()
        pixels = np.asarray(image.read_image("float")).reshape(spec.height, spec.width, spec.nchannels)
        return {name: pixels[..., k] for k, name in enumerate(spec.channelnames)}
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: np.asarray(channel.pixels) for part in file.parts for name, channel in part.channels.items()}
