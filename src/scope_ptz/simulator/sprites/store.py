"""The sprites for a viewpoint's actors. Sheets are decoded once. Sprites stay compressed in memory and are expanded when needed."""

from __future__ import annotations

import zlib
from collections import OrderedDict
from collections.abc import Iterable
from itertools import product
from threading import RLock
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.errors import PackError
from scope_ptz.simulator.models import ActorSheet, Sprite
from scope_ptz.simulator.pictures import Pictures
from scope_ptz.simulator.sheets.memory import release_free_memory
from scope_ptz.simulator.sheets.picture_cache import PictureCache

EXPANDED_BYTES = 16_000_000
"""Memory limit for expanded sprites, in bytes. Expanding a sprite takes about a millisecond."""

SHRUNK_BYTES = 4_000_000
"""Memory limit for shrunk sprites, in bytes. A distant actor has the same size in many successive frames."""

RELEASE_BYTES = 5_000_000
"""After expanding this many bytes, free memory is returned to the operating system, because sprites of many sizes fragment it."""

EDGE_PX = 2
"""Search radius, in pixels, for covered pixels around a half-covered sprite pixel."""

MIN_COVERED = 3
"""Minimum number of covered pixels nearby for a half-covered pixel to be recoloured."""

Part = Literal["colour", "distances"]
Key = tuple[Part, int, int, int]


class SpriteStore:
    """Expands sprites on demand. Safe to share between threads. Raises ``PackError`` when a file is damaged.

    Uncompressed, the sprites of a viewpoint take up to 300 MB; compressed, about 20 MB.
    """

    def __init__(self, pictures: Pictures, picture_cache: PictureCache | None = None) -> None:
        """Create the store.

        Args:
            pictures: The viewpoint's files.
            picture_cache: On-disk cache for compressed sprites.
        """
        self._pictures, self._picture_cache = pictures, picture_cache
        self._packed: dict[Key, bytes] = {}
        self._boxes: dict[tuple[int, int, int], tuple[int, int, int, int]] = {}
        self._farthest: dict[tuple[int, int, int], int] = {}
        self._expanded: OrderedDict[Key, NDArray[Any]] = OrderedDict()
        self._expanded_bytes = self._bytes_since_release = 0
        self._shrunk: OrderedDict[tuple[Key, int, int], NDArray[np.uint8]] = OrderedDict()
        self._shrunk_bytes = 0
        self._lock = RLock()

    def distances(self, sheet: ActorSheet, sprite: Sprite) -> NDArray[np.uint16]:
        """Return a sprite's (h, w) distance codes, 0 where the sprite does not show the actor."""
        return self._get("distances", sheet, sprite)

    def colour(self, sheet: ActorSheet, sprite: Sprite) -> NDArray[np.uint8]:
        """Return a sprite's (h, w, 4) colour, premultiplied by alpha. Ground truth does not use it.

        Raises:
            PackError: The actor's sheet has no transparency.
        """
        return self._get("colour", sheet, sprite)

    def shrunk_colour(self, sheet: ActorSheet, sprite: Sprite, width: int, height: int) -> NDArray[np.uint8]:
        """Return a sprite's premultiplied colour, shrunk to (height, width, 4)."""
        picture: Key = ("colour", sheet.number, sprite.left, sprite.top)
        key = picture, width, height
        with self._lock:
            if key in self._shrunk:
                self._shrunk.move_to_end(key)
                return self._shrunk[key]
        shrunk = np.asarray(cv2.resize(self.colour(sheet, sprite), (width, height), interpolation=cv2.INTER_AREA), dtype=np.uint8)
        shrunk.flags.writeable = False
        with self._lock:
            if key not in self._shrunk:
                self._shrunk[key] = shrunk
                self._shrunk_bytes += shrunk.nbytes
            while self._shrunk_bytes > SHRUNK_BYTES and len(self._shrunk) > 1:
                self._shrunk_bytes -= self._shrunk.popitem(last=False)[1].nbytes
        return shrunk

    def box(self, sheet: ActorSheet, sprite: Sprite) -> tuple[int, int, int, int]:
        """Return the rectangle (left, top, width, height) of a sprite's pixels that are not empty."""
        key = (sheet.number, sprite.left, sprite.top)
        if key not in self._boxes:
            x, y, width, height = cv2.boundingRect(cv2.extractChannel(self.colour(sheet, sprite), 3))
            self._boxes[key] = x, y, width, height
        return self._boxes[key]

    def farthest_code(self, sheet: ActorSheet, sprite: Sprite) -> int:
        """Return the largest distance code in a sprite."""
        key = (sheet.number, sprite.left, sprite.top)
        if key not in self._farthest:
            self._farthest[key] = int(self.distances(sheet, sprite).max())
        return self._farthest[key]

    def load(self, sheets: Iterable[ActorSheet]) -> None:
        """Read actors' sheets, so that later requests need not wait."""
        for sheet in sheets:
            with self._lock:
                self._read("distances", sheet)
                self._read("colour", sheet)

    def _get(self, part: Part, sheet: ActorSheet, sprite: Sprite) -> NDArray[Any]:
        key = (part, sheet.number, sprite.left, sprite.top)
        with self._lock:
            if key in self._expanded:
                self._expanded.move_to_end(key)
                return self._expanded[key]
            self._read(part, sheet)
            expanded = self._expand(key, sheet, sprite)
            expanded.flags.writeable = False
            self._expanded[key] = expanded
            self._expanded_bytes += expanded.nbytes
            self._bytes_since_release += expanded.nbytes
            if self._bytes_since_release > RELEASE_BYTES:
                self._bytes_since_release = 0
                release_free_memory()
            while self._expanded_bytes > EXPANDED_BYTES and len(self._expanded) > 1:
                self._expanded_bytes -= self._expanded.popitem(last=False)[1].nbytes
            return expanded

    def _read(self, part: Part, sheet: ActorSheet) -> None:
        """Decode a sheet and compress its sprites, if that has not been done yet."""
        places = {(s.left, s.top): s for s in sheet.sprites}
        first = next(iter(places))
        if (part, sheet.number, *first) in self._packed or self._read_cached(part, sheet, list(places)):
            return
        whole = self._pictures.numbers(sheet.depth) if part == "distances" else self._pictures.colour(sheet.colour)
        if part == "colour" and (whole.ndim != 3 or whole.shape[2] != 4):
            raise PackError(
                f"{self._pictures.folder / sheet.colour.file} has no transparency, so it is not a sheet of sprites. Bake it again."
            )
        for (left, top), sprite in places.items():
            crop = whole[top : top + sprite.height, left : left + sprite.width]
            self._packed[part, sheet.number, left, top] = zlib.compress(crop.tobytes(), 1)
        if self._picture_cache is not None:
            packed = [self._packed[part, sheet.number, *place] for place in places]
            lengths = np.array([len(sprite) for sprite in packed], np.uint32)
            self._picture_cache.store_blob(self._cache_name(self._picture_cache, part, sheet), lengths.tobytes() + b"".join(packed))

    def _read_cached(self, part: Part, sheet: ActorSheet, places: list[tuple[int, int]]) -> bool:
        """Load compressed sprites from the cache after verifying the sheet's file. Return whether the cache contained them."""
        if self._picture_cache is None:
            return False
        blob = self._picture_cache.blob(self._cache_name(self._picture_cache, part, sheet))
        if blob is None:
            return False
        self._pictures.verify(sheet.depth if part == "distances" else sheet.colour)
        lengths = np.frombuffer(blob, np.uint32, len(places))
        ends = lengths.nbytes + np.cumsum(lengths, dtype=np.int64)
        for place, length, end in zip(places, lengths.tolist(), ends.tolist(), strict=True):
            self._packed[part, sheet.number, *place] = blob[end - length : end]
        return True

    @staticmethod
    def _cache_name(picture_cache: PictureCache, part: Part, sheet: ActorSheet) -> str:
        layer = sheet.depth if part == "distances" else sheet.colour
        return picture_cache.name("sprites", part, layer.sha256, [(s.left, s.top, s.width, s.height) for s in sheet.sprites])

    def _expand(self, key: Key, sheet: ActorSheet, sprite: Sprite) -> NDArray[Any]:
        pixels = zlib.decompress(self._packed[key])
        if key[0] == "distances":
            return np.frombuffer(pixels, np.uint16).reshape(sprite.height, sprite.width)
        straight = np.frombuffer(pixels, np.uint8).reshape(sprite.height, sprite.width, 4)
        return _premultiply(straight, self.distances(sheet, sprite) > 0)


