"""Take pictures through a camera, with the 3D viewport or with the scene's render engine."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy

from ..protocol.errors import AddOnError
from ..protocol.png import png_of_rgba

_RENDER_SETTINGS = (
    "filepath", "resolution_x", "resolution_y", "resolution_percentage", "pixel_aspect_x", "pixel_aspect_y", "use_border",
    "use_file_extension", "use_multiview", "use_overwrite", "use_placeholder", "use_sequencer",
)  # fmt: skip
_IMAGE_SETTINGS = ("media_type", "file_format", "color_mode", "color_depth", "compression")  # media_type is new in Blender 5.0


def take(scene: Any, camera: Any, size: tuple[int, int], source: str) -> Callable[[], bytes]:
    """Take a picture. Return a function that encodes it as a PNG file and can run in another thread.

    Args:
        scene: The scene.
        camera: The camera object.
        size: Width and height in pixels.
        source: ``VIEWPORT`` or ``RENDER``.

    Raises:
        AddOnError: The picture cannot be taken.
    """
    if source == "VIEWPORT" and not bpy.app.background:
        found = viewport()
        if found is None:
            raise AddOnError(
                "No 3D viewport is open, so no picture can be taken. Open one, or set Pictures to Render in the SCOPE tab."
            )
        return _draw_viewport(scene, camera, size, *found)
    return _render(scene, size)


def viewport() -> tuple[Any, Any] | None:
    """Return the space and the region of the first 3D viewport; None if there is none."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                return area.spaces.active, next(region for region in area.regions if region.type == "WINDOW")
    return None


def appearance(source: str) -> str:
    """Return a string that identifies how pictures look: the shading settings of the viewport, or the render engine."""
    scene, found = bpy.context.scene, viewport() if source == "VIEWPORT" and not bpy.app.background else None
    if found is None:
        return scene.render.engine
    shading = found[0].shading
    return f"{shading.type}-{shading.light}-{shading.color_type}"


def _draw_viewport(scene: Any, camera: Any, size: tuple[int, int], space: Any, region: Any) -> Callable[[], bytes]:
    import gpu

    width, height = size
    graph = bpy.context.evaluated_depsgraph_get()
    projection = camera.calc_matrix_camera(graph, x=width, y=height)
    view = camera.matrix_world.inverted()
    overlays, space.overlay.show_overlays = space.overlay.show_overlays, False
    try:
        offscreen = gpu.types.GPUOffScreen(width, height)
    except (SystemError, RuntimeError) as error:
        raise AddOnError(f"Blender's graphics are not available: {error}. Set Pictures to Render in the SCOPE tab.") from error
    try:
        offscreen.draw_view3d(scene, bpy.context.view_layer, space, region, view, projection, do_color_management=True)
        with offscreen.bind():
            buffer = gpu.state.active_framebuffer_get().read_color(0, 0, width, height, 4, 0, "UBYTE")
    finally:
        offscreen.free()
        space.overlay.show_overlays = overlays
    buffer.dimensions = 4 * width * height
    pixels = bytes(buffer)
    return lambda: png_of_rgba(pixels, width, height)


def _render(scene: Any, size: tuple[int, int]) -> Callable[[], bytes]:
    folder = tempfile.TemporaryDirectory(prefix="scope-", ignore_cleanup_errors=True)
    path = Path(folder.name) / "frame.png"
    try:
        with _render_settings(scene, size, path):
            bpy.ops.render.render(write_still=True, scene=scene.name)
    except RuntimeError as error:
        folder.cleanup()
        raise AddOnError(f"Blender could not render the picture: {str(error).strip()[:300]}") from error

    def read() -> bytes:
        try:
            return path.read_bytes()
        finally:
            folder.cleanup()

    return read


@contextmanager
def _render_settings(scene: Any, size: tuple[int, int], path: Path) -> Iterator[None]:
    """Set the scene to render a PNG file of the given size while the context is active, then restore the user's settings."""
    render, image = scene.render, scene.render.image_settings
    before = {name: getattr(render, name) for name in _RENDER_SETTINGS}
    image_before = {name: getattr(image, name) for name in _IMAGE_SETTINGS if hasattr(image, name)}
    try:
        render.filepath, render.use_file_extension = str(path), False
        render.resolution_x, render.resolution_y = size
        render.resolution_percentage, render.pixel_aspect_x, render.pixel_aspect_y = 100, 1.0, 1.0
        render.use_border = render.use_multiview = render.use_placeholder = render.use_sequencer = False
        render.use_overwrite = True
        if "media_type" in image_before:
            image.media_type = "IMAGE"
        image.file_format, image.color_mode, image.color_depth, image.compression = "PNG", "RGB", "8", 15
        yield
    finally:
        for name, value in before.items():
            setattr(render, name, value)
        for name, value in image_before.items():
            setattr(image, name, value)
