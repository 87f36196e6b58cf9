"""A viewpoint of a pack: reads and verifies its layers on demand, and assembles the sheets from which views are sampled."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import cached_property
from pathlib import Path
from threading import Lock
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from scope_ptz.errors import PackError
from scope_ptz.geometry import direction
from scope_ptz.simulator import layers
from scope_ptz.simulator.blending import TileBlender
from scope_ptz.simulator.clearance import Clearance
from scope_ptz.simulator.files import read_regular_file
from scope_ptz.simulator.mapping.tiles import Tiles
from scope_ptz.simulator.models import FORMAT_VERSION, ActorSheet, Extent, Layer, Manifest, SceneActor, SceneFile, SceneViewpoint
from scope_ptz.simulator.pictures import Pictures
from scope_ptz.simulator.sheets.atlas import Atlas, Scale, SheetCache
from scope_ptz.simulator.sheets.numbers import IdAtlas, IdCodes
from scope_ptz.simulator.sheets.picture_cache import PictureCache
from scope_ptz.simulator.sprites.choice import SpriteSelector
from scope_ptz.simulator.sprites.store import SpriteStore
from scope_ptz.simulator.still_views import StillViews

COLOUR_SCALES = (
    Scale(1.0, sharpening=0.6),
    Scale(1.0, sharpening=0.1),
    Scale(2**-0.5, sharpening=0.3),
    Scale(2**-1.0),
    Scale(2**-1.5, sharpening=0.15),
    Scale(2**-2.0),
    Scale(2**-2.5, sharpening=0.15),
    Scale(2**-3.0),
)
"""Scales of colour pictures on a sheet, half an octave apart, so that no view undersamples its source. The first scale is for views
that are about as dense as the stored picture, or denser. Sharpening compensates for the blur that shrinking and bilinear look-up
cause; with these amounts, the Laplacian variance of views comes closest to that of directly rendered views."""

_File = TypeVar("_File", bound=BaseModel)


class Viewpoint:
    """A viewpoint folder. Layers are read on demand, and every read is verified against the manifest.

    Args:
        folder: The folder.
        scene: The scene that the viewpoint belongs to.
        place: The scene's entry for this viewpoint.
        tile_bytes: Memory limit for tiles at all scales; see ``Atlas``.
        picture_cache: On-disk cache for decoded pictures.

    Raises:
        PackError: The manifest is missing, damaged or belongs to another scene.
    """

    def __init__(
        self,
        folder: Path,
        scene: SceneFile,
        place: SceneViewpoint,
        tile_bytes: int | None = None,
        picture_cache: PictureCache | None = None,
    ) -> None:
        self.folder, self.pictures = folder, Pictures(folder)
        self.manifest = manifest = read_json(folder / "manifest.json", Manifest)
        self.name = place.name
        self.sprites = SpriteStore(self.pictures, picture_cache)
        self.still_views = StillViews()
        self._helper: ThreadPoolExecutor | None = None
        self._helper_lock = Lock()
        self._sprite_selectors: dict[int, SpriteSelector] = {}
        if (manifest.scene, manifest.viewpoint, manifest.scene_version) != (scene.name, place.name, scene.version):
            raise PackError(
                f"{folder} was baked for viewpoint '{manifest.viewpoint}' of scene '{manifest.scene}' version "
                f"{manifest.scene_version}, but the folder is that of '{place.name}' in '{scene.name}' version "
                f"{scene.version}. Bake it again."
            )

        tiles = manifest.tiles
        self.tiles = Tiles([tile.view for tile in tiles])
        colours, ids = [manifest.base, *(t.colour for t in tiles)], [manifest.ids, *(t.ids for t in tiles)]
        # The sheets refer to the files, not to this object, because a reference cycle would delay the release of their memory.
        read, depth = self.pictures, manifest.depth
        pans_deg = [tile.pan_deg for tile in tiles]
        self.tile_blender = blender = TileBlender(
            lambda i: read.colour(tiles[i].colour), self.tiles, manifest.band, lambda: _detail_outlines(scene, manifest)
        )

        def colour(atlas: Atlas, index: int) -> NDArray[np.uint8]:
            return blender.blend(atlas, index - 1) if index else read.colour(manifest.base)

        sizes = [_size(c) for c in colours]
        source = "" if picture_cache is None else _source(folder)

        def sheet_cache(kind: str, files: Sequence[Layer]) -> SheetCache | None:
            return None if picture_cache is None else SheetCache(picture_cache, f"{kind} {source}", lambda i: read.verify(files[i]))

        self.colour_atlas = Atlas(
            sizes,
            colour,
            np.uint8,
            3,
            COLOUR_SCALES,
            pans_deg=pans_deg,
            tile_bytes=tile_bytes,
            disk_cache=sheet_cache("colour", colours),
        )
        decode = layers.decode_numbers
        largest_first = sorted(manifest.extents, key=lambda extent: (-extent.solid_angle_sr, extent.number))
        codes = IdCodes(extent.number for extent in largest_first)
        self.id_atlas = id_atlas = IdAtlas(
            [_size(n) for n in ids],
            lambda _, i: read.coded_numbers(ids[i]),
            codes,
            decode=decode,
            disk_cache=sheet_cache("ids", ids),
        )
        depths, size = [depth], [_size(depth)]
        self.depth_atlas = Atlas(
            size, lambda *_: read.coded_numbers(depth), np.uint16, 1, decode=decode, disk_cache=sheet_cache("depth", depths)
        )
        self.owner_atlas = IdAtlas(size, lambda *_: _owners(id_atlas, depth), codes, disk_cache=sheet_cache("owners", depths))

    def render_in_background(self, render: Callable[[], NDArray[np.uint8]]) -> Future[NDArray[np.uint8]]:
        """Run ``render`` in this viewpoint's helper thread, so that the caller can render something else at the same time."""
        with self._helper_lock:
            if self._helper is None:
                self._helper = ThreadPoolExecutor(1, thread_name_prefix=f"views of {self.name}")
            return self._helper.submit(render)

    def end_thread(self) -> None:
        """End the helper thread once it is idle. The next view that needs it starts another."""
        with self._helper_lock:
            helper, self._helper = self._helper, None
        if helper is not None:
            helper.shutdown(wait=False)

    @cached_property
    def position_m(self) -> NDArray[np.float64]:
        """World position of the optical centre."""
        return np.array(self.manifest.position_m, dtype=np.float64)

    @cached_property
    def world_to_camera(self) -> NDArray[np.float64]:
        """(3, 3) rotation from world axes (x east, y north) to camera coordinates (y forward at pan 0)."""
        return _world_to_camera(self.manifest)

    @cached_property
    def extents(self) -> dict[int, Extent]:
        """Complete silhouettes of the instances that are visible from this viewpoint, by instance ID."""
        return {extent.number: extent for extent in self.manifest.extents}

    @cached_property
    def sheets(self) -> dict[int, ActorSheet]:
        """Sprite sheets by the actor's instance ID."""
        return {sheet.number: sheet for sheet in self.manifest.actors}

    def offset(self, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert world points (..., 3) to vectors from the optical centre, in metres and camera coordinates."""
        return np.asarray((points_m - self.position_m) @ self.world_to_camera.T)

    def files(self) -> Iterator[Layer]:
        """Yield every file in the pack except the manifest."""
        manifest = self.manifest
        yield from (manifest.base, manifest.ids, manifest.depth)
        for tile in manifest.tiles:
            yield from (tile.colour, tile.ids)
        for sheet in manifest.actors:
            yield from (sheet.colour, sheet.depth)
        if manifest.seen is not None:
            yield manifest.seen

    def check_files(self) -> int:
        """Verify the checksum of every file and return the number of files.

        Raises:
            PackError: A file is missing or does not match the manifest.
        """
        return len([self.pictures.verify(layer) for layer in self.files()])

    @cached_property
    def depth_metres(self) -> NDArray[np.float32]:
        """(65536,) table from distance codes to metres; the sky is infinitely far."""
        depth = self.manifest.depth
        return layers.decode_depth(np.arange(65536).astype(np.uint16), depth.near_m, depth.far_m)

    @cached_property
    def clearance(self) -> Clearance:
        """Coarse bounds on the static world, from the depth layer."""
        slot = self.depth_atlas.ensure(0)
        codes = self.depth_atlas.sheet[slot.y : slot.y + slot.height, slot.x : slot.x + slot.width]
        return Clearance(codes, self.depth_metres, self.manifest.band)

    def sprite_selector(self, actor: SceneActor, sheet: ActorSheet) -> SpriteSelector:
        """Return the object that selects an actor's sprites. Each actor's object is created once and shared."""
        if actor.number not in self._sprite_selectors:
            self._sprite_selectors[actor.number] = SpriteSelector(actor, sheet.sprites, self.offset, self.world_to_camera)
        return self._sprite_selectors[actor.number]


def _world_to_camera(manifest: Manifest) -> NDArray[np.float64]:
    bearing = np.radians(manifest.pan0_bearing_deg)
    c, s = np.cos(bearing), np.sin(bearing)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _detail_outlines(scene: SceneFile, manifest: Manifest) -> list[NDArray[np.float64]]:
    """Return the outlines, each as (n, 3) directions, of all instances and of the texts that face the viewpoint."""
    turn = _world_to_camera(manifest)
    outlines = [direction(*np.array(e.hull, dtype=np.float64).T) for e in manifest.extents if len(e.hull) > 2]
    for text in scene.texts:
        centre, right, up = (np.array(v, dtype=np.float64) for v in (text.centre_m, text.right, text.up))
        offset = centre - manifest.position_m
        if np.cross(right, up) @ offset < 0:
            sides = right * text.width_m / 2, up * text.height_m / 2
            corners = np.array([offset + a * sides[0] + b * sides[1] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
            outlines.append(corners @ turn.T / np.linalg.norm(corners, axis=-1, keepdims=True))
    return outlines


def _owners(ids: IdAtlas, depth: Layer) -> NDArray[np.uint16]:
    """Return, for each texel of the depth layer, the instance on which its distance was measured."""
    slot = ids.ensure(0)
    rows = slot.y + ((np.arange(depth.height) + 0.5) / depth.height * slot.height).astype(int)
    columns = slot.x + ((np.arange(depth.width) + 0.5) / depth.width * slot.width).astype(int)
    return ids.at(rows[:, None], columns)


def _source(folder: Path) -> str:
    """Return a hash of the files that determine a viewpoint's sheets. The manifest contains the checksums of all other files."""
    files = (folder / "manifest.json", folder.parent / "scene.json")
    return hashlib.sha256(b"".join(read_regular_file(path) for path in files)).hexdigest()


def _size(layer: Layer) -> tuple[int, int]:
    return layer.width, layer.height


def read_json(path: Path, model: type[_File]) -> _File:
    """Read and validate a JSON file in a pack.

    Raises:
        PackError: The file is missing or damaged, or has a newer format.
    """
    try:
        content = json.loads(read_regular_file(path))
    except OSError as error:
        raise PackError(f"{path} is missing or cannot be read ({error.strerror}). Restore it or bake again.") from error
    except (ValueError, RecursionError) as error:
        raise PackError(f"{path} is not valid JSON ({error}). Restore the pack or bake it again.") from error
    version = content.get("format") if isinstance(content, dict) else None
    if isinstance(version, int) and version > FORMAT_VERSION:
        raise PackError(
            f"{path} has format {version}, but this program supports formats up to {FORMAT_VERSION}. Install a newer scope-ptz."
        )
    try:
        return model.model_validate(content)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"]) or "the top level"
        raise PackError(f"{path} is invalid at {where}: {first['msg']}. Restore the pack or bake it again.") from error
