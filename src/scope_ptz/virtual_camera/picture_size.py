"""Parse requested image sizes, and crop and scale images to a size."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.errors import InputError
from scope_ptz.virtual_camera.device import VirtualDevice

MIN_SIDE_PX = 16  # minimum width and height of a requested image in pixels


def parse_resolution(device: VirtualDevice, text: str) -> tuple[int, int]:
    """Parse ``WIDTHxHEIGHT``. An empty string means the camera's full size.

    Raises:
        InputError: The text does not have this form, or the size is too small or larger than the camera's.
    """
    if not text:
        return device.width, device.height
    sides = text.lower().split("x")
    if len(sides) != 2 or not all(side.isdecimal() and len(side) < 6 for side in sides):
        raise InputError(f"resolution: expected WIDTHxHEIGHT, got {text[:60]!r}")
    width, height = (int(side) for side in sides)
    if not (MIN_SIDE_PX <= width <= device.width and MIN_SIDE_PX <= height <= device.height):
        smallest, largest = f"{MIN_SIDE_PX}x{MIN_SIDE_PX}", f"{device.width}x{device.height}"
        raise InputError(f"resolution: expected {smallest} to {largest}, got {text[:60]}")
    return width, height


def crop_and_scale(image: NDArray[np.uint8], width: int, height: int) -> NDArray[np.uint8]:
    """Scale an image to a size. If the aspect ratio differs, the image is cropped rather than stretched.

    Args:
        image: Array of shape ``(H, W, 3)``.
        width: Width of the result in pixels.
        height: Height of the result in pixels.
    """
    full_height, full_width = image.shape[:2]
    if (full_width, full_height) == (width, height):
        return image
    scale = max(width / full_width, height / full_height)
    inner_width, inner_height = round(width / scale), round(height / scale)
    left, top = (full_width - inner_width) // 2, (full_height - inner_height) // 2
    inner = image[top : top + inner_height, left : left + inner_width]
    return np.asarray(cv2.resize(inner, (width, height), interpolation=cv2.INTER_AREA), np.uint8)