def _premultiply(colour: NDArray[np.uint8], actor_pixels: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return (H, W, 4) colour premultiplied by alpha.

    Lossy coding mixes the black of empty pixels into an actor's half-covered edge, so edge pixels take their colour from the
    covered pixels around them.
    """
    alpha = np.ascontiguousarray(colour[..., 3])
    sheet = cv2.multiply(colour, cv2.merge([alpha, alpha, alpha, np.full_like(alpha, 255)]), scale=1 / 255)
    covered = actor_pixels & (alpha > 250)
    rows, columns = np.nonzero(actor_pixels & (alpha <= 250))
    total, count = np.zeros((len(rows), 3)), np.zeros(len(rows))
    for down, right in product(range(-EDGE_PX, EDGE_PX + 1), repeat=2):
        neighbours = rows + down, columns + right
        clipped = np.clip(neighbours[0], 0, alpha.shape[0] - 1), np.clip(neighbours[1], 0, alpha.shape[1] - 1)
        is_covered = covered[clipped] & (clipped[0] == neighbours[0]) & (clipped[1] == neighbours[1])
        total += colour[..., :3][clipped] * is_covered[:, None]
        count += is_covered
    is_recoloured = count >= MIN_COVERED
    rows, columns = rows[is_recoloured], columns[is_recoloured]
    nearby_colours = total[is_recoloured] / count[is_recoloured, None]
    sheet[rows, columns, :3] = np.rint(nearby_colours * (alpha[rows, columns, None] / 255))
    return np.asarray(sheet)
