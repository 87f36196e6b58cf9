"""The sprites of a viewpoint's actors. Sheets are decoded once; sprites are kept compressed and expanded when they are needed."""

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
from scope_ptz.simulator.sheets.kept import KeptPictures

EXPANDED_BYTES = 32_000_000
"""Limit on the memory of expanded sprites. Expanding one takes about a millisecond."""

EDGE_PX = 2
"""Search radius for covered pixels around a half-covered pixel of a sprite."""

MIN_COVERED = 3
"""Number of covered pixels needed to recolour a half-covered one."""

Part = Literal["colour", "distances"]
Key = tuple[Part, int, int, int]


class SpriteStore:
    """Expands sprites on demand. Safe to share between threads. Raises ``PackError`` when a file is damaged.

    Uncompressed, the sprites of a viewpoint take up to 300 MB; compressed, about 20 MB.
    """

    def __init__(self, pictures: Pictures, kept: KeptPictures | None = None) -> None:
        """Set up the store.

        Args:
            pictures: The files of the viewpoint.
            kept: Where compressed sprites stay on disk.
        """
        self._pictures, self._kept = pictures, kept
        self._packed: dict[Key, bytes] = {}
        self._boxes: dict[tuple[int, int, int], tuple[int, int, int, int]] = {}
        self._expanded: OrderedDict[Key, NDArray[Any]] = OrderedDict()
        self._expanded_bytes = 0
        self._lock = RLock()

    def distances(self, sheet: ActorSheet, sprite: Sprite) -> NDArray[np.uint16]:
        """Return a sprite's (h, w) distance codes, 0 where it does not show the actor."""
        return self._get("distances", sheet, sprite)

    def colour(self, sheet: ActorSheet, sprite: Sprite) -> NDArray[np.uint8]:
        """Return a sprite's (h, w, 4) colour premultiplied by alpha. The ground truth never needs it.

        Raises:
            PackError: The actor's sheet has no transparency.
        """
        return self._get("colour", sheet, sprite)

    def box(self, sheet: ActorSheet, sprite: Sprite) -> tuple[int, int, int, int]:
        """Return the rectangle (left, top, width, height) of a sprite's pixels that are not empty."""
        key = (sheet.number, sprite.left, sprite.top)
        if key not in self._boxes:
            x, y, width, height = cv2.boundingRect(cv2.extractChannel(self.colour(sheet, sprite), 3))
            self._boxes[key] = x, y, width, height
        return self._boxes[key]

    def load(self, sheets: Iterable[ActorSheet]) -> None:
        """Read the sheets of actors, so that no later request has to."""
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
            while self._expanded_bytes > EXPANDED_BYTES and len(self._expanded) > 1:
                self._expanded_bytes -= self._expanded.popitem(last=False)[1].nbytes
            return expanded

    def _read(self, part: Part, sheet: ActorSheet) -> None:
        """Decode a sheet and pack its sprites, unless that was done before."""
        places = {(s.left, s.top): s for s in sheet.sprites}
        first = next(iter(places))
        if (part, sheet.number, *first) in self._packed or self._read_kept(part, sheet, list(places)):
            return
        whole = self._pictures.numbers(sheet.depth) if part == "distances" else self._pictures.colour(sheet.colour)
        if part == "colour" and (whole.ndim != 3 or whole.shape[2] != 4):
            raise PackError(f"{self._pictures.folder / sheet.colour.file} has no transparency: no sheet of sprites. Bake it again.")
        for (left, top), sprite in places.items():
            crop = whole[top : top + sprite.height, left : left + sprite.width]
            self._packed[part, sheet.number, left, top] = zlib.compress(crop.tobytes(), 1)
        if self._kept is not None:
            packed = [self._packed[part, sheet.number, *place] for place in places]
            lengths = np.array([len(sprite) for sprite in packed], np.uint32)
            self._kept.keep_blob(self._kept_name(self._kept, part, sheet), lengths.tobytes() + b"".join(packed))

    def _read_kept(self, part: Part, sheet: ActorSheet, places: list[tuple[int, int]]) -> bool:
        """Use compressed sprites that are on disk, after verifying the sheet's file. Return whether there were any."""
        if self._kept is None:
            return False
        blob = self._kept.blob(self._kept_name(self._kept, part, sheet))
        if blob is None:
            return False
        self._pictures.checked(sheet.depth if part == "distances" else sheet.colour)
        lengths = np.frombuffer(blob, np.uint32, len(places))
        ends = lengths.nbytes + np.cumsum(lengths, dtype=np.int64)
        for place, length, end in zip(places, lengths.tolist(), ends.tolist(), strict=True):
            self._packed[part, sheet.number, *place] = blob[end - length : end]
        return True

    @staticmethod
    def _kept_name(kept: KeptPictures, part: Part, sheet: ActorSheet) -> str:
        layer = sheet.depth if part == "distances" else sheet.colour
        return kept.name("sprites", part, layer.sha256, [(s.left, s.top, s.width, s.height) for s in sheet.sprites])

    def _expand(self, key: Key, sheet: ActorSheet, sprite: Sprite) -> NDArray[Any]:
        pixels = zlib.decompress(self._packed[key])
        if key[0] == "distances":
            return np.frombuffer(pixels, np.uint16).reshape(sprite.height, sprite.width)
        straight = np.frombuffer(pixels, np.uint8).reshape(sprite.height, sprite.width, 4)
        return _premultiplied(straight, self.distances(sheet, sprite) > 0)


def _premultiplied(colour: NDArray[np.uint8], own: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return (H, W, 4) colour times alpha.

    Lossy coding mixes the black of empty pixels into an actor's half-covered edge, so edge pixels take their colour from the
    covered pixels around them. Edges are few, so only they are processed one by one.
    """
    alpha = np.ascontiguousarray(colour[..., 3])
    sheet = cv2.multiply(colour, cv2.merge([alpha, alpha, alpha, np.full_like(alpha, 255)]), scale=1 / 255)
    covered = own & (alpha > 250)
    rows, columns = np.nonzero(own & (alpha <= 250))
    total, count = np.zeros((len(rows), 3)), np.zeros(len(rows))
    for down, right in product(range(-EDGE_PX, EDGE_PX + 1), repeat=2):
        beside = rows + down, columns + right
        there = np.clip(beside[0], 0, alpha.shape[0] - 1), np.clip(beside[1], 0, alpha.shape[1] - 1)
        counts = covered[there] & (there[0] == beside[0]) & (there[1] == beside[1])
        total += colour[..., :3][there] * counts[:, None]
        count += counts
    enough = count >= MIN_COVERED
    rows, columns = rows[enough], columns[enough]
    inward = total[enough] / count[enough, None]
    sheet[rows, columns, :3] = np.rint(inward * (alpha[rows, columns, None] / 255))
    return np.asarray(sheet)
