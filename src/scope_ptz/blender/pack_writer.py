"""Write a viewpoint's rendered parts as a pack, within its size limit."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scope_ptz.blender.band import Panorama
from scope_ptz.blender.quality import FAR_M, NEAR_M, Quality
from scope_ptz.blender.sheets import Sheet
from scope_ptz.errors import BlenderError
from scope_ptz.geometry import Perspective
from scope_ptz.simulator.layers import write_colour, write_ids
from scope_ptz.simulator.models import ActorSheet, Depth, Extent, Layer, Manifest, SceneFile, SceneViewpoint, Tile

COLOUR_SUFFIX = ".avif"
"""Suffix of picture files. AVIF files are a quarter smaller than WebP files with the same structural similarity."""

NUMBERS_SUFFIX = ".webp"  # suffix of the files with instance IDs and depth, which are lossless
SPRITE_ENCODING_QUALITY = 62
MAX_BASE_ENCODING_QUALITY = 94
MIN_BASE_ENCODING_QUALITY, MIN_TILE_ENCODING_QUALITY = 74, 48
ENCODING_QUALITY_STEP = 4
"""Encoder qualities for sprites, for the base panorama (highest and lowest), and for tiles (lowest). The qualities for the base
panorama and for tiles are reduced in steps of ``ENCODING_QUALITY_STEP`` until the pack meets its size limit.
"""

MANIFEST_BYTES = 400_000  # bytes reserved for the manifest


@dataclass(frozen=True, slots=True)
class RenderedTile:
    """A rendered tile: its view, its picture ``(H, W, 3)`` and its instance IDs ``(H, W)``."""

    view: Perspective
    colour: NDArray[np.uint8]
    ids: NDArray[np.uint16]


@dataclass(frozen=True, slots=True)
class RenderedActor:
    """A rendered actor: its number, its sprite sheet, and its stride if it walks."""

    number: int
    sheet: Sheet
    stride_m: float | None


@dataclass(frozen=True, slots=True)
class RenderedViewpoint:
    """All of a viewpoint's layers before encoding."""

    panorama: Panorama
    base: NDArray[np.uint8]
    ids: NDArray[np.uint16]
    depth: NDArray[np.uint16]
    tiles: list[RenderedTile]
    actors: list[RenderedActor]
    extents: list[Extent]


def write_pack(
    folder: Path,
    scene: SceneFile,
    viewpoint: SceneViewpoint,
    rendered: RenderedViewpoint,
    quality: Quality,
    limit_bytes: int,
    step: Callable[[], None],
) -> Manifest:
    """Write a pack, replacing an existing one. Pictures get the best quality that ``limit_bytes`` allows.

    Raises:
        BlenderError: The pack is too large even at the lowest quality.
    """
    new_folder = folder.with_name(f".{folder.name}.new")
    shutil.rmtree(new_folder, ignore_errors=True)
    (new_folder / "tiles").mkdir(parents=True)
    (new_folder / "actors").mkdir()
    ids = _write_numbers(new_folder, f"ids{NUMBERS_SUFFIX}", rendered.ids)
    depth = _write_numbers(new_folder, f"depth{NUMBERS_SUFFIX}", rendered.depth)
    step()
    tile_ids = [_write_numbers(new_folder, f"tiles/{k:02d}-ids{NUMBERS_SUFFIX}", t.ids) for k, t in enumerate(rendered.tiles)]
    actors = [_write_actor(new_folder, a) for a in rendered.actors]
    step()
    base, tile_colours = _write_colours_within_limit(new_folder, rendered, quality, limit_bytes - MANIFEST_BYTES)
    step()
    manifest = Manifest(
        scene=scene.name,
        scene_version=scene.version,
        viewpoint=viewpoint.name,
        position_m=viewpoint.position_m,
        pan0_bearing_deg=viewpoint.pan0_bearing_deg,
        blender_version=scene.blender_version,
        samples=quality.base_samples,
        band=rendered.panorama.band,
        base=base,
        ids=ids,
        depth=Depth(**depth.model_dump(), near_m=NEAR_M, far_m=FAR_M),
        tiles=[
            Tile(pan_deg=t.view.pan_deg, tilt_deg=t.view.tilt_deg, hfov_deg=t.view.hfov_deg, colour=colour, ids=numbers)
            for t, colour, numbers in zip(rendered.tiles, tile_colours, tile_ids, strict=True)
        ],
        extents=rendered.extents,
        actors=actors,
    )
    (new_folder / "manifest.json").write_text(manifest.model_dump_json(exclude={"seen"}) + "\n")
    size = folder_size_bytes(new_folder)
    if size > limit_bytes:
        raise BlenderError(f"The pack of '{viewpoint.name}' is {size / 1e6:.2f} MB even at the lowest quality. Bake fewer tiles.")
    for name in ("tiles", "actors"):
        if not any((new_folder / name).iterdir()):
            (new_folder / name).rmdir()
    shutil.rmtree(folder, ignore_errors=True)
    new_folder.replace(folder)
    return manifest


