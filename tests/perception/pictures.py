"""Frames with real pixels, for backends that look at pixels."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import Frame
from scope_ptz.geometry import Perspective, Pose


def frame(image: NDArray[np.uint8] | None = None, *, width: int = 640, height: int = 360) -> Frame:
    """A frame of a real camera: no origin. Grey with an orange square unless an image (H, W, 3) is given."""
    if image is None:
        image = np.full((height, width, 3), 128, np.uint8)
        image[height // 4 : height // 2, width // 4 : width // 2] = (255, 128, 0)
    pose = Pose(10.0, -5.0, 1.0)
    projection = Perspective(pose.pan_deg, pose.tilt_deg, 60.0, image.shape[1], image.shape[0])
    return Frame(image, pose, 60.0, 0.0, projection)


def board(*texts: tuple[str, int, int], width: int = 640, height: int = 360) -> Frame:
    """A white board with black texts at (x, y) of their baselines, in pixels."""
    image = np.full((height, width, 3), 255, np.uint8)
    for text, x, y in texts:
        cv2.putText(image, text, (x, y), cv2.FONT_HERSHEY_SIMPLEX, 1.3, (0, 0, 0), 3, cv2.LINE_AA)
    return frame(image)
