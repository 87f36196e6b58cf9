"""Read a viewpoint's pictures in the background, so that later views do not have to wait for files."""

from __future__ import annotations

import atexit
import threading
import time
from collections.abc import Callable

from scope_ptz.geometry import AXIS_M5075_G, Limits, Optics, Perspective
from scope_ptz.simulator.mapping.atlas_map import TILE_GAIN, panorama_density, suitable_scale
from scope_ptz.simulator.sheets.memory import release_free_memory
from scope_ptz.simulator.viewpoint import Viewpoint

SPRITE_MARGIN = 1.3  # factor that enlarges sprite views to include actors at positions between two sprites

PAUSE_S = 0.002
"""Pause between pictures in seconds. Without it, this thread would reacquire locks before a waiting view could get them."""

TILES_PER_RELEASE = 8  # after this many tiles, the memory of decoded pictures is returned to the operating system

DENSITY_STEPS = 64  # number of zoom steps, from the widest to the closest, at which the required scales of tiles are determined


class Prefetch:
    """Reads the pictures that live views of a viewpoint need, in a separate thread that starts immediately.

    Once it has ended, views with this width do not have to read files. If the memory for tiles is limited, tiles are not prefetched
    but are read when they come into view.

    Args:
        viewpoint: The viewpoint.
        width: Width of the views in pixels.
        optics: The camera's fields of view by zoom.
        limits: The camera's limits. Only the zoom limits are used.
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
        # If the thread were still decoding a picture during interpreter shutdown, the process would abort.
        atexit.register(self._stop_and_wait)
        self._thread.start()

    @property
    def done(self) -> bool:
        """Whether the thread has ended."""
        return not self._thread.is_alive()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait until the thread ends, and return whether it ended within the timeout.

        Raises:
            PackError: A file of the viewpoint is missing or damaged.
        """
        self._thread.join(timeout_s)
        if self._error is not None:
            raise self._error
        return self.done

    @property
    def cancelled(self) -> bool:
        """Whether ``cancel`` has been called."""
        return self._cancelled.is_set()

    def cancel(self) -> None:
        """Stop as soon as the current picture has been read."""
        self._cancelled.set()

    def _stop_and_wait(self) -> None:
        self.cancel()
        self._thread.join()

    def _run(self) -> None:
        try:
            # The pictures that need the most memory to decode are read first, while little else is in memory.
            steps = [self._sprites, self._occlusion, self._panorama]
            if self._viewpoint.colour_atlas.is_unlimited:
                steps.append(self._tiles)
            for step in steps:
                if self._cancelled.is_set():
                    return
                step()
                release_free_memory()
            self._viewpoint.tile_blender.clear_cache()
            release_free_memory()
        except BaseException as error:
            self._error = error
        finally:
            atexit.unregister(self._stop_and_wait)

    def _panorama(self) -> None:
        atlas = self._viewpoint.colour_atlas
        atlas.ensure_scales(0, sorted({suitable_scale(atlas, panorama_density(atlas), d) for d in self._densities}))

    def _occlusion(self) -> None:
        """Read the layers that determine occlusion, and the instance IDs of the tiles around the actors' paths."""
        viewpoint = self._viewpoint
        if not viewpoint.manifest.actors:
            return
        for atlas in (viewpoint.id_atlas, viewpoint.depth_atlas, viewpoint.owner_atlas):
            atlas.ensure(0)
        _ = viewpoint.clearance  # computed now, so that no view has to wait
        sprites = {
            (s.pan_deg, s.tilt_deg): Perspective(
                s.pan_deg,
                s.tilt_deg,
                min(170.0, SPRITE_MARGIN * s.hfov_deg),
                round(SPRITE_MARGIN * s.width),
                round(SPRITE_MARGIN * s.height),
            )
            for sheet in viewpoint.manifest.actors
            for s in sheet.sprites
        }.values()
        for index in sorted({tile_in_view.tile for sprite in sprites for tile_in_view in viewpoint.tiles.in_view(sprite)}):
            if not self._cancelled.is_set():
                viewpoint.id_atlas.ensure(1 + index)
                time.sleep(PAUSE_S)

    def _sprites(self) -> None:
        for sheet in self._viewpoint.manifest.actors:
            if not self._cancelled.is_set():
                self._viewpoint.sprites.load([sheet])

    def _tiles(self) -> None:
        """Read the tiles at all scales that zooming requires. Neighbouring tiles are read in turn, because blending uses both."""
        atlas, views = self._viewpoint.colour_atlas, self._viewpoint.tiles.views
        needed = [density for density in self._densities if density > TILE_GAIN * panorama_density(atlas)]
        for count, index in enumerate(sorted(range(len(views)), key=lambda i: views[i].pan_deg)):
            if self._cancelled.is_set():
                return
            if count % TILES_PER_RELEASE == 0:
                release_free_memory()
            atlas.ensure_scales(1 + index, sorted({suitable_scale(atlas, views[index].focal_px, d) for d in needed}))
            time.sleep(PAUSE_S)


class Prefetches:
    """A group of prefetches that are cancelled together. Safe to share between threads."""

    def __init__(self) -> None:
        self._started: list[Prefetch] = []
        self._cancelled = False
        self._lock = threading.Lock()

    def start(self, create: Callable[[], Prefetch]) -> None:
        """Start the prefetch that ``create`` returns. If ``cancel`` has been called, the prefetch is cancelled immediately.

        The call blocks while the table of tiles is read, so callers may run it in a worker thread, and may be cancelled before it
        returns.
        """
        prefetch = create()
        with self._lock:
            self._started.append(prefetch)
            if self._cancelled:
                prefetch.cancel()

    def cancel(self) -> None:
        """Cancel all prefetches, including those that start later."""
        with self._lock:
            self._cancelled = True
            for prefetch in self._started:
                prefetch.cancel()

    def wait(self, timeout_s: float) -> None:
        """Wait until the threads have ended, each for at most ``timeout_s`` seconds.

        Raises:
            PackError: A file of a viewpoint is missing or damaged.
        """
        for prefetch in self._started:
            prefetch.wait(timeout_s)
