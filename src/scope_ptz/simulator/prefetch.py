"""Read a viewpoint in the background, so that no later view has to wait for a file."""

from __future__ import annotations

import threading

from scope_ptz.geometry import AXIS_M5075_G, Limits, Optics, Perspective, angle_between_deg
from scope_ptz.simulator.mapping.atlas_map import TILE_GAIN, panorama_density, suitable_scale
from scope_ptz.simulator.viewpoint import Viewpoint

DENSITY_STEPS = 64  # zooms between the widest and the closest at which the scales of tiles are determined


class Prefetch:
    """Reads what live views of a viewpoint need, in a thread of its own that starts at once.

    Afterwards, no view with this frame width reads a file. If the memory of tiles is limited, tiles are left out: they are read
    when they come into view.

    Args:
        viewpoint: The viewpoint.
        width: Width of the views in pixels.
        optics: Fields of view of the camera.
        limits: Limits of its zoom.
    """

    def __init__(
        self, viewpoint: Viewpoint, width: int = 1280, optics: Optics = AXIS_M5075_G, limits: Limits | None = None
    ) -> None:
        limits = limits or Limits()
        self._viewpoint = viewpoint
        zooms = [limits.min_zoom + (limits.max_zoom - limits.min_zoom) * k / DENSITY_STEPS for k in range(DENSITY_STEPS + 1)]
        self._densities = [Perspective(0.0, 0.0, optics.hfov_deg(zoom), width, width).focal_px for zoom in zooms]
        self._cancelled = threading.Event()
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name=f"prefetch {viewpoint.name}", daemon=True)
        self._thread.start()

    @property
    def done(self) -> bool:
        """Whether the thread has ended."""
        return not self._thread.is_alive()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait for the end and return whether it came in time.

        Raises:
            PackError: A file of the viewpoint is missing or damaged.
        """
        self._thread.join(timeout_s)
        if self._error is not None:
            raise self._error
        return self.done

    def cancel(self) -> None:
        """Stop after the picture that is being read."""
        self._cancelled.set()

    def _run(self) -> None:
        try:
            steps = [self._panorama, self._occlusion, self._sprites]
            if self._viewpoint.colour_atlas.unlimited:
                steps.append(self._tiles)
            for step in steps:
                if self._cancelled.is_set():
                    return
                step()
        except BaseException as error:
            self._error = error

    def _panorama(self) -> None:
        atlas = self._viewpoint.colour_atlas
        atlas.need_scales(0, sorted({suitable_scale(atlas, panorama_density(atlas), d) for d in self._densities}))

    def _occlusion(self) -> None:
        """Read the layers that decide what hides an actor, and of the tiles' instance numbers those around the actors' paths."""
        viewpoint = self._viewpoint
        if not viewpoint.manifest.actors:
            return
        for atlas in (viewpoint.id_atlas, viewpoint.depth_atlas, viewpoint.owner_atlas):
            atlas.need(0)
        sprites = {
            (s.pan_deg, s.tilt_deg): Perspective(s.pan_deg, s.tilt_deg, s.hfov_deg, s.width, s.height)
            for sheet in viewpoint.manifest.actors
            for s in sheet.sprites
        }.values()
        middle = (0.5, 0.5)
        for index, tile in enumerate(viewpoint.tiles.views):
            near = (
                angle_between_deg(tile.directions(middle), s.directions(middle)) <= tile.reach_deg + s.reach_deg for s in sprites
            )
            if any(near) and not self._cancelled.is_set():
                viewpoint.id_atlas.need(1 + index)

    def _sprites(self) -> None:
        for sheet in self._viewpoint.manifest.actors:
            if not self._cancelled.is_set():
                self._viewpoint.sprites.load([sheet])

    def _tiles(self) -> None:
        """Read the tiles at all scales that zooming needs, neighbours after each other because they are blended together."""
        atlas, views = self._viewpoint.colour_atlas, self._viewpoint.tiles.views
        needed = [density for density in self._densities if density > TILE_GAIN * panorama_density(atlas)]
        for index in sorted(range(len(views)), key=lambda i: views[i].pan_deg):
            if self._cancelled.is_set():
                return
            atlas.need_scales(1 + index, sorted({suitable_scale(atlas, views[index].focal_px, d) for d in needed}))