def folder_size_bytes(folder: Path) -> int:
    """Return the total size of all files in a folder, in bytes."""
    return sum(p.stat().st_size for p in folder.rglob("*") if p.is_file())


def _write_colours_within_limit(
    folder: Path, rendered: RenderedViewpoint, quality: Quality, limit_bytes: int
) -> tuple[Layer, list[Layer]]:
    """Encode the base panorama and the tiles at the best quality that fits in ``limit_bytes``.

    Spare space is used for the base panorama. If there is too little space, the tile quality is reduced first.
    """
    space = limit_bytes - folder_size_bytes(folder)
    encoded = (-1, -1)
    layers: list[Layer] = []
    for qualities in _encoding_qualities(quality):
        if qualities[0] != encoded[0]:
            layers[:1] = [_write_colour(folder, f"base{COLOUR_SUFFIX}", rendered.base, qualities[0])]
        if qualities[1] != encoded[1]:
            layers[1:] = _write_tiles(folder, rendered.tiles, qualities[1])
        encoded = qualities
        if sum((folder / layer.file).stat().st_size for layer in layers) <= space:
            break
    return layers[0], layers[1:]


def _encoding_qualities(quality: Quality) -> Iterator[tuple[int, int]]:
    """Yield pairs of encoder qualities for the base panorama and the tiles, best first."""
    for base in range(MAX_BASE_ENCODING_QUALITY, quality.base_encoding_quality, -ENCODING_QUALITY_STEP):
        yield base, quality.tile_encoding_quality
    for tile in range(quality.tile_encoding_quality, MIN_TILE_ENCODING_QUALITY, -ENCODING_QUALITY_STEP):
        yield quality.base_encoding_quality, tile
    for base in range(quality.base_encoding_quality, MIN_BASE_ENCODING_QUALITY - 1, -ENCODING_QUALITY_STEP):
        yield base, MIN_TILE_ENCODING_QUALITY


def _write_tiles(folder: Path, tiles: list[RenderedTile], quality: int) -> list[Layer]:
    """Encode tiles in threads, because a pack has about a hundred tiles and the encoder releases the global interpreter lock."""
    with ThreadPoolExecutor() as pool:
        return list(
            pool.map(lambda k: _write_colour(folder, f"tiles/{k:02d}{COLOUR_SUFFIX}", tiles[k].colour, quality), range(len(tiles)))
        )


def _write_actor(folder: Path, actor: RenderedActor) -> ActorSheet:
    colour = _write_colour(folder, f"actors/{actor.number}{COLOUR_SUFFIX}", actor.sheet.colour, SPRITE_ENCODING_QUALITY)
    depth = _write_numbers(folder, f"actors/{actor.number}-depth{NUMBERS_SUFFIX}", actor.sheet.depth)
    return ActorSheet(number=actor.number, colour=colour, depth=depth, sprites=actor.sheet.sprites, stride_m=actor.stride_m)


def _write_colour(folder: Path, name: str, picture: NDArray[np.uint8], quality: int) -> Layer:
    write_colour(folder / name, picture, quality)
    return layer_of(folder, name, picture.shape[1], picture.shape[0])


def _write_numbers(folder: Path, name: str, numbers: NDArray[np.uint16]) -> Layer:
    write_ids(folder / name, numbers)
    return layer_of(folder, name, numbers.shape[1], numbers.shape[0])


def layer_of(folder: Path, name: str, width: int, height: int) -> Layer:
    """Return the manifest entry for a file."""
    return Layer(file=name, sha256=hashlib.sha256((folder / name).read_bytes()).hexdigest(), width=width, height=height)
