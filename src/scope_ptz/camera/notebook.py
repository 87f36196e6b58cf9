"""Display a frame in a notebook."""

from __future__ import annotations

import base64
from html import escape

import cv2
import numpy as np
from numpy.typing import NDArray

MAX_WIDTH = 960  # in pixels; larger frames are scaled down to keep notebooks small
JPEG_QUALITY = 88


def figure_html(image: NDArray[np.uint8], caption: str) -> str:
    """Return an HTML figure that shows an image, ``(H, W, 3)`` uint8 RGB, with a caption."""
    height, width = image.shape[:2]
    scale = min(1.0, MAX_WIDTH / width)
    thumbnail = cv2.resize(
        cv2.cvtColor(image, cv2.COLOR_RGB2BGR), (round(width * scale), round(height * scale)), interpolation=cv2.INTER_AREA
    )
    _, data = cv2.imencode(".jpg", thumbnail, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    source = f"data:image/jpeg;base64,{base64.b64encode(data.tobytes()).decode()}"
    return (
        '<figure style="margin:0;font-family:system-ui,sans-serif">'
        f'<img alt="{escape(caption)}" style="max-width:100%;border-radius:8px;display:block" src="{source}">'
        f'<figcaption style="opacity:.65;font-size:.9em;margin-top:4px">{escape(caption)}</figcaption></figure>'
    )
