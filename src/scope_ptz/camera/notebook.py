"""How a frame shows itself in a notebook."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING

import cv2

if TYPE_CHECKING:
    from scope_ptz.camera.base import Frame

MAX_WIDTH = 960  # pixels; larger frames are scaled down to keep notebooks small
JPEG_QUALITY = 88


def frame_html(frame: Frame) -> str:
    """Return a frame as an HTML figure with its pose as the caption."""
    scale = min(1.0, MAX_WIDTH / frame.width)
    size = (round(frame.width * scale), round(frame.height * scale))
    image = cv2.resize(cv2.cvtColor(frame.image, cv2.COLOR_RGB2BGR), size, interpolation=cv2.INTER_AREA)
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    encoded = base64.b64encode(data.tobytes()).decode()
    pose = frame.pose.as_dict()
    where = f"pan {pose['pan_deg']:+.1f}° · tilt {pose['tilt_deg']:+.1f}° · zoom {pose['zoom']:.1f}x"
    what = f"{frame.hfov_deg:.0f}° wide · {frame.time_s:.1f} s"
    place = f"{frame.origin.scene} / {frame.origin.viewpoint} · " if frame.origin else ""
    return (
        '<figure style="margin:0;font-family:system-ui,sans-serif">'
        f'<img alt="frame at {where}" style="max-width:100%;border-radius:8px;display:block" '
        f'src="data:image/jpeg;base64,{encoded}">'
        f'<figcaption style="opacity:.65;font-size:.9em;margin-top:4px">{place}{where} · {what}</figcaption></figure>'
    )
