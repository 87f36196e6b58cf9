"""Read and write the picture files of a pack: lossy colour, exact instance IDs and distances.

The file suffix determines the encoding.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import AvifImagePlugin as AvifImagePlugin  # imported explicitly, because Pillow would otherwise import all of its plug-ins
from PIL import Image

from scope_ptz.errors import PackError

Image.MAX_IMAGE_PIXELS = None
"""Panoramas exceed Pillow's limit against decompression bombs. Every file's checksum is verified before it is decoded."""

COLOUR_SUFFIXES = (".webp", ".avif", ".png")
NUMBER_SUFFIXES = (".png", ".webp")


def read_colour(path: Path) -> NDArray[np.uint8]:
    """Return (H, W, 3) RGB, or (H, W, 4) straight RGBA when the picture has transparency. The array is read-only."""
    if path.suffix == ".avif" and (pixels := _read_avif(path)) is not None:
        return pixels
    with _open(path, COLOUR_SUFFIXES) as image:
        mode = "RGBA" if image.has_transparency_data else "RGB"
        return np.asarray(image if image.mode == mode else image.convert(mode))


def _read_avif(path: Path) -> NDArray[np.uint8] | None:
    """Decode an AVIF file without copying its pixels through Pillow. Return None if this version of Pillow does not support that.

    Pillow copies the decoder's buffer into an image, and NumPy copies that image. When NumPy uses the decoder's buffer directly,
    decoding a panorama takes half the time and 100 MB less memory.
    """
    with _open_picture(path) as image:
        decoder: Any = getattr(image, "_decoder", None)
        channels = {"RGB": 3, "RGBA": 4}.get(image.mode)
        if not hasattr(decoder, "get_frame") or channels is None or getattr(image, "n_frames", 1) != 1:
            return None
        width, height = image.size
        pixels = np.frombuffer(decoder.get_frame(0)[0], np.uint8)
    return pixels.reshape(height, width, channels) if pixels.size == height * width * channels else None


def write_colour(path: Path, picture: NDArray[np.uint8], quality: int) -> None:
    """Write (H, W, 3) RGB or (H, W, 4) straight RGBA. ``quality`` is 0 to 100 on the codec's own scale; PNG ignores it."""
    image = Image.fromarray(picture)
    match path.suffix:
        case ".webp":
            image.save(path, "WEBP", quality=quality, method=6, alpha_quality=80)
        case ".avif":
            image.save(path, "AVIF", quality=quality, speed=6, subsampling="4:2:0")
        case ".png":
            image.save(path, "PNG", optimize=True)
        case suffix:
            raise ValueError(f"the suffix of a colour file must be one of {', '.join(COLOUR_SUFFIXES)}; got {suffix}")


def read_ids(path: Path) -> NDArray[np.uint16]:
    """Return (H, W) numbers from 0 to 65535, exactly as written: instance IDs or distance codes."""
    return decode_numbers(read_coded_numbers(path))


def read_coded_numbers(path: Path) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """Return numbers as stored in the file: (H, W, 3) byte channels from a WebP file, or (H, W) numbers from a PNG file.

    ``decode_numbers`` converts any part of the array to numbers, so that a pack's largest layers need not be in memory twice.
    OpenCV takes half the time and less than half the memory of Pillow, which decodes a still WebP picture as an animation.
    """
    if path.suffix != ".webp":
        with _open(path, NUMBER_SUFFIXES) as image:
            return np.array(image).astype(np.uint16)
    try:
        content = np.fromfile(path, np.uint8)
    except OSError as error:
        raise _decoding_error(path, error.strerror) from error
    channels = cv2.imdecode(content, cv2.IMREAD_COLOR_RGB) if content.size else None
    if channels is None:
        raise _decoding_error(path, "it is not a WebP picture, or it is truncated")
    return np.asarray(channels)


def decode_numbers(coded: NDArray[np.uint8] | NDArray[np.uint16]) -> NDArray[np.uint16]:
    """Decode rows to (H, W) numbers."""
    if coded.ndim == 2:
        return coded.astype(np.uint16, copy=False)
    # Red is the high byte and green the low byte, so (green, red) pairs are little-endian 16-bit numbers.
    pairs = np.empty((*coded.shape[:2], 2), np.uint8)
    cv2.mixChannels([coded], [pairs], [0, 1, 1, 0])
    return pairs.view("<u2")[..., 0]


def write_ids(path: Path, numbers: NDArray[np.uint16]) -> None:
    """Write (H, W) numbers exactly, as 16-bit PNG, or as lossless WebP with the high byte in red and the low byte in green."""
    match path.suffix:
        case ".png":
            Image.fromarray(numbers).save(path, "PNG", optimize=True)
        case ".webp":
            high, low = (numbers >> np.uint16(8)).astype(np.uint8), numbers.astype(np.uint8)
            channels = np.stack([high, low, np.zeros_like(low)], axis=-1)
            Image.fromarray(channels).save(path, "WEBP", lossless=True, quality=70, method=4, exact=True)
        case suffix:
            raise ValueError(f"the suffix of a number file must be one of {', '.join(NUMBER_SUFFIXES)}; got {suffix}")


def encode_depth(metres: NDArray[np.floating], near_m: float, far_m: float, step: int = 1) -> NDArray[np.uint16]:
    """Return distance codes: 1 to 65535, logarithmic from ``near_m`` to ``far_m``, and 0 for the sky (0 or infinite metres).

    ``step`` rounds codes to multiples of itself, which makes files smaller; distances then change by at most half a step.
    """
    has_distance = np.isfinite(metres) & (metres > 0)
    fraction = np.log(np.where(has_distance, metres, near_m) / near_m) / np.log(far_m / near_m)
    codes = 1 + np.rint(np.clip(fraction, 0, 1) * 65534 / step) * step
    return np.where(has_distance, np.minimum(codes, 65535), 0).astype(np.uint16)


def decode_depth(codes: NDArray[np.uint16], near_m: float, far_m: float) -> NDArray[np.float32]:
    """Return distances in metres, infinite where the code is 0."""
    metres = near_m * (far_m / near_m) ** ((codes.astype(np.float64) - 1) / 65534)
    return np.where(codes == 0, np.inf, metres).astype(np.float32)


def _open(path: Path, suffixes: tuple[str, ...]) -> Image.Image:
    if path.suffix not in suffixes:
        raise PackError(f"{path} has an unsupported format. It must be one of {', '.join(suffixes)}.")
    with _open_picture(path) as image:
        image.load()
        return image


@contextmanager
def _open_picture(path: Path) -> Iterator[Image.Image]:
    """Open the picture in a file without decoding its pixels. Decoding errors inside the context raise ``PackError``."""
    try:
        with path.open("rb") as file:
            yield Image.open(file)
    except (OSError, ValueError) as error:
        raise _decoding_error(path, error) from error


def _decoding_error(path: Path, reason: object) -> PackError:
    return PackError(f"{path} cannot be decoded ({reason}). Restore the pack or bake it again.")
