"""Encode PNG files with the standard library."""

from __future__ import annotations

import struct
import zlib

_COMPRESSION_LEVEL = 1  # on a fast connection, stronger compression costs more time than it saves


def png_of_rgba(pixels: bytes, width: int, height: int) -> bytes:
    """Encode a picture as an opaque PNG file.

    Args:
        pixels: RGBA pixels with 8 bits per channel, in rows from the bottom up, as the GPU stores them.
        width: Width in pixels.
        height: Height in pixels.

    Raises:
        ValueError: The number of pixels does not match the size.
    """
    if len(pixels) != 4 * width * height:
        raise ValueError(f"{width} x {height} RGBA pixels need {4 * width * height} bytes, got {len(pixels)}")
    rgb = bytearray(3 * width * height)
    for channel in range(3):
        rgb[channel::3] = pixels[channel::4]
    row = 3 * width
    lines = b"".join(b"\0" + rgb[k * row : (k + 1) * row] for k in range(height - 1, -1, -1))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(lines, _COMPRESSION_LEVEL)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(name, data) for name, data in chunks)


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
